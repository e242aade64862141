//! The settings of a diagnosis.

use glam::DVec3;
use magsplice_layout::{FilmTolerance, Preset, TileErrors};
use magsplice_magnet::IronPlanes;

use crate::parameters::FreeParameters;

/// Default probability that any tile of a right film is reported: in one film of 500,
/// for normal noise of the stated deviation.
pub const FALSE_ALARM: f64 = 0.002;

/// Default of the largest number of identified errors. A film with more is another film, or its
/// tiles have unspecified expected errors. Each further error would take longer than the error
/// before.
pub const MOST_ERRORS: usize = 16;

/// The positions and the noise of a scan.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldScan {
    /// Positions, in the frame of the film, in millimetres.
    pub points_mm: Vec<DVec3>,
    /// Standard deviation of each reading along x, y, z, in tesla.
    pub noise_t: DVec3,
}

/// The expected errors, and the significance of identified errors.
#[derive(Clone, Debug, PartialEq)]
pub struct DiagnosisSettings {
    /// The usual errors of tiles and groups of tiles. By default, other tiles are exactly as
    /// ordered. Each distribution counts as a normal distribution of the same mean square.
    pub expected: FilmTolerance,
    /// The prior errors whose deviations are compared with the deviations after the scan, without
    /// expected errors.
    pub prior: TileErrors,
    /// The flat iron that moves with the film. Default: none.
    pub iron: IronPlanes,
    /// Unknown parameters of the scan.
    pub free: FreeParameters,
    /// Probability that any tile of a film without errors beyond the expected errors is reported.
    /// Default: [`FALSE_ALARM`].
    pub false_alarm: f64,
    /// Number of identified errors after which the search ends. Default: [`MOST_ERRORS`].
    pub most_errors: usize,
}

impl Default for DiagnosisSettings {
    fn default() -> DiagnosisSettings {
        DiagnosisSettings {
            expected: FilmTolerance::default(),
            prior: Preset::ByHand.errors(),
            iron: IronPlanes::default(),
            free: FreeParameters::NONE,
            false_alarm: FALSE_ALARM,
            most_errors: MOST_ERRORS,
        }
    }
}

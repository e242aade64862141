//! The settings of a diagnosis.

use glam::DVec3;
use magsplice_layout::{FilmTolerance, Preset, TileErrors};

use crate::parameters::FreeParameters;

/// Default probability that any tile of a right film is reported: in one film of 500,
/// for normal noise of the stated deviation.
pub const FALSE_ALARM: f64 = 0.002;

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
    /// Unknown parameters of the scan.
    pub free: FreeParameters,
    /// Probability that any tile of a film without errors beyond the expected errors is reported.
    /// Default: [`FALSE_ALARM`].
    pub false_alarm: f64,
}

impl Default for DiagnosisSettings {
    fn default() -> DiagnosisSettings {
        DiagnosisSettings {
            expected: FilmTolerance::default(),
            prior: Preset::ByHand.errors(),
            free: FreeParameters::NONE,
            false_alarm: FALSE_ALARM,
        }
    }
}

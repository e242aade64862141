//! The settings of a diagnosis.

use glam::DVec3;
use magsplice_layout::{FilmTolerance, Preset, TileErrors};

use crate::parameters::FreeParameters;

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
    /// Default: 0.01.
    pub false_alarm: f64,
}

impl Default for DiagnosisSettings {
    fn default() -> DiagnosisSettings {
        DiagnosisSettings {
            expected: FilmTolerance::default(),
            prior: Preset::ByHand.errors(),
            free: FreeParameters::NONE,
            false_alarm: 0.01,
        }
    }
}

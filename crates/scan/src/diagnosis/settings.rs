//! What is diagnosed, and when an error is named.

use glam::DVec3;
use magsplice_layout::{FilmTolerance, Preset, TileErrors};

use crate::parameters::FreeParameters;

/// Where a film was scanned, and how exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldScan {
    /// Positions, in the frame of the film, in millimetres.
    pub points_mm: Vec<DVec3>,
    /// Standard deviation of each reading along x, y, z, in tesla.
    pub noise_t: DVec3,
}

/// What is expected, and when a tile is named.
#[derive(Clone, Debug, PartialEq)]
pub struct DiagnosisSettings {
    /// The errors that tiles and groups of tiles usually have. With the default, tiles that are
    /// not named are exactly as ordered. Each distribution counts as a normal one of the same mean
    /// square.
    pub expected: FilmTolerance,
    /// The errors whose deviation before the scan is compared with that after it, where nothing is
    /// expected.
    pub prior: TileErrors,
    /// Parameters of the scan that are not known.
    pub free: FreeParameters,
    /// Probability that any tile of a film without errors beyond the expected ones is named.
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

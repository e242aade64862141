//! Requirements on a film: upper and lower bounds, and a baseline of its field.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The table `[expect]`. A value of `None` means that nothing is required of that quantity.
///
/// All bounds are inclusive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Expectations {
    /// Upper bounds of the uniformity RMSE of R_x, R_y (radians) and S_z (dimensionless) over the
    /// working volume.
    pub uniformity_rmse: [Option<f64>; 3],
    /// Upper bounds of the displacement RMSE along x, y, z over the working volume, in millimetres.
    pub displacement_rmse_mm: [Option<f64>; 3],
    /// Lower bound of the amplitude: the best-fit factor of B against the ideal film.
    pub least_amplitude: Option<f64>,
    /// A baseline that the field in the working volume must reproduce.
    pub field: Option<ExpectedField>,
    /// Lower bound of the distance between the tiles and the working volume, in millimetres.
    pub least_clearance_mm: Option<f64>,
}

impl Expectations {
    /// Whether nothing is required.
    pub fn is_empty(&self) -> bool {
        *self == Expectations::default()
    }
}

// The comments of this type are descriptions in the JSON Schema.
/// A baseline of the field and the largest deviation from it.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ExpectedField {
    /// CSV file as `magsplice field` writes it, relative to the folder of the layout. `magsplice
    /// check --update` rewrites it.
    pub file: PathBuf,
    /// Largest difference at any point, as a fraction of |B| there.
    pub within: f64,
}

//! Requirements on a film: upper and lower bounds, and a baseline of its field.

use std::path::PathBuf;

use magsplice_decouple::{Figure, PerAxis, PerParameter};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The table `[expect]`. A value of `None` means that nothing is required of that quantity.
///
/// All bounds are inclusive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Expectations {
    /// Bounds of the figures of the film over the working volume.
    pub bounds: FigureBounds,
    /// A baseline that the field in the working volume must reproduce.
    pub field: Option<ExpectedField>,
    /// Lower bound of the distance between the tiles and the working volume, in millimetres.
    pub least_clearance_mm: Option<f64>,
    /// Requirements on the films that are made with the errors of `[tolerance]`.
    pub made: Option<MadeExpectations>,
}

impl Expectations {
    /// Whether nothing is required.
    pub fn is_empty(&self) -> bool {
        *self == Expectations::default()
    }
}

/// Bounds of the figures of a film. `None` where nothing is required.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FigureBounds {
    /// Upper bounds of the uniformity RMSE, in radians for R_x and R_y.
    pub uniformity_rmse: PerParameter<Option<f64>>,
    /// Upper bounds of the displacement RMSE along x, y, z, in millimetres.
    pub displacement_rmse_mm: PerAxis<Option<f64>>,
    /// Lower bound of the amplitude: the best-fit factor of B against the ideal film.
    pub least_amplitude: Option<f64>,
}

impl FigureBounds {
    /// The bound of one figure: a lower one of the amplitude, an upper one of the others.
    pub fn get(&self, figure: Figure) -> Option<f64> {
        match figure {
            Figure::Uniformity(parameter) => self.uniformity_rmse[parameter],
            Figure::Displacement(axis) => self.displacement_rmse_mm[axis],
            Figure::Amplitude => self.least_amplitude,
        }
    }
}

/// The table `[expect.made]`: bounds at a percentile of the films that are made from the layout. A
/// bound counts as broken only if samples exclude with a stated confidence that it is kept.
///
/// All bounds are inclusive.
#[derive(Clone, Debug, PartialEq)]
pub struct MadeExpectations {
    /// Per cent of the films that must keep each bound, above 0 and below 100.
    pub percentile: f64,
    /// Upper bounds at the percentile, and the lower bound of the amplitude at 100 minus it.
    pub bounds: FigureBounds,
    /// Number of films that are evaluated. `None` stands for the samples of
    /// [`FilmTolerance`](crate::FilmTolerance).
    pub samples: Option<u64>,
    /// Confidence with which samples must exclude that a bound is kept, above 0 and below 1.
    pub confidence: f64,
}

impl Default for MadeExpectations {
    /// No bounds, the 95th percentile, and a confidence of 95 %.
    fn default() -> MadeExpectations {
        MadeExpectations { percentile: 95.0, bounds: FigureBounds::default(), samples: None, confidence: 0.95 }
    }
}

// The comments of this type are descriptions in the JSON Schema.
/// A baseline of the field and the largest deviation from it.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
#[schemars(extend("example" = "{ file = \"film.field.csv\", within = 1e-9 }"))]
pub struct ExpectedField {
    /// CSV file as `magsplice field` writes it, relative to the folder of the layout. `magsplice
    /// check --update` rewrites it.
    pub file: PathBuf,
    /// Largest difference at any point, as a fraction of |B| there.
    pub within: f64,
}

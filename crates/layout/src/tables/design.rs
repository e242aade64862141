//! The table `[design]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::brief::{Goal, StockPart, Symmetry, Under};
use crate::tables::expect::LowerBound;

/// What a search may change to improve the film, and its goal.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DesignTable {
    /// The properties of the tiles that may change.
    #[schemars(extend("example" = "[\"size\", \"position\", \"direction\"]"))]
    pub(crate) vary: Vec<Variable>,
    /// The symmetry that the film has and keeps. Default: none.
    #[serde(default)]
    pub(crate) symmetry: Symmetry,
    /// The error that the search minimizes. Default: uniformity.
    #[serde(default)]
    pub(crate) goal: Goal,
    /// The films whose error counts: the film of the layout, or those made with the errors of
    /// [tolerance]. Default: nominal.
    #[serde(default, skip_serializing_if = "is_nominal")]
    pub(crate) under: Under,
    /// Weights of the errors of R_x, R_y and S_z. Default: 1 each.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "{ r_x = 1.0, r_y = 1.0, s_z = 1.0 }"))]
    pub(crate) weights: Option<Weights>,
    /// Lower bound of the amplitude: the best-fit factor of B against the ideal film.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "{ min = 0.8 }"))]
    pub(crate) amplitude: Option<LowerBound>,
    /// Rectangle that the tiles must stay within, in mm. Default: their own extent.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "{ x = [-10.0, 10.0], y = [-10.0, 10.0] }"))]
    pub(crate) outline_mm: Option<Outline>,
    /// Shortest side of a tile along x and y, in mm. Default: the shortest side in the layout.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) smallest_cut_mm: Option<f64>,
    /// Smallest distance between neighbouring tiles, in mm. Default: 0.
    #[serde(default)]
    pub(crate) gap_mm: f64,
    /// Bounds of the thickness, in mm. Required if the thickness varies.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "{ min = 0.5, max = 2.0 }"))]
    pub(crate) thickness_mm: Option<MinMax>,
    /// Bounds of the magnitude of the polarization, in T. Required if the strength varies.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "{ min = 0.0, max = 0.12 }"))]
    pub(crate) strength_t: Option<MinMax>,
    /// Sizes are rounded to multiples of this, in mm; a tile centred on a mirror plane has its
    /// faces at half multiples. Default: 0.001.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) resolution_mm: Option<f64>,
    /// Directions are rounded to multiples of this, in degrees. Default: 0.01.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) resolution_deg: Option<f64>,
    /// Step of the points at which the search evaluates the film, in mm. Default: the step of the
    /// volume, or a coarser one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) step_mm: Option<f64>,
    /// Largest number of distinct parts. A part is a size with a direction of polarization, however
    /// it is turned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) parts: Option<usize>,
    /// Parts that are available. The search adds other parts only as far as `parts` allows.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("example" = "[{ size_mm = [3.3, 1.7], direction_deg = 0.0 }]"))]
    pub(crate) stock: Vec<StockPart>,
    /// Magnitudes of the polarization that are available, in T. Default: any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("example" = "[0.06, 0.12]"))]
    pub(crate) stock_strengths_t: Vec<f64>,
    /// Number of starting points of the search. Default: 8.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) starts: Option<usize>,
    /// Seed of the random numbers that vary the starting points. Default: 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) seed: Option<u64>,
}

fn is_nominal(under: &Under) -> bool {
    *under == Under::Nominal
}

/// A property of the tiles that may change.
#[derive(Clone, Copy, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Variable {
    /// Sides along x and y, about the tile's centre.
    Size,
    /// Centres along x and y.
    Position,
    /// Cuts: lines parallel to x or y on which faces of tiles lie. All faces on a line move
    /// together.
    Cut,
    /// Upper faces. All faces at the same height move together.
    Thickness,
    /// Angle of the polarization in the plane of the film.
    Direction,
    /// Angle of the polarization out of the plane of the film.
    Tilt,
    /// Magnitude of the polarization.
    Strength,
}

/// Weights of the errors of the decoupling parameters.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Weights {
    /// Weight of R_x.
    #[serde(default = "one")]
    pub(crate) r_x: f64,
    /// Weight of R_y.
    #[serde(default = "one")]
    pub(crate) r_y: f64,
    /// Weight of S_z.
    #[serde(default = "one")]
    pub(crate) s_z: f64,
}

fn one() -> f64 {
    1.0
}

/// A rectangle, unbounded along an axis that is not given.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Outline {
    /// Lower and upper end along x, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "[-10.0, 10.0]"))]
    pub(crate) x: Option<[f64; 2]>,
    /// Lower and upper end along y, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "[-10.0, 10.0]"))]
    pub(crate) y: Option<[f64; 2]>,
}

/// A lower and an upper bound, both inclusive.
#[derive(Clone, Copy, Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MinMax {
    /// The smallest value allowed.
    pub(crate) min: f64,
    /// The largest value allowed.
    pub(crate) max: f64,
}

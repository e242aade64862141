//! The design brief: what a search may change, within which bounds, and its goal.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The table `[design]`, with its defaults filled in.
///
/// The default brief varies nothing and requires nothing.
///
/// # Units
/// Lengths are in millimetres, angles in degrees, polarizations in tesla.
///
/// # Example
/// ```
/// use magsplice_layout::{Brief, Goal, Variables};
///
/// let brief = Brief {
///     vary: Variables { size: true, position: true, ..Variables::default() },
///     goal: Goal::Displacement,
///     least_amplitude: Some(0.65),
///     ..Brief::default()
/// };
/// assert_eq!((brief.resolution_mm, brief.starts), (0.001, 8));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Brief {
    /// The properties of the tiles that may change.
    pub vary: Variables,
    /// The symmetry that the film has and keeps.
    pub symmetry: Symmetry,
    /// The error that the search minimizes.
    pub goal: Goal,
    /// The films whose error counts.
    pub under: Under,
    /// Weights of the errors of R_x, R_y and S_z, or of the displacements along x, y, z.
    pub weights: [f64; 3],
    /// Lower bound of the amplitude: the best-fit factor of B against the ideal film.
    pub least_amplitude: Option<f64>,
    /// Lower and upper end along x and along y that the tiles must stay within. `None` stands for
    /// the extent of the tiles.
    pub outline_mm: [Option<[f64; 2]>; 2],
    /// Shortest side of a tile along x and y. `None` stands for the shortest side in the layout.
    pub smallest_cut_mm: Option<f64>,
    /// Smallest distance between neighbouring tiles.
    pub gap_mm: f64,
    /// Lower and upper bound of the thickness, used if it varies.
    pub thickness_mm: [f64; 2],
    /// Lower and upper bound of the magnitude of the polarization, used if it varies.
    pub strength_t: [f64; 2],
    /// Sizes are rounded to multiples of this; a tile centred on a mirror plane has its faces at
    /// half multiples.
    pub resolution_mm: f64,
    /// Directions are rounded to multiples of this.
    pub resolution_deg: f64,
    /// Step of the points at which the search evaluates the film. `None` lets the search choose it.
    pub step_mm: Option<f64>,
    /// Largest number of distinct parts.
    pub parts: Option<usize>,
    /// Parts that are available.
    pub stock: Vec<StockPart>,
    /// Magnitudes of the polarization that are available. Any magnitude is allowed if this is
    /// empty.
    pub stock_strengths_t: Vec<f64>,
    /// Number of starting points of the search.
    pub starts: usize,
    /// Seed of the random numbers that vary the starting points.
    pub seed: u64,
}

/// The properties of the tiles that a search may change.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Variables {
    /// Sides along x and y, about the tile's centre.
    pub size: bool,
    /// Centres along x and y.
    pub position: bool,
    /// Cuts: lines parallel to x or y on which faces of tiles lie. All faces on a line move
    /// together.
    pub cut: bool,
    /// Upper faces. All faces at the same height move together.
    pub thickness: bool,
    /// Angle of the polarization in the plane of the film.
    pub direction: bool,
    /// Angle of the polarization out of the plane of the film.
    pub tilt: bool,
    /// Magnitude of the polarization.
    pub strength: bool,
}

// The comments of the following types are descriptions in the JSON Schema.
/// A symmetry of the film. The polarization is mapped like arrows drawn on the tiles, as the
/// polarization of Eq. 1 is.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Symmetry {
    /// No symmetry.
    #[default]
    None,
    /// Mirrors at x = 0 and y = 0.
    Mirror,
    /// Mirrors at x = 0 and y = 0, and the exchange of x and y.
    FourFold,
}

/// The error that a search minimizes.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Goal {
    /// The uniformity RMSE of R_x, R_y and S_z.
    #[default]
    Uniformity,
    /// The RMSE of the displacement computed from R_x, R_y and S_z (Eq. 14) against the true one.
    Displacement,
    /// The RMSE of B against Eq. 2 multiplied by amplitude.min, or by 1 without it.
    Field,
}

/// The films whose error a search minimizes.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Under {
    /// The film of the layout, made without errors.
    #[default]
    Nominal,
    /// The films that are made with the errors of `[tolerance]`: the mean of their squared errors.
    Tolerance,
}

/// A part that is available, as thick as the film.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct StockPart {
    /// Sides in the plane of the film, in mm.
    #[schemars(extend("example" = "[3.3, 1.7]"))]
    pub size_mm: [f64; 2],
    /// Angle of the polarization from the first side towards the second, in degrees. Default: 0.
    #[serde(default)]
    pub direction_deg: f64,
}

/// Default resolution of faces: machine tools are no finer.
const RESOLUTION_MM: f64 = 0.001;
const RESOLUTION_DEG: f64 = 0.01;

/// Default number of starting points. From the published film between one and all of eight starts
/// end near the best film, depending on the goal (docs/design.md).
const STARTS: usize = 8;

const SEED: u64 = 1;

impl Default for Brief {
    fn default() -> Brief {
        Brief {
            vary: Variables::default(),
            symmetry: Symmetry::None,
            goal: Goal::Uniformity,
            under: Under::Nominal,
            weights: [1.0; 3],
            least_amplitude: None,
            outline_mm: [None; 2],
            smallest_cut_mm: None,
            gap_mm: 0.0,
            thickness_mm: [0.0; 2],
            strength_t: [0.0; 2],
            resolution_mm: RESOLUTION_MM,
            resolution_deg: RESOLUTION_DEG,
            step_mm: None,
            parts: None,
            stock: Vec::new(),
            stock_strengths_t: Vec::new(),
            starts: STARTS,
            seed: SEED,
        }
    }
}

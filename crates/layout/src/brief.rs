//! `[design]`: the brief of a search: what it may change, within which bounds, and its goal.

// Descriptions of the JSON Schema, which are no links, write tables in brackets.
#![allow(rustdoc::broken_intra_doc_links)]

use std::collections::BTreeSet;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::expectations::LowerBound;
use crate::faults::{FINITE, NOT_NEGATIVE, POSITIVE, TableFaults};
use crate::limits::{MAX_DESIGN_POINTS, MAX_STARTS};
use crate::plausible::check_material;
use crate::tables_present::TablesPresent;
use crate::volume::WorkingVolume;
use crate::written_as::{As, is_default};

// The comments of the following types are descriptions in the JSON Schema.
/// What a search may change to improve the film, and its goal. Without keys it varies nothing and
/// requires nothing.
///
/// # Example
/// ```
/// use magsplice_layout::{Brief, Goal, Variable};
///
/// let brief = Brief {
///     vary: [Variable::Size, Variable::Position].into(),
///     goal: Goal::Displacement,
///     least_amplitude: Some(0.65),
///     ..Brief::default()
/// };
/// assert_eq!((brief.resolution_mm, brief.starts), (0.001, 8));
/// ```
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(
    rename = "DesignTable",
    description = "What a search may change to improve the film, and its goal.",
    extend("required" = ["vary"])
)]
pub struct Brief {
    /// The properties of the tiles, and of the head, that may change.
    #[schemars(with = "Vec<Variable>", extend("example" = "[\"size\", \"position\", \"direction\"]"))]
    pub vary: BTreeSet<Variable>,
    /// The symmetry that the film has and keeps. Default: none.
    pub symmetry: Symmetry,
    /// The error that the search minimizes. Default: uniformity.
    pub goal: Goal,
    /// The films whose error counts: the film of the layout, or those made with the errors of
    /// [tolerance]. Default: nominal.
    #[serde(skip_serializing_if = "is_default")]
    pub under: Under,
    /// Weights of the errors of R_x, R_y and S_z, or of the displacements along x, y, z. Default: 1
    /// each.
    #[serde(with = "As::<Weights>")]
    #[schemars(with = "Weights", extend("example" = "{ r_x = 1.0, r_y = 1.0, s_z = 1.0 }"))]
    pub weights: [f64; 3],
    /// Lower bound of the amplitude: the best-fit factor of B against the ideal film.
    #[serde(rename = "amplitude", skip_serializing_if = "Option::is_none", with = "As::<LowerBound>")]
    #[schemars(with = "Option<LowerBound>", extend("example" = "{ min = 0.8 }"))]
    pub least_amplitude: Option<f64>,
    /// Lower and upper ends along x and y that the tiles must stay within, in mm. Default: their
    /// own extent.
    #[serde(skip_serializing_if = "is_default")]
    #[schemars(with = "Option<Outline>", extend("example" = "{ x = [-10.0, 10.0], y = [-10.0, 10.0] }"))]
    pub outline_mm: Outline,
    /// Shortest side of a tile along x and y, in mm. Default: the shortest side in the layout.
    pub smallest_cut_mm: Option<f64>,
    /// Smallest distance between neighbouring tiles, in mm. Default: 0.
    pub gap_mm: f64,
    /// Bounds of the thickness, in mm. Required if the thickness varies.
    #[schemars(extend("example" = "{ min = 0.5, max = 2.0 }"))]
    pub thickness_mm: Option<MinMax>,
    /// Bounds of the magnitude of the polarization, in T. Required if the strength varies.
    #[schemars(extend("example" = "{ min = 0.0, max = 0.12 }"))]
    pub strength_t: Option<MinMax>,
    /// Bounds of the spacing of the head, in mm. Required if the head varies.
    #[serde(skip_serializing_if = "is_default")]
    #[schemars(extend("example" = "{ min = 2.0, max = 6.0 }"))]
    pub spacing_mm: Option<MinMax>,
    /// Sizes are rounded to multiples of this, in mm; a tile centred on a mirror plane has its
    /// faces at half multiples. Default: 0.001.
    pub resolution_mm: f64,
    /// Directions are rounded to multiples of this, in degrees. Default: 0.01.
    pub resolution_deg: f64,
    /// Step of the points at which the search evaluates the film, in mm. Default: the step of the
    /// volume, or a coarser one.
    pub step_mm: Option<f64>,
    /// Largest number of distinct parts. A part is a size with a direction of polarization, however
    /// it is turned.
    pub parts: Option<usize>,
    /// Parts that are available. The search adds other parts only as far as `parts` allows.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("example" = "[{ size_mm = [3.3, 1.7], direction_deg = 0.0 }]"))]
    pub stock: Vec<StockPart>,
    /// Magnitudes of the polarization that are available, in T. Default: any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("example" = "[0.06, 0.12]"))]
    pub stock_strengths_t: Vec<f64>,
    /// Number of starting points of the search. Default: 8.
    pub starts: usize,
    /// Seed of the random numbers that vary the starting points. Default: 1.
    pub seed: u64,
}

/// A property of the tiles, or of the head, that may change.
#[derive(Clone, Copy, Debug, Deserialize, Eq, JsonSchema, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Variable {
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
    /// Spacing of the head, and with it the weights of least noise.
    Head,
}

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
    /// Films as made, with the errors of `[tolerance]`: the mean of their squared errors.
    Tolerance,
}

/// A part that is available, as thick as the film.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
pub struct StockPart {
    /// Sides in the plane of the film, in mm.
    #[schemars(extend("example" = "[3.3, 1.7]"))]
    pub size_mm: [f64; 2],
    /// Angle of the polarization from the first side towards the second, in degrees. Default: 0.
    #[serde(default)]
    pub direction_deg: f64,
}

/// Weights of the errors of the decoupling parameters.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default)]
struct Weights {
    /// Weight of R_x.
    r_x: f64,
    /// Weight of R_y.
    r_y: f64,
    /// Weight of S_z.
    s_z: f64,
}

/// A rectangle, unbounded along an axis that is not given.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
pub struct Outline {
    /// Lower and upper end along x, in mm.
    #[schemars(extend("example" = "[-10.0, 10.0]"))]
    pub x: Option<[f64; 2]>,
    /// Lower and upper end along y, in mm.
    #[schemars(extend("example" = "[-10.0, 10.0]"))]
    pub y: Option<[f64; 2]>,
}

/// A lower and an upper bound, both inclusive.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
pub struct MinMax {
    /// The smallest value allowed.
    pub min: f64,
    /// The largest value allowed.
    pub max: f64,
}

impl Default for Weights {
    fn default() -> Weights {
        Weights::from([1.0; 3])
    }
}

impl From<[f64; 3]> for Weights {
    fn from([r_x, r_y, s_z]: [f64; 3]) -> Weights {
        Weights { r_x, r_y, s_z }
    }
}

impl From<Weights> for [f64; 3] {
    fn from(Weights { r_x, r_y, s_z }: Weights) -> [f64; 3] {
        [r_x, r_y, s_z]
    }
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
            vary: BTreeSet::new(),
            symmetry: Symmetry::None,
            goal: Goal::Uniformity,
            under: Under::Nominal,
            weights: [1.0; 3],
            least_amplitude: None,
            outline_mm: Outline::default(),
            smallest_cut_mm: None,
            gap_mm: 0.0,
            thickness_mm: None,
            strength_t: None,
            spacing_mm: None,
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

impl Brief {
    /// Whether a property may change.
    pub fn varies(&self, variable: Variable) -> bool {
        self.vary.contains(&variable)
    }

    /// Adds the faults of the brief.
    pub(crate) fn check(&self, present: TablesPresent, volume: Option<&WorkingVolume>, faults: &mut TableFaults) {
        self.check_variables(faults);
        present.check("", true, faults);
        for (key, weight) in ["weights.r_x", "weights.r_y", "weights.s_z"].into_iter().zip(self.weights) {
            faults.number(key, weight, NOT_NEGATIVE);
        }
        if self.weights == [0.0; 3] {
            faults.add("weights are all 0, at least one must be greater than 0");
        }
        self.check_lengths(faults);
        self.check_bounds(faults);
        self.check_parts(faults);
        if let (Some(step), Some(volume)) = (self.step_mm.filter(|step| *step > 0.0), volume) {
            let points = ((volume.upper_mm - volume.lower_mm) / step + 1.0).element_product();
            if points > MAX_DESIGN_POINTS {
                faults.add(format!(
                    "step_mm = {step} makes {points:.3e} points in the working volume, must make at most \
                     {MAX_DESIGN_POINTS:e}"
                ));
            }
        }
        let one_point = volume.is_some_and(|volume| (0..3).any(|axis| volume.grid.plane_len(axis) == 1));
        if self.goal == Goal::Uniformity && self.step_mm.is_none() && one_point {
            faults.add(
                "goal = \"uniformity\" needs at least two points in each plane of the grid of [volume], and some planes \
                 have one: use a smaller step_mm, or a volume with two extents above 0",
            );
        }
        self.check_under(present, faults);
        let rule = format_args!("must be from 1 to {MAX_STARTS}");
        faults.require((1..=MAX_STARTS).contains(&self.starts), "starts", self.starts, rule);
    }

    /// Requires errors and a goal in millimetres if films as made count.
    fn check_under(&self, present: TablesPresent, faults: &mut TableFaults) {
        if self.under == Under::Nominal {
            return;
        }
        if !present.tolerance {
            faults.add(
                "under = \"tolerance\" needs the table [tolerance], which the layout does not have: it has the errors \
                 of films as made",
            );
        }
        if self.goal != Goal::Displacement {
            faults.add(format!(
                "goal = {:?} with under = \"tolerance\", must be \"displacement\": other errors are smallest for films \
                 whose parameters hardly change with the displacement",
                format!("{:?}", self.goal).to_lowercase()
            ));
        }
    }

    fn check_variables(&self, faults: &mut TableFaults) {
        if self.vary.is_empty() {
            faults.add(
                "vary = [], must have at least one of size, position, cut, thickness, direction, tilt, strength, head",
            );
        }
        let moves_singly = self.varies(Variable::Size) || self.varies(Variable::Position);
        if self.varies(Variable::Cut) && moves_singly {
            faults.add(
                "vary has cut, which moves all faces on a line together, and size or position, which move faces \
                 separately, must have only one of the two",
            );
        }
    }

    fn check_lengths(&self, faults: &mut TableFaults) {
        faults.number("resolution_mm", self.resolution_mm, POSITIVE);
        faults.number("resolution_deg", self.resolution_deg, POSITIVE);
        faults.number("step_mm", self.step_mm, POSITIVE);
        faults.number("smallest_cut_mm", self.smallest_cut_mm, POSITIVE);
        faults.number("amplitude.min", self.least_amplitude, POSITIVE);
        faults.number("gap_mm", self.gap_mm, NOT_NEGATIVE);
        for (key, range) in [("x", self.outline_mm.x), ("y", self.outline_mm.y)] {
            let Some([low, high]) = range else { continue };
            let is_range = low.is_finite() && high.is_finite() && low < high;
            let rule = "must be two finite numbers, the first less than the second";
            faults.require(is_range, format_args!("outline_mm.{key}"), format_args!("[{low}, {high}]"), rule);
        }
    }

    fn check_bounds(&self, faults: &mut TableFaults) {
        let ranges = [
            ("thickness_mm", "thickness", Variable::Thickness, self.thickness_mm, f64::MIN_POSITIVE, "0 < min <= max"),
            ("strength_t", "strength", Variable::Strength, self.strength_t, 0.0, "0 <= min <= max"),
            ("spacing_mm", "head", Variable::Head, self.spacing_mm, f64::MIN_POSITIVE, "0 < min <= max"),
        ];
        for (key, name, variable, bounds, least, rule) in ranges {
            match bounds {
                Some(MinMax { min, max }) if !(min >= least && min <= max && max.is_finite()) => {
                    faults.add(format!("{key} = {{ min = {min}, max = {max} }}, must be finite with {rule}"));
                }
                None if self.varies(variable) => {
                    faults.add(format!("vary has {name}, so {key} = {{ min = ..., max = ... }} must be given"));
                }
                _ => {}
            }
        }
        check_material("strength_t.max", self.strength_t.map(|bounds| bounds.max), faults);
    }

    fn check_parts(&self, faults: &mut TableFaults) {
        if self.parts.is_some() || !self.stock.is_empty() {
            if !(self.varies(Variable::Size) && self.varies(Variable::Position)) {
                faults.add("parts or stock is given, so vary must have size and position: the search exchanges sizes");
            }
            if self.varies(Variable::Tilt) {
                faults
                    .add("parts or stock is given, so vary must not have tilt: parts are polarized in the film plane");
            }
        }
        if self.parts == Some(0) {
            faults.add("parts = 0, must be at least 1");
        }
        if let Some(parts) = self.parts.filter(|parts| *parts < self.stock.len()) {
            faults.add(format!("parts = {parts}, must not be less than the {} parts of the stock", self.stock.len()));
        }
        for (index, part) in self.stock.iter().enumerate() {
            if !part.size_mm.iter().all(|side| side.is_finite() && *side > 0.0) {
                faults.add(format!(
                    "stock[{index}].size_mm = {:?}, must be two finite numbers greater than 0",
                    part.size_mm
                ));
            }
            faults.number(format_args!("stock[{index}].direction_deg"), part.direction_deg, FINITE);
        }
        for (index, strength) in self.stock_strengths_t.iter().enumerate() {
            let key = format!("stock_strengths_t[{index}]");
            faults.number(&key, *strength, NOT_NEGATIVE);
            check_material(&key, *strength, faults);
        }
        if !self.stock_strengths_t.is_empty() && !self.varies(Variable::Strength) {
            faults.add("stock_strengths_t is given, so vary must have strength");
        }
    }
}

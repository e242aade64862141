//! A layout as it is written in TOML: every key with its unit, unknown keys refused, nothing checked yet.
//!
//! The comments of keys are what `magsplice schema` says of them.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml::Spanned;

/// A spliced magnet film or any other arrangement of block magnets: lengths in mm, polarization in T.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "magsplice layout")]
pub(crate) struct LayoutFile {
    /// Version of the format: 1.
    #[schemars(with = "i64", extend("const" = 1))]
    pub(crate) format: Spanned<i64>,
    /// Name of the layout.
    pub(crate) name: String,
    /// What it is, in the author's words.
    pub(crate) description: Option<String>,
    /// The sinusoidal film to compare with (Dai 2024, Eq. 1); needed by compare and decouple.
    #[schemars(with = "Option<Ideal>")]
    pub(crate) ideal: Option<Spanned<Ideal>>,
    /// Where the field is used; needed by compare and decouple, and by field without --points.
    #[schemars(with = "Option<Volume>")]
    pub(crate) volume: Option<Spanned<Volume>>,
    /// What the film must meet; evaluated by check.
    #[schemars(with = "Option<Expect>")]
    pub(crate) expect: Option<Spanned<Expect>>,
    /// What may change to make the film better, and what is wanted; used by design.
    #[schemars(with = "Option<Design>")]
    pub(crate) design: Option<Spanned<Design>>,
    /// How the layout came about, one line for each step.
    #[serde(default)]
    pub(crate) history: Vec<String>,
    /// Sizes and strengths by name, for the tiles that name them.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, Kind>")]
    pub(crate) kind: BTreeMap<String, Spanned<Kind>>,
    /// Tiles, each alone or repeated.
    #[serde(default)]
    #[schemars(with = "Vec<TileEntry>")]
    pub(crate) tile: Vec<Spanned<TileEntry>>,
    /// Films cut along lines parallel to x and y.
    #[serde(default)]
    #[schemars(with = "Vec<Lattice>")]
    pub(crate) lattice: Vec<Spanned<Lattice>>,
}

/// The film of Eq. 1 to compare with.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Ideal {
    /// Wavelength of its sinusoidal polarization, in mm.
    pub(crate) wavelength_mm: f64,
    /// Thickness, in mm.
    pub(crate) thickness_mm: f64,
    /// Amplitude m0 of each component of its polarization, in T.
    pub(crate) amplitude_t: f64,
}

/// The region in which the sensor moves, and its points.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Volume {
    /// Lower and upper end along x, in mm.
    pub(crate) x_mm: [f64; 2],
    /// Lower and upper end along y, in mm.
    pub(crate) y_mm: [f64; 2],
    /// Lower and upper end along z, in mm; below the film z is negative.
    pub(crate) z_mm: [f64; 2],
    /// Distance of neighbouring points, in mm: one number, or one each along x, y, z.
    pub(crate) step_mm: Step,
    /// The point from which changes are measured, in mm, on the film's axis; default: the middle of x and y at the lowest z.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) reference_mm: Option<[f64; 3]>,
}

#[derive(Clone, Copy, Deserialize, JsonSchema, Serialize)]
#[serde(untagged, expecting = "expected a number or an array of three numbers")]
pub(crate) enum Step {
    /// The same along x, y and z.
    Same(f64),
    /// Along x, y, z.
    PerAxis([f64; 3]),
}

/// What the film must meet over its working volume.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Expect {
    /// Upper bounds of the uniformity RMSE.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) uniformity_rmse: Option<UniformityBounds>,
    /// Upper bounds of the RMSE of displacement.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) displacement_rmse_mm: Option<DisplacementBounds>,
    /// Lower bound of the best-fit amplitude against the ideal film.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) amplitude: Option<Least>,
    /// The field as it was, which it must still be.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) field: Option<FieldBaseline>,
    /// Lower bound of the distance between the tiles and the working volume, in mm; negative where a tile reaches into it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) clearance_mm: Option<Least>,
}

/// Upper bounds, at least one.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct UniformityBounds {
    /// Of R_x, in radians.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) r_x: Option<f64>,
    /// Of R_y, in radians.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) r_y: Option<f64>,
    /// Of S_z.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) s_z: Option<f64>,
}

/// Upper bounds, at least one.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DisplacementBounds {
    /// Along x, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) x: Option<f64>,
    /// Along y, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) y: Option<f64>,
    /// Along z, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) z: Option<f64>,
}

/// A lower bound.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Least {
    /// The value must not be less.
    pub(crate) min: f64,
}

/// A field in a file.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FieldBaseline {
    /// CSV file as `magsplice field` writes it, relative to the folder of the layout; `magsplice check --update` writes it anew.
    pub(crate) file: String,
    /// Largest difference at any point, as a fraction of |B| there.
    pub(crate) within: f64,
}

/// What may change to make the film better, and what is wanted.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Design {
    /// What may change.
    pub(crate) vary: Vec<Variable>,
    /// Which symmetry the film has and keeps; default none.
    #[serde(default)]
    pub(crate) symmetry: Symmetry,
    /// What is to become small; default uniformity.
    #[serde(default)]
    pub(crate) goal: Goal,
    /// How much the errors of R_x, R_y and S_z count; default 1 each.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) weights: Option<Weights>,
    /// Lower bound of the best-fit amplitude against the ideal film.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) amplitude: Option<Least>,
    /// What the tiles must stay within; default: their own extent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) outline_mm: Option<Outline>,
    /// Shortest side of a tile along x and y, in mm; default: the shortest there is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) smallest_cut_mm: Option<f64>,
    /// Least distance of neighbouring tiles, in mm; default 0.
    #[serde(default)]
    pub(crate) gap_mm: f64,
    /// Bounds of the thickness, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) thickness_mm: Option<Bounds>,
    /// Bounds of the magnitude of the polarization, in T.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) strength_t: Option<Bounds>,
    /// Faces are rounded to multiples of this, in mm; default 0.001.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) resolution_mm: Option<f64>,
    /// Directions are rounded to multiples of this, in degrees; default 0.01.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) resolution_deg: Option<f64>,
    /// Step of the points the film is designed on, in mm; default: that of the volume, or coarser.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) step_mm: Option<f64>,
    /// At most so many distinct parts: sizes with a direction, however they are turned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) parts: Option<usize>,
    /// Parts that are at hand; others are made only as far as `parts` allows.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) stock: Vec<Stock>,
    /// Magnitudes of the polarization that are at hand, in T; default: any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) stock_strengths_t: Vec<f64>,
    /// From how many points the search starts; default 8.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) starts: Option<usize>,
    /// Which random numbers vary these points; default 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) seed: Option<u64>,
}

/// What of the tiles may change.
#[derive(Clone, Copy, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Variable {
    /// Sides along x and y, about the tile's centre.
    Size,
    /// Centres along x and y.
    Position,
    /// Lines on which faces of tiles lie: all faces of a line move together.
    Cut,
    /// The upper faces, all at the same height together.
    Thickness,
    /// The angle of the polarization in the plane of the film.
    Direction,
    /// The angle of the polarization out of the plane of the film.
    Tilt,
    /// The magnitude of the polarization.
    Strength,
}

/// What the film is mapped onto itself by, arrows on its tiles included.
#[derive(Clone, Copy, Default, Deserialize, JsonSchema, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Symmetry {
    /// Nothing.
    #[default]
    None,
    /// Mirrors at x = 0 and y = 0.
    Mirror,
    /// These and the exchange of x and y.
    FourFold,
}

/// What is to become small.
#[derive(Clone, Copy, Default, Deserialize, JsonSchema, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Goal {
    /// The uniformity RMSE of R_x, R_y, S_z.
    #[default]
    Uniformity,
    /// The RMSE of displacement against the true one.
    Displacement,
    /// The RMSE of B against Eq. 2 times amplitude.min, or times 1.
    Field,
}

/// How much errors count.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Weights {
    /// Of R_x.
    #[serde(default = "one")]
    pub(crate) r_x: f64,
    /// Of R_y.
    #[serde(default = "one")]
    pub(crate) r_y: f64,
    /// Of S_z.
    #[serde(default = "one")]
    pub(crate) s_z: f64,
}

fn one() -> f64 {
    1.0
}

/// A rectangle.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Outline {
    /// Lower and upper end along x, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) x: Option<[f64; 2]>,
    /// Lower and upper end along y, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) y: Option<[f64; 2]>,
}

/// A lower and an upper bound.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Bounds {
    /// Not less.
    pub(crate) min: f64,
    /// Not more.
    pub(crate) max: f64,
}

/// A tile that can be had, as thick as the film.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Stock {
    /// Its sides in the plane of the film, in mm.
    pub(crate) size_mm: [f64; 2],
    /// Angle of its polarization from the first side towards the second, in degrees; default 0.
    #[serde(default)]
    pub(crate) direction_deg: f64,
}

/// What tiles of one kind have in common.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Kind {
    /// Full side lengths along the tile's own axes, in mm.
    pub(crate) size_mm: [f64; 3],
    /// Magnitude of the polarization, in T; its direction is the tile's.
    pub(crate) strength_t: Option<f64>,
    /// Polarization J = mu0 M in the tile's own frame, in T.
    pub(crate) polarization_t: Option<[f64; 3]>,
}

/// A tile, alone or repeated. Its polarization is given once: polarization_t, or strength_t and direction, or by its kind.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TileEntry {
    /// Unique name; default: tile-1, tile-2, ...
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) name: Option<String>,
    /// Name of its kind, which gives its size.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) kind: Option<String>,
    /// Centre, in mm.
    pub(crate) position_mm: [f64; 3],
    /// Full side lengths along the tile's own axes, in mm, unless its kind gives them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) size_mm: Option<[f64; 3]>,
    /// Polarization J = mu0 M in the tile's own frame, in T.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) polarization_t: Option<[f64; 3]>,
    /// Magnitude of the polarization, in T; goes with a direction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) strength_t: Option<f64>,
    /// Direction of the polarization in the tile's own frame, of any length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) direction: Option<[f64; 3]>,
    /// Rotation about the tile's centre.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) rotation: Option<Rotation>,
    /// Copies in steps of a pitch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) grid: Option<Repeat>,
    /// The mirror image, of the whole grid if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) mirror: Option<Mirror>,
}

/// A rotation about the tile's centre, from the tile's own frame to the scene's.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Rotation {
    /// Axis of rotation; any length but zero.
    pub axis: [f64; 3],
    /// Angle, right-handed about the axis, in degrees.
    pub angle_deg: f64,
}

/// Copies of a tile on a grid that begins at its position.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Repeat {
    /// How many along x, y, z.
    pub(crate) count: [usize; 3],
    /// Distance of neighbouring copies along x, y, z, in mm.
    pub(crate) pitch_mm: [f64; 3],
    /// Axes along which every other copy is reversed.
    #[serde(default)]
    pub(crate) alternate: Vec<Axis>,
}

/// Mirror images of a tile and its copies.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Mirror {
    /// Axes normal to the mirrors, applied one after the other.
    pub(crate) axes: Vec<Axis>,
    /// A point of the mirrors, in mm.
    #[serde(default)]
    pub(crate) at_mm: [f64; 3],
    /// What becomes of the polarization.
    #[serde(default)]
    pub(crate) polarization: Reflection,
}

#[derive(Clone, Copy, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Reflection {
    /// Reflected like an arrow drawn on the tile: the component normal to the mirror changes sign.
    #[default]
    Reflect,
    /// Reflected like a magnetization, which is a pseudovector: the components in the mirror change sign.
    Axial,
    /// Not changed.
    Keep,
}

#[derive(Clone, Copy, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Axis {
    X,
    Y,
    Z,
}

/// A film cut along lines: one tile in each cell whose pattern is not zero along both axes.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Lattice {
    /// Begins the names of its tiles, as in NAME-x2-y1; default: lattice-1, lattice-2, ...
    pub(crate) name: Option<String>,
    /// Lower corner, in mm.
    pub(crate) start_mm: [f64; 3],
    /// Height along z, in mm.
    pub(crate) height_mm: f64,
    /// Magnitude of every tile's polarization, in T; or give component_t.
    pub(crate) strength_t: Option<f64>,
    /// The polarization is this times the pattern, in T; or give strength_t.
    pub(crate) component_t: Option<f64>,
    /// Intervals along x.
    pub(crate) x: Vec<Stretch>,
    /// Intervals along y; default: those along x.
    pub(crate) y: Option<Vec<Stretch>>,
}

/// Consecutive cells along one axis of a lattice.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Stretch {
    /// Widths of the cells, in mm.
    pub(crate) widths_mm: Vec<f64>,
    /// For each cell the component of the polarization's direction along this axis.
    pub(crate) pattern: Vec<f64>,
    /// How often the stretch is repeated; default 1.
    pub(crate) times: Option<usize>,
}

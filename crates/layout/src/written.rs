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

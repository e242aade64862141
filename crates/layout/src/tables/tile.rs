//! The tables `[[tile]]` and `[kind.NAME]`, and the tables inside a tile: `grid` and `mirror`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::tables::material::RecoilPermeability;
use crate::tables::rotation::RotationTable;

/// The properties that tiles of one kind have in common.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct KindTable {
    /// Full side lengths along the tile's own axes, in mm.
    #[schemars(extend("example" = "[3.3, 1.7, 1.0]"))]
    pub(crate) size_mm: [f64; 3],
    /// Magnitude of the polarization, in T. Each tile gives its direction.
    pub(crate) strength_t: Option<f64>,
    /// Polarization J = mu0 M in the tile's own frame, in T.
    #[schemars(extend("example" = "[0.12, 0.0, 0.0]"))]
    pub(crate) polarization_t: Option<[f64; 3]>,
    /// Relative recoil permeability. Default: that of [material].
    pub(crate) recoil_permeability: Option<RecoilPermeability>,
}

/// A tile, single or repeated. Its polarization is given once: as polarization_t, as strength_t and
/// direction, or by its kind.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TileTable {
    /// Unique name. Default: tile-1, tile-2 and so on, numbered in the order of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) name: Option<String>,
    /// Name of the kind that gives the size.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) kind: Option<String>,
    /// Centre, in mm.
    #[schemars(extend("example" = "[0.0, 0.0, 0.5]"))]
    pub(crate) position_mm: [f64; 3],
    /// Full side lengths along the tile's own axes, in mm. Required unless a kind gives them.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "[3.3, 1.7, 1.0]"))]
    pub(crate) size_mm: Option<[f64; 3]>,
    /// Polarization J = mu0 M in the tile's own frame, in T. Or give its magnitude as strength_t,
    /// with a direction.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "[0.12, 0.0, 0.0]"))]
    pub(crate) polarization_t: Option<[f64; 3]>,
    /// Magnitude of the polarization, in T. Needs a direction.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "0.12"))]
    pub(crate) strength_t: Option<f64>,
    /// Direction of the polarization in the tile's own frame, a vector of any length but zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "[1.0, 1.0, 0.0]"))]
    pub(crate) direction: Option<[f64; 3]>,
    /// Angle of the polarization in the tile's own xy plane, from x towards y, in degrees. Goes
    /// with strength_t, instead of direction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) direction_deg: Option<f64>,
    /// Angle of the polarization out of the tile's own xy plane towards z, in degrees. Goes with
    /// direction_deg. Default: 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) tilt_deg: Option<f64>,
    /// Relative recoil permeability. Default: that of its kind or of [material].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) recoil_permeability: Option<RecoilPermeability>,
    /// Rotation about the tile's centre.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) rotation: Option<RotationTable>,
    /// Copies on a regular grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) grid: Option<GridTable>,
    /// Mirror images of the tile and of all its copies on the grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) mirror: Option<MirrorTable>,
}

/// Copies of a tile on a regular grid that begins at the tile's position.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
#[schemars(extend("example" = "{ count = [4, 4, 1], pitch_mm = [5.0, 5.0, 0.0] }"))]
pub(crate) struct GridTable {
    /// Number of copies along x, y, z, the tile itself included.
    #[schemars(extend("example" = "[4, 4, 1]"))]
    pub(crate) count: [usize; 3],
    /// Distance between neighbouring copies along x, y, z, in mm.
    #[schemars(extend("example" = "[5.0, 5.0, 0.0]"))]
    pub(crate) pitch_mm: [f64; 3],
    /// Axes along which the polarization of every other copy is reversed.
    #[serde(default)]
    pub(crate) alternate: Vec<AxisName>,
}

/// Mirror images of a tile and its copies.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
#[schemars(extend("example" = "{ axes = [\"x\"] }"))]
pub(crate) struct MirrorTable {
    /// Axes normal to the mirrors, which are applied one after the other.
    #[schemars(extend("example" = "[\"x\"]"))]
    pub(crate) axes: Vec<AxisName>,
    /// A point on the mirrors, in mm. Default: the origin.
    #[serde(default)]
    #[schemars(extend("example" = "[0.0, 0.0, 0.0]"))]
    pub(crate) at_mm: [f64; 3],
    /// How the polarization is mirrored. Default: reflect.
    #[serde(default)]
    pub(crate) polarization: Reflection,
}

#[derive(Clone, Copy, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Reflection {
    /// Like an arrow drawn on the tile: the component normal to the mirror changes sign.
    #[default]
    Reflect,
    /// Like a magnetization, which is a pseudovector: the components in the mirror plane change
    /// sign.
    Axial,
    /// Not changed.
    Keep,
}

#[derive(Clone, Copy, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum AxisName {
    X,
    Y,
    Z,
}

impl AxisName {
    /// 0, 1, 2 for x, y, z.
    pub(crate) fn index(self) -> usize {
        self as usize
    }

    pub(crate) fn letter(self) -> char {
        AXIS_LETTERS[self.index()]
    }
}

/// The letters of axes 0, 1, 2, in names of tiles and in keys.
pub(crate) const AXIS_LETTERS: [char; 3] = ['x', 'y', 'z'];

//! `[[tile]]` with its tables `grid` and `mirror`, `[kind.NAME]`, and `[[lattice]]`.

// Descriptions of the JSON Schema, which are no links, write tables in brackets.
#![allow(rustdoc::broken_intra_doc_links)]

use glam::DVec3;
use magsplice_magnet::{Axis, Tile, TileFault};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::TableFaults;
use crate::layout::NamedTile;
use crate::material::RecoilPermeability;
use crate::rotation::RotationTable;

/// Findings about angles in radians.
pub(crate) mod angles;
/// The tiles that each entry of the file makes.
mod entries;
/// All tiles of a file.
mod file_tiles;
/// Cells of a `[[lattice]]` become tiles.
pub(crate) mod lattice;
/// The rule that tiles do not overlap.
pub(crate) mod overlap;
/// Copies on a grid, and mirror images.
mod repeat;
/// The limits on all tiles together.
mod room;
/// One tile with its kind.
mod single;

pub(crate) use self::file_tiles::FileTiles;

/// The properties that tiles of one kind have in common.
#[derive(Deserialize, JsonSchema, Serialize)]
pub(crate) struct KindTable {
    /// Full side lengths along the tile's own axes, in mm.
    #[schemars(extend("example" = "[3.3, 1.7, 1.0]"))]
    size_mm: [f64; 3],
    /// Magnitude of the polarization, in T. Each tile gives its direction.
    strength_t: Option<f64>,
    /// Polarization J = mu0 M in the tile's own frame, in T.
    #[schemars(extend("example" = "[0.12, 0.0, 0.0]"))]
    polarization_t: Option<[f64; 3]>,
    /// Relative recoil permeability. Default: that of [material].
    recoil_permeability: Option<RecoilPermeability>,
}

/// A tile, single or repeated. Its polarization is given once: as polarization_t, as strength_t and
/// direction, or by its kind.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
pub(crate) struct TileTable {
    /// Unique name. Default: tile-1, tile-2 and so on, numbered in the order of the file.
    name: Option<String>,
    /// Name of the kind that gives the size.
    kind: Option<String>,
    /// Centre, in mm.
    #[schemars(extend("example" = "[0.0, 0.0, 0.5]"))]
    position_mm: [f64; 3],
    /// Full side lengths along the tile's own axes, in mm. Required unless a kind gives them.
    #[schemars(extend("example" = "[3.3, 1.7, 1.0]"))]
    size_mm: Option<[f64; 3]>,
    /// Polarization J = mu0 M in the tile's own frame, in T. Or give its magnitude as strength_t,
    /// with a direction.
    #[schemars(extend("example" = "[0.12, 0.0, 0.0]"))]
    polarization_t: Option<[f64; 3]>,
    /// Magnitude of the polarization, in T. Needs a direction.
    #[schemars(extend("example" = "0.12"))]
    strength_t: Option<f64>,
    /// Direction of the polarization in the tile's own frame, a vector of any length but zero.
    #[schemars(extend("example" = "[1.0, 1.0, 0.0]"))]
    direction: Option<[f64; 3]>,
    /// Angle of the polarization in the tile's own xy plane, from x towards y, in degrees. Goes
    /// with strength_t, instead of direction.
    direction_deg: Option<f64>,
    /// Angle of the polarization out of the tile's own xy plane towards z, in degrees. Goes with
    /// direction_deg. Default: 0.
    tilt_deg: Option<f64>,
    /// Relative recoil permeability. Default: that of its kind or of [material].
    recoil_permeability: Option<RecoilPermeability>,
    /// Rotation about the tile's centre, given once: as axis and angle_deg, as quaternion, as
    /// euler_deg and order, or as matrix.
    rotation: Option<RotationTable>,
    /// Copies on a regular grid.
    grid: Option<GridTable>,
    /// Mirror images of the tile and of all its copies on the grid.
    mirror: Option<MirrorTable>,
}

/// Copies of a tile on a regular grid that begins at the tile's position.
#[derive(Deserialize, JsonSchema, Serialize)]
#[schemars(extend("example" = "{ count = [4, 4, 1], pitch_mm = [5.0, 5.0, 0.0] }"))]
pub(crate) struct GridTable {
    /// Number of copies along x, y, z, the tile itself included.
    #[schemars(extend("example" = "[4, 4, 1]"))]
    count: [usize; 3],
    /// Distance between neighbouring copies along x, y, z, in mm.
    #[schemars(extend("example" = "[5.0, 5.0, 0.0]"))]
    pitch_mm: [f64; 3],
    /// Axes along which the polarization of every other copy is reversed.
    #[serde(default)]
    alternate: Vec<Axis>,
}

/// Mirror images of a tile and its copies.
#[derive(Deserialize, JsonSchema, Serialize)]
#[schemars(extend("example" = "{ axes = [\"x\"] }"))]
pub(crate) struct MirrorTable {
    /// Axes normal to the mirrors, which are applied one after the other.
    #[schemars(extend("example" = "[\"x\"]"))]
    axes: Vec<Axis>,
    /// A point on the mirrors, in mm. Default: the origin.
    #[serde(default)]
    #[schemars(extend("example" = "[0.0, 0.0, 0.0]"))]
    at_mm: [f64; 3],
    /// How the polarization is mirrored. Default: reflect.
    #[serde(default)]
    polarization: Reflection,
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

impl From<&NamedTile> for TileTable {
    /// A tile without its kind, which writes its polarization in components.
    fn from(named: &NamedTile) -> TileTable {
        TileTable {
            name: Some(named.name.clone()),
            position_mm: named.tile.position().to_array(),
            size_mm: Some(named.tile.size().to_array()),
            polarization_t: Some(named.tile.polarization_t().to_array()),
            recoil_permeability: named.permeability.map(Into::into),
            rotation: named.rotation.map(Into::into),
            ..TileTable::default()
        }
    }
}

/// Builds a tile, or adds every rule that it breaks. The rules are those of [`Tile::new`], with the
/// keys of the file.
fn checked_tile(position_mm: DVec3, size_mm: DVec3, polarization_t: DVec3, faults: &mut TableFaults) -> Option<Tile> {
    Tile::new(position_mm, size_mm, polarization_t)
        .map_err(|broken| {
            for fault in broken.0 {
                faults.add(in_keys_of_the_file(&fault));
            }
        })
        .ok()
}

fn in_keys_of_the_file(fault: &TileFault) -> String {
    let rule = fault.rule();
    match fault {
        TileFault::Position { axis, value } => format!("position_mm[{axis}] = {value}, {rule}"),
        TileFault::Size { axis, value } => format!("size_mm[{axis}] = {value}, {rule}"),
        TileFault::Aspect { shortest, .. } => format!("shortest side of size_mm = {shortest}, {rule}"),
        TileFault::Polarization { axis, value } => format!("polarization_t[{axis}] = {value}, {rule}"),
        TileFault::Rotation { norm } => format!("rotation has norm {norm}, {rule}"),
        other => other.to_string(),
    }
}

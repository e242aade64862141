//! `[tolerance.neighbour]`: another film nearby, from a layout file of its own.

// Descriptions of the JSON Schema, which are no links, write tables in brackets.
#![allow(rustdoc::broken_intra_doc_links)]

use glam::{DQuat, DVec3};
use magsplice_magnet::{MAX_LENGTH, Tile};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::TableFaults;
use crate::layout::NamedTile;
use crate::limits::MAX_TOLERANCE_TILES;
use crate::names::shown;
use crate::rotation::RotationTable;
use crate::tolerance::Neighbour;
use crate::tolerance::common::When;

/// Another film nearby, such as that of the opposing jaw of a gripper.
#[derive(Deserialize, JsonSchema, Serialize)]
pub(crate) struct NeighbourTable {
    /// Layout file, relative to the folder of this one. Its own [tolerance] does not count.
    layout: String,
    /// Place of its origin, in mm. Required.
    #[schemars(extend("example" = "[0.0, 0.0, -12.0]"))]
    position_mm: Option<[f64; 3]>,
    /// Rotation about its origin. Default: none.
    rotation: Option<RotationTable>,
    /// Whether it is there when the sensor is read at the reference point. Default: before.
    #[serde(default)]
    when: When,
}

impl NeighbourTable {
    /// The neighbour, or `None` after adding its faults. `read` gives the tiles of the layout at a
    /// path, or reports why there are none.
    pub(crate) fn resolve(
        &self,
        read: &dyn Fn(&str) -> Result<Vec<NamedTile>, String>,
        faults: &mut TableFaults,
    ) -> Option<Neighbour> {
        let before = faults.count();
        let position_mm = self.position_mm.unwrap_or_else(|| {
            faults.add("has no position_mm, the place of its origin, such as position_mm = [0, 0, -12]");
            [0.0; 3]
        });
        faults.point("position_mm", position_mm);
        let rotation = self.rotation.as_ref().and_then(|table| table.resolve(faults));
        let layout = shown(&self.layout);
        let named = match read(&self.layout) {
            Ok(named) if named.len() > MAX_TOLERANCE_TILES => {
                let rule = format_args!("must have at most {MAX_TOLERANCE_TILES}");
                return faults.refuse(format!("layout = \"{layout}\" has {} tiles, {rule}", named.len()));
            }
            Ok(named) => named,
            Err(why) => return faults.refuse(format!("layout = \"{layout}\": {why}")),
        };
        if faults.count() > before {
            return None;
        }
        let turn = rotation.map(|rotation| rotation.quaternion());
        let mut tiles = Vec::with_capacity(named.len());
        for NamedTile { name, tile, .. } in &named {
            let rule = format_args!("would be too far away, must be within {MAX_LENGTH:e} mm");
            let Some(tile) = placed(tile, position_mm.into(), turn) else {
                return faults.refuse(format!("its tile \"{}\" {rule}", shown(name)));
            };
            tiles.push(tile);
        }
        let (layout, later) = (self.layout.clone(), self.when == When::After);
        Some(Neighbour { tiles, layout, position_mm, rotation, later })
    }
}

impl From<&Neighbour> for NeighbourTable {
    fn from(neighbour: &Neighbour) -> NeighbourTable {
        NeighbourTable {
            layout: neighbour.layout.clone(),
            position_mm: Some(neighbour.position_mm),
            rotation: neighbour.rotation.map(Into::into),
            when: neighbour.later.into(),
        }
    }
}

/// A tile of the neighbour at its place beside the film.
fn placed(tile: &Tile, position_mm: DVec3, turn: Option<DQuat>) -> Option<Tile> {
    let (centre, rotation) = match turn {
        Some(turn) => (turn * tile.position(), (turn * tile.rotation()).normalize()),
        None => (tile.position(), tile.rotation()),
    };
    Tile::new(centre + position_mm, tile.size(), tile.polarization_t()).ok()?.rotated(rotation).ok()
}

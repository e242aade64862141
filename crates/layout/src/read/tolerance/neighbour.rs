//! `[tolerance.neighbour]`: another film nearby, from a layout file of its own.

use glam::{DQuat, DVec3};
use magsplice_magnet::{MAX_LENGTH, Tile};

use crate::layout::NamedTile;
use crate::limits::MAX_TOLERANCE_TILES;
use crate::read::faults::TableFaults;
use crate::read::names::shown;
use crate::read::rotation;
use crate::tables::tolerance::{NeighbourTable, When};
use crate::tolerance::Neighbour;

/// The neighbour, or `None` after adding its faults. `read` gives the tiles of the layout at a
/// path, or says why there are none.
pub(crate) fn resolve(
    table: &NeighbourTable,
    read: &dyn Fn(&str) -> Result<Vec<NamedTile>, String>,
    faults: &mut TableFaults,
) -> Option<Neighbour> {
    let before = faults.count();
    let position_mm = table.position_mm.unwrap_or_else(|| {
        faults.add("has no position_mm, the place of its origin, such as position_mm = [0, 0, -12]");
        [0.0; 3]
    });
    if !position_mm.iter().all(|c| c.abs() <= MAX_LENGTH) {
        faults.add(format!("position_mm = {position_mm:?}, must be three finite numbers"));
    }
    let rotation = table.rotation.as_ref().and_then(|table| rotation::resolve(table, faults));
    let named = match read(&table.layout) {
        Ok(named) if named.len() > MAX_TOLERANCE_TILES => {
            let (count, layout) = (named.len(), shown(&table.layout));
            faults.add(format!("layout = \"{layout}\" has {count} tiles, must have at most {MAX_TOLERANCE_TILES}"));
            return None;
        }
        Ok(named) => named,
        Err(why) => {
            faults.add(format!("layout = \"{}\": {why}", shown(&table.layout)));
            return None;
        }
    };
    if faults.count() > before {
        return None;
    }
    let turn = rotation.map(|rotation| rotation.quaternion());
    let mut tiles = Vec::with_capacity(named.len());
    for NamedTile { name, tile, .. } in &named {
        match placed(tile, position_mm.into(), turn) {
            Some(tile) => tiles.push(tile),
            None => {
                let name = shown(name);
                faults.add(format!("its tile \"{name}\" would be too far away, must be within {MAX_LENGTH:e} mm"));
                return None;
            }
        }
    }
    let (layout, later) = (table.layout.clone(), table.when == When::After);
    Some(Neighbour { tiles, layout, position_mm, rotation, later })
}

/// A tile of the neighbour at its place beside the film.
fn placed(tile: &Tile, position_mm: DVec3, turn: Option<DQuat>) -> Option<Tile> {
    let Some(turn) = turn else {
        let moved = Tile::new(tile.position() + position_mm, tile.size(), tile.polarization_t()).ok()?;
        return moved.rotated(tile.rotation()).ok();
    };
    let moved = Tile::new(turn * tile.position() + position_mm, tile.size(), tile.polarization_t()).ok()?;
    moved.rotated((turn * tile.rotation()).normalize()).ok()
}

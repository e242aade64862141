//! Rules for one tile: position, size, polarization. The rules are those of
//! [`Tile::new`](magsplice_magnet::Tile::new); the messages use the keys of the file.

use glam::DVec3;
use magsplice_magnet::{Tile, TileFault};

use crate::read::faults::TableFaults;

/// Builds a tile, or adds every rule that it breaks.
pub(crate) fn checked_tile(
    position_mm: DVec3,
    size_mm: DVec3,
    polarization_t: DVec3,
    faults: &mut TableFaults,
) -> Option<Tile> {
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

//! `[[tile]]` with its tables `grid` and `mirror`, `[kind.NAME]`, and `[[lattice]]`.

use glam::DVec3;
use magsplice_magnet::{Tile, TileFault};

use crate::faults::TableFaults;

/// Findings about angles in radians.
pub(crate) mod angles;
/// Discs as strips of cuboids.
pub(crate) mod disc;
/// The tiles that each entry of the file makes.
mod entries;
/// All tiles of a file.
mod file_tiles;
/// Intervals of a lattice along one axis.
mod interval;
/// Cells of a `[[lattice]]` become tiles.
pub(crate) mod lattice;
/// The rule that tiles do not overlap.
pub(crate) mod overlap;
/// Copies on a grid, and mirror images.
pub(crate) mod repeat;
/// The limits on all tiles together.
pub(crate) mod room;
/// One tile with its kind.
pub(crate) mod single;
/// A sinusoidal magnetization in slices.
pub(crate) mod wave;

pub(crate) use self::file_tiles::FileTiles;

/// Builds a tile, or adds every rule that it breaks. The rules of [`Tile::new`] apply, with the
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

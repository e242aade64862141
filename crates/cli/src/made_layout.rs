//! The layout of a film that was made: its tiles as they are instead of as ordered.

use magsplice::layout::{Expectations, Layout, NamedTile, Rotation};
use magsplice::magnet::overlaps;
use magsplice::prelude::{DQuat, Tile};

/// Replaces the tiles of a layout, and allows the depth to which they overlap. Requirements and the brief
/// are those of the film as ordered, and are left out.
pub(crate) fn replace_tiles(layout: &mut Layout, tiles: &[Tile]) {
    for (named, tile) in layout.tiles.iter_mut().zip(tiles) {
        if named.tile != *tile {
            *named = as_written(named, tile);
        }
    }
    let tiles = layout.bare_tiles();
    let deepest_mm = overlaps(&tiles).map(|pair| pair.depth).fold(0.0, f64::max);
    if deepest_mm > layout.overlap_mm {
        layout.overlap_mm = rounded_up(deepest_mm);
    }
    layout.expectations = Expectations::default();
    layout.brief = None;
}

/// A tile with its rotation as a layout writes it.
fn as_written(named: &NamedTile, tile: &Tile) -> NamedTile {
    if tile.rotation() == named.tile.rotation() {
        return NamedTile { tile: *tile, kind: None, ..named.clone() };
    }
    let DQuat { x, y, z, w } = tile.rotation();
    let rotation = Rotation::from_quaternion([x, y, z, w]).ok().filter(|_| tile.rotation() != DQuat::IDENTITY);
    // The quaternion that is read back from the file.
    let turned = rotation.and_then(|rotation| tile.rotated(rotation.quaternion()).ok());
    NamedTile { rotation, tile: turned.unwrap_or(*tile), kind: None, ..named.clone() }
}

/// A micrometre more at most, so that the number in the file allows the overlap.
fn rounded_up(depth_mm: f64) -> f64 {
    (1e3 * depth_mm).ceil() / 1e3
}

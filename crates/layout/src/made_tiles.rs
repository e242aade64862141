//! The layout of a film that was made: its tiles as they are instead of as ordered.

use magsplice_magnet::{Tile, overlaps};

use crate::expectations::Expectations;
use crate::layout::{Layout, NamedTile};

impl Layout {
    /// The layout of a film that was made: with its tiles as they are, in the same order, and the
    /// depth to which they overlap, or reach into iron, allowed. Requirements and the brief apply
    /// to the film as ordered, and are left out.
    pub fn with_made_tiles(mut self, tiles: &[Tile]) -> Layout {
        for (named, tile) in self.tiles.iter_mut().zip(tiles) {
            if named.tile != *tile {
                *named = as_written(named, tile);
            }
        }
        let bare = self.bare_tiles();
        let deepest_mm = overlaps(&bare).map(|pair| pair.depth).fold(self.iron.depth_of(&bare), f64::max);
        if deepest_mm > self.overlap_mm {
            self.overlap_mm = rounded_up(deepest_mm);
            self.iron = self.iron.with_allowed_depth(self.overlap_mm);
        }
        Layout { expectations: Expectations::default(), brief: None, ..self }
    }
}

/// A tile with its rotation as a layout writes it.
fn as_written(named: &NamedTile, tile: &Tile) -> NamedTile {
    if tile.rotation() == named.tile.rotation() {
        return NamedTile { tile: *tile, kind: None, ..named.clone() };
    }
    let rotation = NamedTile::new("", *tile).rotation;
    // The quaternion that is read back from the file.
    let turned = rotation.and_then(|rotation| tile.rotated(rotation.quaternion()).ok());
    NamedTile { rotation, tile: turned.unwrap_or(*tile), kind: None, ..named.clone() }
}

/// A micrometre more at most, so that the number in the file allows the overlap.
fn rounded_up(depth_mm: f64) -> f64 {
    (1e3 * depth_mm).ceil() / 1e3
}

//! Corners and faces of tiles.

use glam::DVec3;
use magsplice_magnet::Tile;

/// The corners of the six faces, counter-clockwise seen from outside. Bits 0, 1 and 2 of a corner
/// choose the upper end along x, y and z.
pub(crate) const FACES: [[usize; 4]; 6] =
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

/// A corner of a tile in the frame of the film, in millimetres.
pub(crate) fn corner_mm(tile: &Tile, corner: usize) -> DVec3 {
    let side = |axis: usize| if corner >> axis & 1 == 1 { 0.5 } else { -0.5 };
    tile.position() + tile.rotation() * (DVec3::new(side(0), side(1), side(2)) * tile.size())
}

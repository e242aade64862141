//! Faces of tiles.

/// The corners of the six faces, counter-clockwise seen from outside. Indices refer to
/// [`Tile::corners_mm`](magsplice_magnet::Tile::corners_mm).
pub(crate) const FACES: [[usize; 4]; 6] =
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

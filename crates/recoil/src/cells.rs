//! Tiles divided into cells.

use std::f64::consts::PI;

use glam::DVec3;
use magsplice_magnet::{Tile, TileFaults};

/// Factor in the number of cells along a side. That number is a multiple of the level: this factor
/// times the root of the ratio of the side to the shortest side, rounded. Cells at the edges are
/// narrow, so a side of three times the shortest needs no more cells than the shortest.
const CELLS_OF_LONG_SIDE: f64 = 0.7;

/// Largest multiple of the level.
const MOST_PER_LEVEL: usize = 4;

/// Unit to which faces between cells are rounded, in half sides rounded up to a power of 2. It is
/// far below the smallest cell.
const FACE_UNIT: f64 = 1.0 / (1_u64 << 30) as f64;

/// Smallest unit of faces, so that a middle has as many binary digits as a number.
const LEAST_FACE_UNIT: f64 = 1.0 / (1_u64 << 50) as f64;

/// Least shortest side in half sides: the cells at the ends of longer tiles are as long as if the
/// shortest side were this one, so that numbers represent their faces.
const LEAST_SHORTEST: f64 = FACE_UNIT;

/// The numbers of cells along the sides of a box at a level.
pub fn cell_counts(size: DVec3, level: usize) -> [usize; 3] {
    let shortest = size.min_element();
    [0, 1, 2].map(|axis: usize| {
        let multiple = CELLS_OF_LONG_SIDE * (size[axis] / shortest).sqrt();
        level.saturating_mul((multiple.round() as usize).clamp(1, MOST_PER_LEVEL))
    })
}

/// The number of cells of a tile at a level.
pub fn cell_count(size: DVec3, level: usize) -> usize {
    cell_counts(size, level).into_iter().fold(1, usize::saturating_mul)
}

/// The cells that fill a tile at a level, with its polarization and rotation.
///
/// Field and polarization vary most at edges, so cells at edges are narrow. Along a side of n cells
/// faces are at -cos(pi i / n) of the half side. Along a side of more cells than the level, the
/// distance from the nearer end is s (cosh(u) - 1) / 2, for u in equal steps and the shortest side
/// s: at an end the field varies over the length s, however long the side is, and farther from it
/// over the distance itself. At level 1 a tile that is not long is one cell, bit for bit.
///
/// # Errors
/// If a cell would be smaller or thinner than a tile may be.
pub fn cells(tile: &Tile, level: usize) -> Result<Vec<Tile>, TileFaults> {
    let counts = cell_counts(tile.size(), level);
    if counts == [1, 1, 1] {
        return Ok(vec![*tile]);
    }
    let sides = [0, 1, 2].map(|axis: usize| {
        let half = 0.5 * tile.size()[axis];
        let shortest = tile.size().min_element().max(LEAST_SHORTEST * half);
        match counts[axis] > level {
            true => intervals(half, counts[axis], graded(half, shortest), FACE_UNIT * shortest / half),
            false => intervals(half, counts[axis], |place| (0.5 * PI * place).sin(), FACE_UNIT),
        }
    });
    let mut cells = Vec::with_capacity(counts.iter().product());
    for (z, depth) in &sides[2] {
        for (y, width) in &sides[1] {
            for (x, length) in &sides[0] {
                let position = tile.position() + tile.rotation() * DVec3::new(*x, *y, *z);
                let size = DVec3::new(*length, *width, *depth);
                cells.push(Tile::new(position, size, tile.polarization_t())?.rotated(tile.rotation())?);
            }
        }
    }
    Ok(cells)
}

/// The place of a face in the half side, from -1 to 1, whose index is the fraction `place` of the
/// way from the middle to an end.
fn graded(half: f64, shortest: f64) -> impl Fn(f64) -> f64 {
    let middle = (1.0 + 2.0 * half / shortest).acosh();
    move |place: f64| {
        let from_end = 0.5 * shortest * (((1.0 - place.abs()) * middle).cosh() - 1.0);
        (1.0 - from_end / half) * place.signum()
    }
}

/// Middles and lengths of the intervals of one side. `place` is odd, and the faces between cells
/// are rounded to `unit` in half sides.
fn intervals(half: f64, count: usize, place: impl Fn(f64) -> f64, unit: f64) -> Vec<(f64, f64)> {
    // Faces between cells have few binary digits, so middles and lengths are exact, and the outer
    // faces are the faces of the tile to the last digit. They are odd about the middle.
    let unit = unit.max(LEAST_FACE_UNIT).log2().ceil().exp2() * half.log2().ceil().exp2();
    let face = |i: usize| {
        if i == 0 || i == count {
            return if i == 0 { -half } else { half };
        }
        let from_middle = (2.0 * i as f64 - count as f64) / count as f64;
        (half * place(from_middle) / unit).round() * unit
    };
    (0..count).map(|i| (0.5 * (face(i) + face(i + 1)), face(i + 1) - face(i))).collect()
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;

    #[test]
    fn cells_fill_the_tile_symmetrically() {
        let rotation = DQuat::from_rotation_x(0.4);
        let tile = Tile::new(DVec3::new(1.0, 2.0, 3.0), DVec3::new(8.0, 1.0, 3.0), DVec3::Y).unwrap();
        let tile = tile.rotated(rotation).unwrap();
        for level in 1..6 {
            let cells = cells(&tile, level).unwrap();
            assert_eq!(cells.len(), 2 * level * level * level);
            assert_eq!(cells.len(), cell_count(tile.size(), level));
            let volume: f64 = cells.iter().map(|cell| cell.size().element_product()).sum();
            assert!((volume - 24.0).abs() <= 1e-13 * 24.0, "{volume}");
            let centre: DVec3 = cells.iter().map(|cell| cell.position() * cell.size().element_product()).sum();
            assert!((centre / volume - tile.position()).length() <= 1e-14 * 24.0);
            for (first, second) in cells.iter().zip(cells.iter().skip(1)) {
                assert!(magsplice_magnet::overlap(first, second).is_none());
            }
        }
    }

    /// The faces of the outer cells are the faces of the tile.
    #[test]
    fn outer_faces_are_those_of_the_tile() {
        let tile = Tile::new(DVec3::new(2.5, 0.0, 0.5), DVec3::new(3.0, 6.0, 1.0), DVec3::X).unwrap();
        for level in 2..9 {
            let cells = cells(&tile, level).unwrap();
            let (first, last) = (cells.first().unwrap(), cells.last().unwrap());
            assert_eq!(first.position() - 0.5 * first.size(), DVec3::new(1.0, -3.0, 0.0));
            assert_eq!(last.position() + 0.5 * last.size(), DVec3::new(4.0, 3.0, 1.0));
        }
    }

    /// The cells at the ends of a long tile are about as thin as those of a compact tile, whatever
    /// its length.
    #[test]
    fn ends_of_long_tiles_are_divided_like_compact_tiles() {
        for level in 2..8 {
            let first = |length: f64| {
                let tile = Tile::new(DVec3::ZERO, DVec3::new(1.0, 1.0, length), DVec3::Z).unwrap();
                cells(&tile, level).unwrap()[0].size().z
            };
            for length in [5.0, 10.0, 100.0] {
                assert!((0.6..1.5).contains(&(first(length) / first(1.0))), "{level} {length}: {}", first(length));
            }
        }
    }

    /// A wire or a foil is divided too.
    #[test]
    fn sides_of_any_ratio_are_divided() {
        for length in [1e4, 1e8, 1e12, 1e20] {
            let tile = Tile::new(DVec3::ZERO, DVec3::new(length, 1.0, length), DVec3::Z).unwrap();
            let cells = cells(&tile, 4).unwrap();
            assert!(cells.iter().all(|cell| cell.size().min_element() > 0.0), "{length}");
            let volume: f64 = cells.iter().map(|cell| cell.size().element_product()).sum();
            assert!((volume / (length * length) - 1.0).abs() <= 1e-13, "{length}: {volume}");
        }
    }

    #[test]
    fn compact_tile_is_its_own_cell_at_level_one() {
        let tile = Tile::new(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.85, 3.3, 1.0), DVec3::Y).unwrap();
        assert_eq!(cells(&tile, 1).unwrap(), [tile]);
    }

    /// Faces are rounded relative to the sides: a power of two changes no digit.
    #[test]
    fn cells_scale_with_the_tile() {
        for scale in [2.0_f64.powi(-20), 2.0_f64.powi(10)] {
            for size in [DVec3::new(3.0, 2.0, 1.0), DVec3::new(0.7, 0.9, 15.0)] {
                let tile = |scale: f64| Tile::new(DVec3::ZERO, scale * size, DVec3::Z).unwrap();
                let scaled = cells(&tile(scale), 4).unwrap();
                for (scaled, cell) in scaled.iter().zip(cells(&tile(1.0), 4).unwrap()) {
                    assert_eq!(scaled.size(), scale * cell.size());
                    assert_eq!(scaled.position(), scale * cell.position());
                }
            }
        }
    }
}

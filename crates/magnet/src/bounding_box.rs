//! Boxes with sides along the axes.

use glam::DVec3;

use crate::tile::Tile;

/// A box with sides along the axes of the scene, from `lower` to `upper`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundingBox {
    /// Smallest coordinates.
    pub lower: DVec3,
    /// Largest coordinates.
    pub upper: DVec3,
}

impl BoundingBox {
    /// The smallest box around a tile, up to round-off.
    pub fn from_tile(tile: &Tile) -> BoundingBox {
        let half = 0.5 * tile.size();
        let rotation = tile.rotation();
        let reach = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().map(|axis| (rotation * (axis * half.dot(axis))).abs());
        let reach: DVec3 = reach.sum();
        BoundingBox { lower: tile.position() - reach, upper: tile.position() + reach }
    }

    /// The smallest box around tiles, up to round-off; without tiles it is empty, see
    /// [`BoundingBox::from_points`].
    pub fn from_tiles<'t>(tiles: impl IntoIterator<Item = &'t Tile>) -> BoundingBox {
        let boxes = tiles.into_iter().map(BoundingBox::from_tile);
        boxes.fold(BoundingBox::from_points(&[]), |all, tile| BoundingBox {
            lower: all.lower.min(tile.lower),
            upper: all.upper.max(tile.upper),
        })
    }

    /// The smallest box around points; without points an empty box, from infinity to minus
    /// infinity.
    pub fn from_points(points: &[DVec3]) -> BoundingBox {
        // Four points at a time: comparisons run in vectors and do not wait for each other.
        let (mut lower, mut upper) = ([f64::INFINITY; 12], [f64::NEG_INFINITY; 12]);
        let fours = points.chunks_exact(4);
        let rest = fours.remainder();
        for four in fours {
            let [a, b, c, d] = [four[0], four[1], four[2], four[3]];
            let coordinates = [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, d.x, d.y, d.z];
            for ((lower, upper), value) in lower.iter_mut().zip(&mut upper).zip(coordinates) {
                *lower = if value < *lower { value } else { *lower };
                *upper = if value > *upper { value } else { *upper };
            }
        }
        let of_fours = |values: [f64; 12]| [0, 3, 6, 9].map(|first| DVec3::from_slice(&values[first..]));
        let ends = |ends: [DVec3; 4]| ends.into_iter().chain(rest.iter().copied());
        BoundingBox {
            lower: ends(of_fours(lower)).fold(DVec3::INFINITY, DVec3::min),
            upper: ends(of_fours(upper)).fold(DVec3::NEG_INFINITY, DVec3::max),
        }
    }

    /// Half the side lengths.
    pub fn half_size(&self) -> DVec3 {
        0.5 * (self.upper - self.lower)
    }

    /// Centre.
    pub fn centre(&self) -> DVec3 {
        0.5 * (self.lower + self.upper)
    }

    /// The distance to another box along each axis; zero along axes on which they overlap.
    pub fn gap(&self, other: &BoundingBox) -> DVec3 {
        (self.lower - other.upper).max(other.lower - self.upper).max(DVec3::ZERO)
    }
}

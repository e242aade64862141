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

    /// The smallest box around points; of no points it is empty, from infinity to minus infinity.
    pub fn from_points(points: &[DVec3]) -> BoundingBox {
        // Several boxes, so that no comparison waits for the one before.
        let (mut lower, mut upper) = ([DVec3::INFINITY; 4], [DVec3::NEG_INFINITY; 4]);
        for points in points.chunks(lower.len()) {
            for ((lower, upper), point) in lower.iter_mut().zip(&mut upper).zip(points) {
                (*lower, *upper) = (lower.min(*point), upper.max(*point));
            }
        }
        let lower = lower.into_iter().fold(DVec3::INFINITY, DVec3::min);
        BoundingBox { lower, upper: upper.into_iter().fold(DVec3::NEG_INFINITY, DVec3::max) }
    }

    /// Half of its side lengths.
    pub fn half_size(&self) -> DVec3 {
        0.5 * (self.upper - self.lower)
    }

    /// Its centre.
    pub fn centre(&self) -> DVec3 {
        0.5 * (self.lower + self.upper)
    }

    /// The distance to another box along each axis; zero along an axis on which they overlap.
    pub fn gap(&self, other: &BoundingBox) -> DVec3 {
        (self.lower - other.upper).max(other.lower - self.upper).max(DVec3::ZERO)
    }
}

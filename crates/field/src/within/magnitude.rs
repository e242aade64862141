//! How large the fields of the tiles are, without computing them.

use glam::DVec3;

use crate::tile::Tile;
use crate::tolerances::LARGEST_FIELD_OVER_J;

/// A box with sides along the scene's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Box3 {
    pub(crate) lower: DVec3,
    pub(crate) upper: DVec3,
}

impl Box3 {
    /// Around a tile.
    pub(crate) fn of_tile(tile: &Tile) -> Box3 {
        let half = 0.5 * tile.size();
        let rotation = tile.rotation();
        let reach = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().map(|axis| (rotation * (axis * half.dot(axis))).abs());
        let reach: DVec3 = reach.sum();
        Box3 { lower: tile.position() - reach, upper: tile.position() + reach }
    }

    /// Around points.
    pub(crate) fn around(points: &[DVec3]) -> Box3 {
        let lower = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        Box3 { lower, upper: points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max) }
    }

    pub(crate) fn half_size(&self) -> DVec3 {
        0.5 * (self.upper - self.lower)
    }

    pub(crate) fn centre(&self) -> DVec3 {
        0.5 * (self.lower + self.upper)
    }

    /// How far another box is away along each axis; zero where they reach beside each other.
    pub(crate) fn gap(&self, other: &Box3) -> DVec3 {
        (self.lower - other.upper).max(other.lower - self.upper).max(DVec3::ZERO)
    }
}

/// At most the sum of the magnitudes of the fields of a tile's components of J, in tesla, from a distance on.
pub(crate) fn most_field_t(tile: &Tile, distance: f64) -> f64 {
    most_field_of_t(tile.size(), tile.polarization_t(), distance)
}

/// The same of a cuboid with these sides and this polarization.
///
/// |mu0 H| of a dipole m at r is at most 2 m / 4 pi r^3.
pub(crate) fn most_field_of_t(size: DVec3, polarization_t: DVec3, distance: f64) -> f64 {
    let dipoles = (size / distance).element_product() / (2.0 * std::f64::consts::PI);
    polarization_t.abs().element_sum() * dipoles.min(LARGEST_FIELD_OVER_J)
}

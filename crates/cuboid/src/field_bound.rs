//! A bound of the field of a cuboid that needs no evaluation of the field.

use glam::DVec3;
use magsplice_magnet::Tile;

use crate::tolerances::LARGEST_FIELD_OVER_J;

/// Upper bound, in tesla, of the sum of the magnitudes of the fields of a tile's components of J,
/// at and beyond a distance from the tile.
pub fn tile_field_bound_t(tile: &Tile, distance: f64) -> f64 {
    field_bound_t(tile.size(), tile.polarization_t(), distance)
}

/// [`tile_field_bound_t`] of a cuboid with these sides and this polarization in tesla.
///
/// |mu0 H| of a dipole m at r is at most 2 m / 4 pi r^3.
pub fn field_bound_t(size: DVec3, polarization_t: DVec3, distance: f64) -> f64 {
    let dipoles = (size / distance).element_product() / (2.0 * std::f64::consts::PI);
    polarization_t.abs().element_sum() * dipoles.min(LARGEST_FIELD_OVER_J)
}

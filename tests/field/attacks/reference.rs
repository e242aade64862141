//! The true field of adversarial scenes: by the oracle at some points, and by the exact field
//! within its own bound at all others.

use glam::{DQuat, DVec3};
use magsplice_field::{EXACT_BOUND, Quantity, Scene, Tile};
use magsplice_tests::oracle::Oracle;

/// Largest distance from a tile, and largest ratio of its sides, for the oracle of 57 digits. It
/// loses at most three digits for each decade of the distance, and of the ratio along two axes.
const MODERATE_RATIO: f64 = 1e5;

/// Error of a point in the frame of a rotated tile along each axis, in units of round-off of its
/// distance (docs/accuracy.md).
const POINT_ROUNDINGS: f64 = 4.0;

/// Oracles of 57 and of 130 digits.
pub(super) struct Reference {
    moderate: Oracle,
    best: Oracle,
}

impl Reference {
    pub(super) fn new() -> Reference {
        Reference { moderate: Oracle::for_moderate_scenes(), best: Oracle::new() }
    }

    /// B of all tiles, in tesla.
    pub(super) fn flux_density_t(&mut self, tiles: &[Tile], point: DVec3) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for tile in tiles {
            let (size, distance) = (tile.size(), (point - tile.position()).length());
            let is_moderate = distance.max(size.max_element()) < MODERATE_RATIO * size.min_element();
            let oracle = if is_moderate { &mut self.moderate } else { &mut self.best };
            sum += oracle.field(tile, point).flux_density_t;
        }
        sum
    }
}

/// Upper bound of the error of the exact field at a point, in tesla, with the rounding of the point
/// in the frames of rotated tiles.
pub(super) fn exact_error_t(tiles: &[Tile], point: DVec3) -> f64 {
    let of_component = |tile: &Tile, axis: DVec3| {
        let part = Tile::new(tile.position(), tile.size(), tile.polarization_t() * axis).expect("a valid tile");
        let part = part.rotated(tile.rotation()).expect("a rotation");
        Scene::new(&[part]).field(Quantity::FluxDensity, point).expect("off all edges").length()
    };
    let sum_t: f64 = tiles.iter().flat_map(|tile| DVec3::AXES.map(|axis| of_component(tile, axis))).sum();
    EXACT_BOUND * sum_t + rotation_error_t(tiles, point)
}

/// Upper bound, in tesla, of the change of B by the rounding of a point in the frames of rotated
/// tiles.
pub(super) fn rotation_error_t(tiles: &[Tile], point: DVec3) -> f64 {
    let rotated = tiles.iter().filter(|tile| tile.rotation() != DQuat::IDENTITY);
    rotated
        .map(|tile| {
            let own = tiles.iter().filter(|other| other.rotation() == tile.rotation());
            let farthest = own.map(|other| (point - other.position()).abs().element_sum()).fold(0.0, f64::max);
            // The same error along three axes.
            let moved = 3_f64.sqrt() * POINT_ROUNDINGS * 0.5 * f64::EPSILON * farthest;
            let gradient = Scene::new(&[*tile]).gradient(Quantity::FluxDensity, point).expect("off all edges");
            moved * gradient.to_cols_array().into_iter().map(|slope| slope * slope).sum::<f64>().sqrt()
        })
        .sum()
}

//! Readings with noise, for tests and examples.

use std::f64::consts::TAU;

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_magnet::{Quantity, Tile};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

pub(crate) fn normal(random: &mut ChaCha8Rng) -> f64 {
    let (radius, turn) = (1.0 - random.random::<f64>(), random.random::<f64>());
    (-2.0 * radius.ln()).sqrt() * (TAU * turn).cos()
}

/// Readings of the field of tiles with noise.
pub(crate) fn readings(tiles: &[Tile], points: &[DVec3], noise_t: f64, random: &mut ChaCha8Rng) -> Vec<DVec3> {
    let field_t = Scene::new(tiles).field_at(Quantity::FluxDensity, points).unwrap();
    field_t.into_iter().map(|b| b + noise_t * DVec3::from([(); 3].map(|()| normal(random)))).collect()
}

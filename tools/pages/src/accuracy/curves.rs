//! Worst errors of random tiles by distance and by closeness to an edge.

use std::path::Path;

use glam::{DMat3, DVec3};
use magsplice::field::{Quantity, Scene, Tile};
use magsplice_tests::oracle::Oracle;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::peers::{FieldCase, PeerFields, relative_error};

/// Worst errors at one distance.
pub(crate) struct ErrorsAtDistance {
    /// Distance in sizes of the tile.
    pub(crate) distance: f64,
    /// Relative errors of |B| by magsplice, magba and, if it was run, magpylib. Infinite where the
    /// result is not finite.
    pub(crate) fields: Vec<f64>,
    /// Relative error of the largest component of the gradient by magsplice.
    pub(crate) gradient: f64,
}

/// A tile at the origin with sides of 0.4 to 1 and any polarization.
fn random_tile(random: &mut ChaCha8Rng) -> Tile {
    let side = |random: &mut ChaCha8Rng| random.random_range(0.4..1.0);
    let size = DVec3::new(side(random), side(random), side(random));
    let j = DVec3::from([0, 1, 2].map(|_| random.random_range(-1.0..1.0)));
    Tile::new(DVec3::ZERO, size, j).expect("a valid tile")
}

/// Errors at 1 to 1e9 sizes from the centre, in all directions.
pub(crate) fn by_distance(python: Option<&Path>, points: usize) -> Result<Vec<ErrorsAtDistance>, String> {
    let distances = (0..=36).map(|quarter| 10_f64.powf(f64::from(quarter) / 4.0));
    curve(python, points, distances.collect(), |random, _, distance| {
        let direction = loop {
            let d = DVec3::from([0, 1, 2].map(|_| random.random_range(-1.0..1.0)));
            if (0.1..1.0).contains(&d.length()) {
                break d.normalize();
            }
        };
        distance * direction
    })
}

/// Errors at 1e-1 to 1e-16 sizes from the middle part of an edge parallel to z, inside and outside
/// the tile.
pub(crate) fn by_closeness(python: Option<&Path>, points: usize) -> Result<Vec<ErrorsAtDistance>, String> {
    let distances = (2..=32).map(|half| 10_f64.powf(-f64::from(half) / 2.0));
    curve(python, points, distances.collect(), |random, tile, distance| {
        let half = 0.5 * tile.size();
        let angle: f64 = random.random_range(0.0..std::f64::consts::TAU);
        let z = random.random_range(-0.8..0.8) * half.z;
        DVec3::new(half.x + distance * angle.cos(), half.y + distance * angle.sin(), z)
    })
}

fn curve(
    python: Option<&Path>,
    points: usize,
    distances: Vec<f64>,
    mut place: impl FnMut(&mut ChaCha8Rng, &Tile, f64) -> DVec3,
) -> Result<Vec<ErrorsAtDistance>, String> {
    let mut random = ChaCha8Rng::seed_from_u64(2024);
    let mut oracle = Oracle::new();
    let mut curve = Vec::new();
    for distance in distances {
        let mut cases: Vec<FieldCase> = Vec::new();
        while cases.len() < points {
            let tile = random_tile(&mut random);
            let point = place(&mut random, &tile, distance);
            // Rounding may move a point onto the edge, where the field is unbounded.
            if Scene::new(&[tile]).gradient(Quantity::FluxDensity, point).is_ok() {
                cases.push((vec![tile], point));
            }
        }
        let found = PeerFields::compute(python, &cases)?;
        let exact: Vec<DVec3> = cases.iter().map(|(t, p)| oracle.field(&t[0], *p).flux_density_t).collect();
        let worst = |found: &Vec<Option<DVec3>>| {
            found.iter().zip(&exact).map(|(f, e)| relative_error(*f, *e)).fold(0.0, f64::max)
        };
        let gradients = cases.iter().map(|(tiles, point)| {
            let found =
                Scene::new(tiles).gradient(Quantity::FluxDensity, *point).expect("checked when the case was chosen");
            let exact = oracle.gradient(&tiles[0], *point);
            largest(found - exact) / largest(exact)
        });
        let gradient = gradients.fold(0.0, f64::max);
        curve.push(ErrorsAtDistance { distance, fields: found.by_program().map(worst).collect(), gradient });
    }
    Ok(curve)
}

fn largest(m: DMat3) -> f64 {
    m.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max)
}

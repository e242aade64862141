//! Error against distance and against closeness to an edge.

use glam::{DMat3, DVec3};
use magsplice::field::{Scene, Tile};
use magsplice_tests::oracle::Oracle;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::peers::{Peers, error};

/// Random points at each distance.
const POINTS: usize = 24;

/// Worst errors at one distance.
pub(crate) struct At {
    /// In sizes of the tile.
    pub(crate) distance: f64,
    /// magsplice, magba and, if it was run, magpylib; infinite where no finite number came back.
    pub(crate) fields: Vec<f64>,
    /// The gradient of magsplice.
    pub(crate) gradient: f64,
}

fn tile(random: &mut ChaCha8Rng) -> Tile {
    let side = |random: &mut ChaCha8Rng| random.random_range(0.4..1.0);
    let size = DVec3::new(side(random), side(random), side(random));
    let j = DVec3::from([0, 1, 2].map(|_| random.random_range(-1.0..1.0)));
    Tile::new(DVec3::ZERO, size, j).expect("a valid tile")
}

/// Distances from the centre of 1 to 1e9 sizes, in all directions.
pub(crate) fn by_distance(peers: &Peers) -> Result<Vec<At>, String> {
    let distances = (0..=36).map(|quarter| 10_f64.powf(f64::from(quarter) / 4.0));
    curve(peers, distances.collect(), |random, _, distance| {
        let direction = loop {
            let d = DVec3::from([0, 1, 2].map(|_| random.random_range(-1.0..1.0)));
            if (0.1..1.0).contains(&d.length()) {
                break d.normalize();
            }
        };
        distance * direction
    })
}

/// Distances of 1e-1 to 1e-16 sizes from the middle parts of the edges parallel to z, inside and outside the tile.
pub(crate) fn by_closeness(peers: &Peers) -> Result<Vec<At>, String> {
    let distances = (2..=32).map(|half| 10_f64.powf(-f64::from(half) / 2.0));
    curve(peers, distances.collect(), |random, tile, distance| {
        let half = 0.5 * tile.size();
        let angle: f64 = random.random_range(0.0..std::f64::consts::TAU);
        let z = random.random_range(-0.8..0.8) * half.z;
        DVec3::new(half.x + distance * angle.cos(), half.y + distance * angle.sin(), z)
    })
}

fn curve(
    peers: &Peers,
    distances: Vec<f64>,
    mut place: impl FnMut(&mut ChaCha8Rng, &Tile, f64) -> DVec3,
) -> Result<Vec<At>, String> {
    let mut random = ChaCha8Rng::seed_from_u64(2024);
    let mut oracle = Oracle::new();
    let mut curve = Vec::new();
    for distance in distances {
        let mut cases = Vec::new();
        while cases.len() < POINTS {
            let tile = tile(&mut random);
            let point = place(&mut random, &tile, distance);
            // Rounding may put a point on the edge itself, where there is no field.
            if Scene::new(&[tile]).flux_density_gradient(point).is_ok() {
                cases.push((vec![tile], point));
            }
        }
        let answers = peers.ask(&cases)?;
        let exact: Vec<DVec3> = cases.iter().map(|(t, p)| oracle.field(&t[0], *p).flux_density_t).collect();
        let worst =
            |found: &Vec<Option<DVec3>>| found.iter().zip(&exact).map(|(f, e)| error(*f, *e)).fold(0.0, f64::max);
        let programs = [Some(&answers.magsplice), Some(&answers.magba), answers.magpylib.as_ref()];
        let gradients = cases.iter().map(|(tiles, point)| {
            let found = Scene::new(tiles).flux_density_gradient(*point).expect("kept only where there is one");
            let exact = oracle.gradient(&tiles[0], *point);
            largest(found - exact) / largest(exact)
        });
        let gradient = gradients.fold(0.0, f64::max);
        curve.push(At { distance, fields: programs.into_iter().flatten().map(worst).collect(), gradient });
    }
    Ok(curve)
}

fn largest(m: DMat3) -> f64 {
    m.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max)
}

//! Time by numbers of tiles and points, and speedup with threads.

use std::hint::black_box;
use std::time::Instant;

use glam::DVec3;
use magsplice::field::{Quantity, Scene, Tile};
use magsplice_benches::{Speedup, median, shipped_layout, speedups, working_volume, workloads};

use super::effort::SpeedEffort;

/// Time for a tile and a point in a scene with `count` tiles, or at `count` points.
pub(crate) struct TimeAtCount {
    pub(crate) count: usize,
    pub(crate) ns: f64,
}

/// Seconds of one evaluation, the median of `runs`.
fn seconds(scene: &Scene, points: &[DVec3], runs: usize) -> f64 {
    let mut field = vec![DVec3::ZERO; points.len()];
    let run = || {
        let start = Instant::now();
        scene.field_into(Quantity::FluxDensity, black_box(points), &mut field).expect("bounded");
        start.elapsed().as_secs_f64()
    };
    median(std::iter::repeat_with(run).take(runs).collect())
}

/// Times of square sheets of unit cubes of different polarization, at points below the whole sheet.
pub(crate) fn by_tiles(effort: SpeedEffort) -> Vec<TimeAtCount> {
    let sheet = |side: i32| -> Vec<Tile> {
        let cells = (0..side * side).map(|n| (f64::from(n % side), f64::from(n / side)));
        let half = 0.5 * f64::from(side);
        cells
            .map(|(x, y)| {
                let j = DVec3::new((0.6 * x).sin(), (0.6 * y).sin(), 0.2);
                Tile::new(DVec3::new(x + 0.5 - half, y + 0.5 - half, 0.5), DVec3::ONE, j).expect("a valid tile")
            })
            .collect()
    };
    [1, 3, 10, 32, 100]
        .into_iter()
        .map(|side| {
            let (tiles, half) = (sheet(side), 0.5 * f64::from(side));
            let count = (effort.pairs / tiles.len()).clamp(64, 20_000) as i32;
            let points: Vec<DVec3> = (0..count)
                .map(|n| {
                    let n = f64::from(n);
                    DVec3::new(half * (1.7 * n).sin(), half * (2.3 * n).cos(), -3.0 - (0.9 * n).sin())
                })
                .collect();
            let seconds = seconds(&Scene::new(&tiles), &points, effort.runs);
            TimeAtCount { count: tiles.len(), ns: 1e9 * seconds / (tiles.len() * points.len()) as f64 }
        })
        .collect()
}

fn film() -> (Scene, usize) {
    let tiles = shipped_layout("published-film").bare_tiles();
    (Scene::new(&tiles), tiles.len())
}

/// Times of the published film at points of its working volume.
pub(crate) fn by_points(effort: SpeedEffort) -> Vec<TimeAtCount> {
    let (scene, tiles) = film();
    let points: Vec<DVec3> = working_volume([81, 81, 41]).points().collect();
    [1, 10, 100, 1_000, 10_000, 100_000]
        .into_iter()
        .filter(|count| count * tiles <= 4 * effort.pairs)
        .map(|count| {
            let chosen: Vec<DVec3> = (0..count).map(|n| points[n * points.len() / count]).collect();
            // Calls with few points are repeated, because one is below the resolution of the clock.
            let calls = (1000 / count).max(1);
            let repeat = |_| (0..calls).map(|_| seconds(&scene, &chosen, 1)).sum::<f64>() / calls as f64;
            let seconds = median((0..effort.runs).map(repeat).collect());
            TimeAtCount { count, ns: 1e9 * seconds / (tiles * count) as f64 }
        })
        .collect()
}

/// Speedups of the published film with two threads and more.
pub(crate) fn by_threads(effort: SpeedEffort) -> Vec<Speedup> {
    let film = workloads().into_iter().find(|workload| workload.name == "film-exact").expect("a film");
    speedups(&film.thinned(4 * effort.pairs), 3 * effort.runs)
}

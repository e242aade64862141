//! Times of three programs on the same scenes, in interleaved runs.

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use glam::DVec3;
use magsplice::field::{Quantity, Scene};
use magsplice_benches::{Magba, Workload, median, workloads};
use nalgebra::Vector3;

use super::effort::SpeedEffort;
use crate::magpylib::Magpylib;

/// Times of one scene.
pub(crate) struct SceneTimes {
    pub(crate) name: &'static str,
    pub(crate) tiles: usize,
    pub(crate) points: usize,
    /// Median nanoseconds for a tile and a point by magsplice, magba and, if it was run, magpylib.
    pub(crate) ns: [Option<f64>; 3],
    /// Times of magba and magpylib over the time of magsplice, medians over interleaved pairs of
    /// runs.
    pub(crate) ratios: [Option<f64>; 2],
}

/// Times of all workloads; without `python` magpylib is omitted.
pub(crate) fn measure(python: Option<&Path>, effort: SpeedEffort) -> Result<Vec<SceneTimes>, String> {
    workloads().into_iter().map(|workload| times(workload.thinned(effort.peer_pairs), python, effort)).collect()
}

fn times(workload: Workload, python: Option<&Path>, effort: SpeedEffort) -> Result<SceneTimes, String> {
    let pairs = workload.pairs() as f64;
    let Workload { name, tiles, points, .. } = workload;
    let scene = Scene::new(&tiles);
    let magba = Magba::new(&tiles, &points);
    let mut magpylib = python.map(|python| Magpylib::start(python, &tiles, &points)).transpose()?;
    let (mut ours, mut theirs) = (vec![DVec3::ZERO; points.len()], vec![Vector3::zeros(); points.len()]);
    let mut seconds: [Vec<f64>; 3] = [const { Vec::new() }; 3];
    for _ in 0..effort.runs {
        let start = Instant::now();
        scene.field_into(Quantity::FluxDensity, black_box(&points), &mut ours).map_err(|e| e.to_string())?;
        seconds[0].push(start.elapsed().as_secs_f64());
        let start = Instant::now();
        magba.field(&mut theirs);
        seconds[1].push(start.elapsed().as_secs_f64());
        if let Some(magpylib) = &mut magpylib {
            seconds[2].push(magpylib.run()?);
        }
    }
    let ratio = |peer: usize| {
        let pairs = seconds[peer].iter().zip(&seconds[0]);
        (!seconds[peer].is_empty()).then(|| median(pairs.map(|(theirs, ours)| theirs / ours).collect()))
    };
    Ok(SceneTimes {
        name,
        tiles: tiles.len(),
        points: points.len(),
        ratios: [ratio(1), ratio(2)],
        ns: seconds.map(|s| (!s.is_empty()).then(|| 1e9 * median(s) / pairs)),
    })
}

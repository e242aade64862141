//! The same scene by three programs, one after the other, again and again.

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use glam::DVec3;
use magsplice::field::{Quantity, Scene};
use magsplice_benches::{Magba, Magpylib, Workload, median, workloads};
use nalgebra::Vector3;

use crate::Effort;

/// One scene.
pub(crate) struct Row {
    pub(crate) name: &'static str,
    pub(crate) tiles: usize,
    pub(crate) points: usize,
    /// Nanoseconds for a tile and a point, median: magsplice, magba, magpylib if it was asked.
    pub(crate) ns: [Option<f64>; 3],
    /// How many times faster than magba and magpylib, median over interleaved pairs.
    pub(crate) ratios: [Option<f64>; 2],
}

pub(crate) fn measure(python: Option<&Path>, effort: Effort) -> Result<Vec<Row>, String> {
    workloads().into_iter().map(|workload| row(workload.thinned(effort.peer_pairs), python, effort)).collect()
}

fn row(workload: Workload, python: Option<&Path>, effort: Effort) -> Result<Row, String> {
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
    Ok(Row {
        name,
        tiles: tiles.len(),
        points: points.len(),
        ratios: [ratio(1), ratio(2)],
        ns: seconds.map(|s| (!s.is_empty()).then(|| 1e9 * median(s) / pairs)),
    })
}

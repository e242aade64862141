//! Speedup of a scene with threads, beside the most that the machine gives.

use std::hint::black_box;
use std::time::Instant;

use glam::DVec3;
use magsplice::field::{Quantity, Scene};
use rayon::ThreadPool;

use crate::workloads::{Workload, median};

/// Speedup with a number of threads over one thread; medians over interleaved runs.
pub struct Speedup {
    /// Number of threads that share the points of one scene.
    pub threads: usize,
    /// Time of one thread over the time of `threads` threads.
    pub times: f64,
    /// The speedup of `threads` independent scenes evaluated at the same time, one thread each.
    /// This is the most that the machine gives: its processors share memory, caches and heat with
    /// each other and with other programs.
    pub apart: f64,
}

/// Speedups for 2, 4, 8 .. threads, up to as many as the machine has.
///
/// # Panics
/// If a point has no field, `runs` is zero, or a thread cannot be started.
pub fn speedups(workload: &Workload, runs: usize) -> Vec<Speedup> {
    let most = std::thread::available_parallelism().map_or(1, usize::from);
    let counts = std::iter::successors(Some(2), |n| Some(2 * n)).take_while(|n| *n <= most);
    counts.map(|threads| speedup(workload, threads, runs)).collect()
}

fn speedup(workload: &Workload, threads: usize, runs: usize) -> Speedup {
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let (many, alone) = (pool(threads), pool(1));
    let mut copies: Vec<SceneCopy> = (0..threads).map(|_| SceneCopy::new(workload, pool(1))).collect();
    let mut copy = SceneCopy::new(workload, alone);
    let mut ratios = [Vec::new(), Vec::new()];
    // The first run prepares the tables and is not counted.
    for run in 0..=runs {
        let alone_s = seconds(|| copy.evaluate());
        let many_s = seconds(|| many.install(|| field_into(&copy.scene, &workload.points, &mut copy.field)));
        let apart_s = seconds(|| {
            std::thread::scope(|scope| copies.iter_mut().for_each(|copy| drop(scope.spawn(|| copy.evaluate()))));
        });
        if run > 0 {
            ratios[0].push(alone_s / many_s);
            ratios[1].push(threads as f64 * alone_s / apart_s);
        }
    }
    let [times, apart] = ratios.map(median);
    Speedup { threads, times, apart }
}

/// A copy of a scene with its own tables, points, results and thread.
struct SceneCopy {
    scene: Scene,
    points: Vec<DVec3>,
    field: Vec<DVec3>,
    pool: ThreadPool,
}

impl SceneCopy {
    fn new(workload: &Workload, pool: ThreadPool) -> SceneCopy {
        let points = workload.points.clone();
        SceneCopy { scene: Scene::new(&workload.tiles), field: vec![DVec3::ZERO; points.len()], points, pool }
    }

    fn evaluate(&mut self) {
        self.pool.install(|| field_into(&self.scene, &self.points, &mut self.field));
    }
}

fn field_into(scene: &Scene, points: &[DVec3], field: &mut [DVec3]) {
    scene.field_into(Quantity::FluxDensity, black_box(points), field).expect("bounded");
}

fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

//! What threads are worth, beside what the machine has to give.

use std::hint::black_box;
use std::time::Instant;

use glam::DVec3;
use magsplice::field::{Quantity, Scene};
use rayon::ThreadPool;

use crate::{Workload, median};

/// A number of threads against one; medians over interleaved runs.
pub struct Speedup {
    /// Which share the points of one scene.
    pub threads: usize,
    /// How many times faster than one thread.
    pub times: f64,
    /// The same for so many scenes at the same time that know nothing of each other, one thread each: the most that this machine gives, whose processors share
    /// memory, caches and heat with each other and with other programs.
    pub apart: f64,
}

/// For 2, 4, 8 .. threads, as many as the machine has.
///
/// # Panics
/// If a point has no field, no run is wanted, or a thread cannot be started.
pub fn speedups(workload: &Workload, runs: usize) -> Vec<Speedup> {
    let most = std::thread::available_parallelism().map_or(1, usize::from);
    let counts = std::iter::successors(Some(2), |n| Some(2 * n)).take_while(|n| *n <= most);
    counts.map(|threads| speedup(workload, threads, runs)).collect()
}

fn speedup(workload: &Workload, threads: usize, runs: usize) -> Speedup {
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let (many, alone) = (pool(threads), pool(1));
    let mut copies: Vec<Copy> = (0..threads).map(|_| Copy::new(workload, pool(1))).collect();
    let mut copy = Copy::new(workload, alone);
    let mut ratios = [Vec::new(), Vec::new()];
    // The first run makes the tables.
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

/// A scene with its own tables, points and results, and a thread for it.
struct Copy {
    scene: Scene,
    points: Vec<DVec3>,
    field: Vec<DVec3>,
    pool: ThreadPool,
}

impl Copy {
    fn new(workload: &Workload, pool: ThreadPool) -> Copy {
        let points = workload.points.clone();
        Copy { scene: Scene::new(&workload.tiles), field: vec![DVec3::ZERO; points.len()], points, pool }
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

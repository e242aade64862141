//! Time of a film with as many points as tiles, exact and within a tolerance.

use std::hint::black_box;
use std::time::Instant;

use glam::DVec3;
use magsplice::field::{Accuracy, Quantity, Scene, Tolerance};

use crate::workloads::{median, points_below, square_film};

/// The exact field is computed for at most this many tile-point pairs, but for at least
/// [`LEAST_EXACT_POINTS`] points; its time is extrapolated to all points.
const EXACT_PAIRS: usize = 1_000_000_000;
/// See [`EXACT_PAIRS`].
const LEAST_EXACT_POINTS: usize = 4096;

/// Direct summation sorts the points of a list in blocks of this size.
const SORTED_BLOCK: usize = 16_384;
/// Number of neighbouring points of a block that direct summation evaluates as one batch.
const BATCH: usize = 512;

/// Times of one film, in seconds, and its error.
pub struct Growth {
    /// Number of tiles, and of points.
    pub tiles: usize,
    /// Time to build the scene from its tiles.
    pub scene_s: f64,
    /// Time of the first evaluation, which also builds the tree.
    pub first_s: f64,
    /// Time of the second evaluation at the same points.
    pub again_s: f64,
    /// Time of the exact field with prepared tables, measured at [`Growth::exact_points`] points
    /// and scaled to all.
    pub exact_s: f64,
    /// Time to prepare the tables of the exact field, a part of its first evaluation.
    pub exact_tables_s: f64,
    /// Number of points at which the exact field was computed.
    pub exact_points: usize,
    /// Largest relative error of |B| at these points.
    pub worst: f64,
}

impl Growth {
    /// Time from the tiles to the field, in seconds.
    pub fn everything_s(&self) -> f64 {
        self.scene_s + self.first_s
    }

    /// Time from the tiles to the exact field, in seconds.
    pub fn exact_everything_s(&self) -> f64 {
        self.scene_s + self.exact_tables_s + self.exact_s
    }

    /// The exponent p of the growth of `time` from this film to a larger one, as (number of
    /// tiles)^p.
    pub fn exponent_to(&self, larger: &Growth, time: impl Fn(&Growth) -> f64) -> f64 {
        (time(larger) / time(self)).ln() / (larger.tiles as f64 / self.tiles as f64).ln()
    }
}

/// Times and error of a film of `side` x `side` tiles with as many points below it.
///
/// Each of the `runs` runs rebuilds everything, alternating with the exact field; times are
/// medians.
///
/// # Panics
/// If a point has no field, or `runs` is zero.
pub fn growth(side: usize, tolerance: Tolerance, runs: usize) -> Growth {
    let tiles = square_film(side);
    let points = points_below(side, tiles.len());
    let chosen = neighbourhoods(&points, (EXACT_PAIRS / tiles.len()).max(LEAST_EXACT_POINTS));
    let some: Vec<DVec3> = chosen.iter().map(|&index| points[index]).collect();
    let (mut field, mut truth) = (vec![DVec3::ZERO; points.len()], vec![DVec3::ZERO; some.len()]);
    let evaluate = |scene: &Scene, points: &[DVec3], field: &mut [DVec3]| {
        let start = Instant::now();
        scene.field_into(Quantity::FluxDensity, black_box(points), field).expect("bounded");
        start.elapsed().as_secs_f64()
    };
    let mut seconds = [const { Vec::new() }; 5];
    for _ in 0..runs {
        let start = Instant::now();
        let exact = Scene::new(black_box(&tiles));
        seconds[0].push(start.elapsed().as_secs_f64());
        let within = exact.clone().with_accuracy(Accuracy::Within(tolerance));
        seconds[1].push(evaluate(&within, &points, &mut field));
        seconds[2].push(evaluate(&within, &points, &mut field));
        let first = evaluate(&exact, &some, &mut truth);
        let again = evaluate(&exact, &some, &mut truth);
        seconds[3].push(again * points.len() as f64 / some.len() as f64);
        seconds[4].push((first - again).max(0.0));
    }
    let apart = chosen.iter().zip(&truth).map(|(&index, exact)| (field[index] - *exact).length() / exact.length());
    let worst = apart.fold(0.0, f64::max);
    let [scene_s, first_s, again_s, exact_s, exact_tables_s] = seconds.map(median);
    Growth { tiles: tiles.len(), scene_s, first_s, again_s, exact_s, exact_tables_s, exact_points: some.len(), worst }
}

/// Indices of about `most` points, or of all if there are no more.
///
/// Whole neighbourhoods are picked, evenly over the film, with the density of the whole list.
/// Points picked one by one would be farther from each other, and direct summation would take
/// several times longer for each.
fn neighbourhoods(points: &[DVec3], most: usize) -> Vec<usize> {
    if points.len() <= most {
        return (0..points.len()).collect();
    }
    let mut first: Vec<usize> = (0..points.len().min(SORTED_BLOCK)).collect();
    first.sort_by(|&a, &b| points[a].x.total_cmp(&points[b].x));
    let mut all: Vec<&[usize]> = Vec::new();
    let strips = first.len() / (4 * BATCH);
    let strip = first.len().div_ceil(strips.max(1));
    for strip in first.chunks_mut(strip) {
        strip.sort_by(|&a, &b| points[a].y.total_cmp(&points[b].y));
        all.extend(strip.chunks(BATCH));
    }
    let keep = (most / BATCH).clamp(1, all.len());
    (0..keep).flat_map(|i| all[i * all.len() / keep]).copied().collect()
}

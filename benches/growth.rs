//! How the time of a film grows with as many points as tiles, to a tolerance.

use std::hint::black_box;
use std::time::Instant;

use glam::DVec3;
use magsplice::field::{Accuracy, Quantity, Scene, Tolerance};

use crate::{median, points_below, square_film};

/// Tile-point pairs that the exact field is computed for, and the least points; the rest is extrapolated.
const EXACT_PAIRS: usize = 1_000_000_000;
const LEAST_EXACT_POINTS: usize = 4096;

/// The exact field takes so many points of a list at a time, and of these so many neighbours together.
const REGROUPED: usize = 16_384;
const TOGETHER: usize = 512;

/// One film, seconds.
pub struct Growth {
    /// As many points.
    pub tiles: usize,
    /// Tiles to scene.
    pub scene_s: f64,
    /// The first evaluation, which makes the tree.
    pub first_s: f64,
    /// The same points again.
    pub again_s: f64,
    /// The exact field at a part of the points, whose tables have been made, times how many it stands for.
    pub exact_s: f64,
    /// What the exact field takes longer the first time, when its tables are made.
    pub exact_tables_s: f64,
    /// Points of the exact field.
    pub exact_points: usize,
    /// The largest difference to the exact field, of its length.
    pub worst: f64,
}

impl Growth {
    /// From tiles to the field.
    pub fn everything_s(&self) -> f64 {
        self.scene_s + self.first_s
    }

    /// Everything by the exact field.
    pub fn exact_everything_s(&self) -> f64 {
        self.scene_s + self.exact_tables_s + self.exact_s
    }

    /// The power of their number with which a time grows from this film to a larger one.
    pub fn exponent_to(&self, larger: &Growth, time: impl Fn(&Growth) -> f64) -> f64 {
        (time(larger) / time(self)).ln() / (larger.tiles as f64 / self.tiles as f64).ln()
    }
}

/// A film of `side` x `side` tiles and as many points below it, everything anew in each of so many runs, in turns with the exact field; medians.
///
/// # Panics
/// If a point has no field, or no run is wanted.
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

/// Indices of at most so many points, or all if they are few. Single points would lie farther from each other than in the whole list, and take the exact field
/// several times longer; so neighbourhoods are chosen, evenly over the film, that are as dense as in a list of all points.
fn neighbourhoods(points: &[DVec3], most: usize) -> Vec<usize> {
    if points.len() <= most {
        return (0..points.len()).collect();
    }
    let mut first: Vec<usize> = (0..points.len().min(REGROUPED)).collect();
    first.sort_by(|&a, &b| points[a].x.total_cmp(&points[b].x));
    let mut all: Vec<&[usize]> = Vec::new();
    let strips = first.len() / (4 * TOGETHER);
    let strip = first.len().div_ceil(strips.max(1));
    for strip in first.chunks_mut(strip) {
        strip.sort_by(|&a, &b| points[a].y.total_cmp(&points[b].y));
        all.extend(strip.chunks(TOGETHER));
    }
    let keep = (most / TOGETHER).clamp(1, all.len());
    (0..keep).flat_map(|i| all[i * all.len() / keep]).copied().collect()
}

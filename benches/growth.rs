//! How the time of a film grows with as many points as tiles, to a tolerance.

use std::hint::black_box;
use std::time::Instant;

use glam::DVec3;
use magsplice::field::{Accuracy, Quantity, Scene, Tolerance};

use crate::{evenly_thinned, median, points_below, square_film};

/// Tile-point pairs that the exact field is computed for; the rest is extrapolated.
const EXACT_PAIRS: usize = 100_000_000;

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
    /// The exact field at thinned points, times how many it stands for.
    pub exact_s: f64,
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
        self.scene_s + self.exact_s
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
    let thinned = evenly_thinned(&points, EXACT_PAIRS / tiles.len());
    let some: Vec<DVec3> = thinned.iter().map(|&index| points[index]).collect();
    let (mut field, mut truth) = (vec![DVec3::ZERO; points.len()], vec![DVec3::ZERO; some.len()]);
    let evaluate = |scene: &Scene, points: &[DVec3], field: &mut [DVec3]| {
        let start = Instant::now();
        scene.field_into(Quantity::FluxDensity, black_box(points), field).expect("bounded");
        start.elapsed().as_secs_f64()
    };
    let mut seconds = [const { Vec::new() }; 4];
    for _ in 0..runs {
        let start = Instant::now();
        let exact = Scene::new(black_box(&tiles));
        seconds[0].push(start.elapsed().as_secs_f64());
        let within = exact.clone().with_accuracy(Accuracy::Within(tolerance));
        seconds[1].push(evaluate(&within, &points, &mut field));
        seconds[2].push(evaluate(&within, &points, &mut field));
        seconds[3].push(evaluate(&exact, &some, &mut truth) * points.len() as f64 / some.len() as f64);
    }
    let apart = thinned.iter().zip(&truth).map(|(&index, exact)| (field[index] - *exact).length() / exact.length());
    let worst = apart.fold(0.0, f64::max);
    let [scene_s, first_s, again_s, exact_s] = seconds.map(median);
    Growth { tiles: tiles.len(), scene_s, first_s, again_s, exact_s, exact_points: some.len(), worst }
}

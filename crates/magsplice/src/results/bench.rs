//! How fast the field of a film is computed: of the same points, exact and to tolerances, on one
//! thread and on all.

use std::hint::black_box;
use std::time::{Duration, Instant};

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_magnet::{Accuracy, PointErrors, Quantity, Tolerance};
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use serde::Serialize;

use super::source::LayoutSource;
use super::table::Points;
use crate::film::Film;
use crate::stage::Stage;

/// Tolerances that are measured, as fractions of |B|.
const FRACTIONS: [f64; 3] = [1e-3, 1e-6, 1e-9];

/// Shortest time of a sample. A faster evaluation is repeated, because a clock and the start of
/// threads take microseconds.
const SHORTEST_SAMPLE: Duration = Duration::from_millis(5);

/// Largest number of evaluations in one sample.
const MAX_REPEATS: f64 = 1e4;

/// Numbers of rounds: the fewest for a meaningful median, and the most that still improve it.
const ROUNDS: [usize; 2] = [3, 201];

/// Times of the field of a film.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FilmBench {
    /// The layout.
    #[serde(flatten)]
    pub source: LayoutSource,
    /// Number of tiles.
    pub tiles: usize,
    /// Number of points.
    pub points: usize,
    /// Number of tiles times number of points.
    pub pairs: f64,
    /// Number of rounds; each measures every case once.
    pub rounds: usize,
    /// The exact field on one thread first.
    pub cases: Vec<BenchCase>,
}

/// The times of one field of all points, for one accuracy and number of threads; `None` where the
/// tolerance cannot be kept.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BenchCase {
    /// Accuracy of the field.
    pub accuracy: Accuracy,
    /// Number of threads.
    pub threads: usize,
    /// Pairs of a tile and a point per second.
    pub pairs_per_second: Option<f64>,
    /// The median of the rounds.
    pub seconds: Option<f64>,
    /// The fastest round.
    pub least_seconds: Option<f64>,
    /// The slowest round.
    pub largest_seconds: Option<f64>,
    /// Time of the exact field on as many threads, divided by this time.
    pub times_exact: Option<f64>,
    /// Why there is no field.
    #[serde(skip)]
    pub errors: Option<PointErrors>,
}

impl Film {
    /// Measures the field at points for about `budget`.
    ///
    /// # Errors
    /// If a thread cannot be started.
    pub fn bench(&self, points: &Points, budget: Duration) -> Result<FilmBench, ThreadPoolBuildError> {
        let (scene, layout) = (self.scene(), self.layout());
        let tolerances = FRACTIONS.map(|fraction| Tolerance::relative(fraction).expect("greater than 0"));
        let accuracies: Vec<Accuracy> =
            std::iter::once(Accuracy::Exact).chain(tolerances.map(Accuracy::Within)).collect();
        let scenes: Vec<Scene> = accuracies.iter().map(|accuracy| scene.clone().with_accuracy(*accuracy)).collect();
        let mut counts = vec![1, rayon::current_num_threads()];
        counts.dedup();
        let pools: Vec<ThreadPool> =
            counts.iter().map(|n| ThreadPoolBuilder::new().num_threads(*n).build()).collect::<Result<_, _>>()?;
        let mut field = vec![DVec3::ZERO; points.len()];
        let mut evaluate = |scene: &Scene, pool: &ThreadPool| -> Result<Duration, PointErrors> {
            let started = Instant::now();
            pool.install(|| match points {
                Points::Grid(grid) => scene.field_on_grid_into(Quantity::FluxDensity, grid, &mut field),
                Points::Scattered(points) => scene.field_into(Quantity::FluxDensity, points, &mut field),
            })?;
            black_box(&mut field);
            Ok(started.elapsed())
        };

        // The first evaluation warms caches and threads, and says how often a sample repeats it.
        let started = Instant::now();
        let mut cases = Vec::new();
        for (pool, threads) in pools.iter().zip(&counts) {
            for (scene, accuracy) in scenes.iter().zip(&accuracies) {
                let repeats = evaluate(scene, pool).map(|took| {
                    let repeats = SHORTEST_SAMPLE.as_secs_f64() / took.as_secs_f64().max(f64::MIN_POSITIVE);
                    repeats.ceil().clamp(1.0, MAX_REPEATS) as usize
                });
                cases.push((scene, pool, *accuracy, *threads, repeats, Vec::new()));
            }
        }
        let mut rounds = 0;
        while rounds < ROUNDS[0] || (rounds < ROUNDS[1] && started.elapsed() < budget) {
            self.tell(Stage { name: "measuring", done: rounds, of: None, unit: "rounds" });
            for (scene, pool, _, _, repeats, samples) in &mut cases {
                let Ok(count) = *repeats else { continue };
                let total = (0..count).try_fold(Duration::ZERO, |total, _| Ok(total + evaluate(scene, pool)?));
                match total {
                    Ok(total) => samples.push(total.as_secs_f64() / count as f64),
                    Err(errors) => *repeats = Err(errors),
                }
            }
            rounds += 1;
        }
        let pairs = scene.tile_count() as f64 * points.len() as f64;
        let mut found: Vec<BenchCase> = Vec::new();
        for (_, _, accuracy, threads, repeats, samples) in cases {
            let (times, errors) = match repeats {
                Ok(_) => (Some(median_and_ends(samples)), None),
                Err(errors) => (None, Some(errors)),
            };
            let [median, least_seconds, largest_seconds] = [0, 1, 2].map(|of| times.map(|times| times[of]));
            let exact = found.iter().find(|case| case.accuracy == Accuracy::Exact && case.threads == threads);
            let exact = if accuracy == Accuracy::Exact { median } else { exact.and_then(|case| case.seconds) };
            found.push(BenchCase {
                accuracy,
                threads,
                pairs_per_second: median.map(|median| pairs / median),
                seconds: median,
                least_seconds,
                largest_seconds,
                times_exact: exact.zip(median).map(|(exact, median)| exact / median),
                errors,
            });
        }
        let (source, tiles) = (LayoutSource::of(layout), layout.tiles.len());
        Ok(FilmBench { source, tiles, points: points.len(), pairs, rounds, cases: found })
    }
}

/// Median, least and largest time of at least one round.
fn median_and_ends(mut seconds: Vec<f64>) -> [f64; 3] {
    seconds.sort_by(f64::total_cmp);
    let (middle, last) = (seconds.len() / 2, seconds.len() - 1);
    let is_odd = seconds.len() % 2 == 1;
    let median = if is_odd { seconds[middle] } else { 0.5 * (seconds[middle - 1] + seconds[middle]) };
    [median, seconds[0], seconds[last]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_is_the_middle_of_sorted_values() {
        assert_eq!(median_and_ends(vec![3.0, 1.0, 2.0]), [2.0, 1.0, 3.0]);
        assert_eq!(median_and_ends(vec![4.0, 1.0, 2.0, 100.0]), [3.0, 1.0, 100.0]);
    }
}

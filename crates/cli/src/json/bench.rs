//! `bench`: pairs per second for each accuracy.

use magsplice::layout::Layout;
use magsplice::magnet::Accuracy;
use serde::Serialize;

use crate::benchmark::Benchmark;

/// The result of `bench`.
#[derive(Serialize)]
pub(crate) struct BenchJson<'a> {
    layout: &'a str,
    sha256: &'a str,
    version: &'static str,
    tiles: usize,
    points: usize,
    /// Number of tiles times number of points.
    pairs: f64,
    rounds: usize,
    cases: Vec<BenchCaseJson>,
}

/// The times for one accuracy and number of threads; null where the tolerance cannot be kept.
#[derive(Serialize)]
struct BenchCaseJson {
    accuracy: Accuracy,
    threads: usize,
    pairs_per_second: Option<f64>,
    /// The median of the rounds.
    seconds: Option<f64>,
    /// The fastest round.
    least_seconds: Option<f64>,
    /// The slowest round.
    largest_seconds: Option<f64>,
    /// Time of the exact field on as many threads, divided by this time.
    times_exact: Option<f64>,
}

impl<'a> BenchJson<'a> {
    pub(crate) fn new(layout: &'a Layout, measured: &Benchmark) -> BenchJson<'a> {
        let cases = measured.cases.iter().map(|case| BenchCaseJson {
            accuracy: case.accuracy,
            threads: case.threads,
            pairs_per_second: measured.pairs_per_second(case),
            seconds: case.seconds.as_ref().ok().map(|times| times.median),
            least_seconds: case.seconds.as_ref().ok().map(|times| times.least),
            largest_seconds: case.seconds.as_ref().ok().map(|times| times.largest),
            times_exact: measured.times_exact(case),
        });
        BenchJson {
            layout: &layout.name,
            sha256: &layout.sha256,
            version: env!("CARGO_PKG_VERSION"),
            tiles: layout.tiles.len(),
            points: measured.points,
            pairs: measured.pairs,
            rounds: measured.rounds,
            cases: cases.collect(),
        }
    }
}

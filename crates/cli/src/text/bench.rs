//! `bench`: pairs per second for each accuracy.

use std::fmt::Write;

use magsplice::layout::Layout;

use super::header;
use super::number::counted;
use crate::benchmark::{BenchCase, Benchmark};

/// The result of a measurement; `points_of` says where the points are from.
pub(crate) fn benchmark(layout: &Layout, measured: &Benchmark, points_of: &str) -> String {
    let mut text = header::layout(layout);
    let Benchmark { points, pairs, rounds, cases } = measured;
    let _ = writeln!(text, "{points} {points_of}; pairs of a tile and a point: {pairs}");
    let _ = writeln!(text, "medians of {}\n", counted(*rounds, "round", "rounds"));
    let _ = writeln!(
        text,
        "{:<22}{:>8}{:>18}{:>16}{:>14}",
        "accuracy", "threads", "pairs per second", "time, ms", "times exact"
    );
    for case in cases {
        let _ = writeln!(text, "{}", line(measured, case));
    }
    text
}

fn line(measured: &Benchmark, case: &BenchCase) -> String {
    let label = format!("{:<22}{:>8}", case.accuracy.to_string(), case.threads);
    match (&case.seconds, measured.pairs_per_second(case), measured.times_exact(case)) {
        (Ok(seconds), Some(pairs), Some(times)) => {
            format!("{label}{pairs:>18.3e}{:>16.4}{times:>14.2}", 1e3 * seconds)
        }
        _ => format!("{label}  the tolerance cannot be kept at some points"),
    }
}

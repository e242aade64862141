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
    let _ = writeln!(
        text,
        "medians of {}, with the fastest and the slowest\ntolerances are fractions of |B|\n",
        counted(*rounds, "round", "rounds")
    );
    let _ = writeln!(
        text,
        "{:<12}{:>8}{:>18}{:>10}{:>20}{:>12}",
        "accuracy", "threads", "pairs per second", "time, ms", "least .. largest", "times exact"
    );
    for case in cases {
        let _ = writeln!(text, "{}", line(measured, case));
    }
    text
}

fn line(measured: &Benchmark, case: &BenchCase) -> String {
    // The header says what tolerances are fractions of.
    let accuracy = case.accuracy.to_string().replace(" of |B|", "");
    let label = format!("{accuracy:<12}{:>8}", case.threads);
    match (&case.seconds, measured.pairs_per_second(case), measured.times_exact(case)) {
        (Ok(times), Some(pairs), Some(times_exact)) => {
            let [median, least, largest] = [times.median, times.least, times.largest].map(milliseconds);
            let spread = format!("{least} .. {largest}");
            format!("{label}{pairs:>18.3e}{median:>10}{spread:>20}{times_exact:>12.2}")
        }
        _ => format!("{label}  the tolerance cannot be kept at some points"),
    }
}

/// A time with four significant digits, or with all digits before the point.
fn milliseconds(seconds: f64) -> String {
    let ms = 1e3 * seconds;
    let digits_before = if ms > 0.0 { ms.log10().floor() as i32 + 1 } else { 0 };
    format!("{ms:.*}", (4 - digits_before).clamp(0, 6) as usize)
}

#[cfg(test)]
mod tests {
    use super::milliseconds;

    #[test]
    fn times_have_four_digits() {
        for (seconds, text) in
            [(1.234_567, "1235"), (12.345_67, "12346"), (0.012_345_6, "12.35"), (1.234e-6, "0.001234")]
        {
            assert_eq!(milliseconds(seconds), text);
        }
        assert_eq!(milliseconds(0.0), "0.0000");
    }
}

//! `magsplice bench`: measures how fast the field is computed.

use std::fmt::Write;
use std::path::PathBuf;
use std::time::Duration;

use magsplice::FilmError;
use magsplice::layout::Layout;
use magsplice::magnet::Accuracy;
use magsplice::results::{BenchCase, FilmBench};

use crate::args::formats::TextOrJson;
use crate::args::points::PointsArgs;
use crate::failure::Failure;
use crate::inputs::points;
use crate::remarks;
use crate::session::Session;
use crate::text::header;
use crate::text::number::counted;
use crate::text::units::in_ms;

/// Measure how fast the field of a layout is computed on this machine.
///
/// Evaluates B at all points, exactly and to tolerances of 1e-3, 1e-6 and 1e-9 of |B|, on one
/// thread and on all. Speeds are in pairs per second; a pair is one tile at one point. Each round
/// evaluates every case once, so that other work on the machine slows all cases alike; the result
/// is the median of the rounds, with the fastest and the slowest round.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice bench layouts/published-film.toml")]
pub(crate) struct BenchArgs {
    /// Layout file
    layout: PathBuf,
    #[command(flatten)]
    points: PointsArgs,
    /// Time to spend, in seconds; at least three rounds are measured however long they take
    #[arg(long, value_name = "SECONDS", value_parser = seconds, default_value = "5")]
    seconds: f64,
    /// Format of the result
    #[arg(long, value_enum, default_value = "text")]
    format: TextOrJson,
}

/// Longest time that can be asked for, a day.
const MAX_SECONDS: f64 = 86_400.0;

fn seconds(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|seconds: &f64| *seconds > 0.0 && *seconds <= MAX_SECONDS);
    number.ok_or_else(|| format!("must be a number greater than 0, at most {MAX_SECONDS}"))
}

pub(crate) fn run(args: &BenchArgs, quiet: bool) -> Result<(), Failure> {
    let subjects = if args.points.path().is_some() { remarks::OF_TILES } else { remarks::OF_FIELDS };
    let session = Session::open_with_points(&args.layout, args.points.path(), subjects, quiet)?;
    let (points, points_of) = points::given(&session, &args.points)?;
    let measured = session.film()?.bench(&points, Duration::from_secs_f64(args.seconds));
    let measured = measured.map_err(|error| Failure::Refused(format!("cannot start threads: {error}")))?;
    session.progress.end();
    // Points without any field have none to a tolerance either.
    for case in measured.cases.iter().filter(|case| case.accuracy == Accuracy::Exact) {
        if let Some(errors) = &case.errors {
            return Err(session.failed(FilmError::Points(errors.clone())));
        }
    }
    session.print(&args.format.shown(&measured, || text(&session.layout, &measured, &points_of)))
}

/// The result of a measurement; `points_of` says where the points are from.
fn text(layout: &Layout, measured: &FilmBench, points_of: &str) -> String {
    let mut text = header::layout(layout);
    let FilmBench { points, pairs, rounds, cases, .. } = measured;
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
        let _ = writeln!(text, "{}", line(case));
    }
    text
}

fn line(case: &BenchCase) -> String {
    // The header says what tolerances are fractions of.
    let accuracy = case.accuracy.to_string().replace(" of |B|", "");
    let label = format!("{accuracy:<12}{:>8}", case.threads);
    let BenchCase { pairs_per_second, seconds, least_seconds, largest_seconds, times_exact, .. } = case;
    let [Some(seconds), Some(least), Some(largest)] = [*seconds, *least_seconds, *largest_seconds] else {
        return format!("{label}  the tolerance cannot be kept at some points");
    };
    let spread = format!("{} .. {}", milliseconds(least), milliseconds(largest));
    let [pairs, times_exact] = [*pairs_per_second, *times_exact].map(Option::unwrap_or_default);
    format!("{label}{pairs:>18.3e}{:>10}{spread:>20}{times_exact:>12.2}", milliseconds(seconds))
}

/// A time with four significant digits, or with all digits before the point.
fn milliseconds(seconds: f64) -> String {
    let ms = in_ms(seconds);
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

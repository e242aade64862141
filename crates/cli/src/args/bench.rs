//! Arguments of `bench`.

use std::path::PathBuf;

use super::formats::TextOrJson;
use super::points::PointsArgs;

/// Measure how fast the field of a layout is computed on this machine.
///
/// A pair is one tile at one point. Evaluates B of all points exactly and to tolerances of 1e-3,
/// 1e-6 and 1e-9 of |B|, on one thread and on all. Each round evaluates every case once, so that
/// other work on the machine slows all cases alike; the result is the median of the rounds, with
/// the fastest and the slowest round.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice bench layouts/published-film.toml")]
pub(crate) struct BenchArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    #[command(flatten)]
    pub(crate) points: PointsArgs,
    /// Time to spend, in seconds; at least three rounds are measured however long they take
    #[arg(long, value_name = "S", value_parser = seconds, default_value = "5")]
    pub(crate) seconds: f64,
    /// Format of the result
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) format: TextOrJson,
}

/// Longest time that can be asked for, a day.
const MAX_SECONDS: f64 = 86_400.0;

fn seconds(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|seconds: &f64| *seconds > 0.0 && *seconds <= MAX_SECONDS);
    number.ok_or_else(|| format!("must be a number greater than 0, at most {MAX_SECONDS}"))
}

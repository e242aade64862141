//! Arguments of `tolerance`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

use super::formats::{FileFormat, ResultArgs};
use super::preset::PresetArgs;
use super::sorting::SortingArgs;

/// Largest number of samples.
pub(crate) const MAX_SAMPLES: u64 = *magsplice::layout::SAMPLE_COUNTS.end();

/// Evaluate the films that are made from a layout: samples with the errors of its [tolerance].
///
/// Each sample is a film whose tiles are misplaced, turned, cut to wrong sizes, and of wrong
/// strength and direction, in the surroundings and under the sensor of [tolerance]. Its exact field
/// gives the uniformity RMSE, the displacement RMSE and the amplitude. The result has their mean
/// and percentiles with intervals of 95 % confidence, and the share of the films that keep the
/// bounds of [expect] and [expect.made].
///
/// Sample i depends on the seed and on i alone, so that machines can share the work: see --first.
/// Ctrl-C ends the run with the result so far.
///
/// With --sorted the tiles of each sample are cut, measured and placed as `magsplice assign` does,
/// before they are laid with the errors of position and rotation: what measuring the tiles is
/// worth. Errors of groups stay those of the places.
#[derive(Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
#[command(after_help = "Example:\n  magsplice tolerance layouts/robust-in-plane.toml --samples 10000\n  \
    magsplice tolerance layouts/published-film.toml --preset workshop\n  \
    magsplice tolerance layouts/designed-stock.toml --preset jig --sorted --spares 14 --strength-error 0.5% \
    --direction-error 0.3deg --samples 200\n  \
    magsplice tolerance film.toml --samples 100000 --first 25000 --count 25000 --save part-2.csv\n  \
    magsplice tolerance merge film.toml part-*.csv --save samples.parquet")]
pub(crate) struct ToleranceArgs {
    #[command(subcommand)]
    pub(crate) merge: Option<ToleranceVerb>,
    /// Layout file
    #[arg(required = true)]
    pub(crate) layout: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) preset: PresetArgs,
    /// Number of samples [default: that of [tolerance], else 1000]
    #[arg(long, value_name = "N", value_parser = samples)]
    pub(crate) samples: Option<u64>,
    /// Seed of the random numbers [default: that of [tolerance], else 1]
    #[arg(long, value_name = "S")]
    pub(crate) seed: Option<u64>,
    /// Number of the first sample, to compute a part of the samples
    #[arg(long, value_name = "K", default_value = "0", value_parser = number)]
    pub(crate) first: u64,
    /// Number of samples of the part [default: all from the first on]
    #[arg(long, value_name = "M", value_parser = samples)]
    pub(crate) count: Option<u64>,
    /// Continue a run that was interrupted or killed, from its file FILE.partial beside --save
    #[arg(long, requires = "save")]
    pub(crate) resume: bool,
    #[command(flatten)]
    pub(crate) result: ToleranceResultArgs,
    #[command(flatten)]
    pub(crate) sorting: SortingArgs,
}

/// Where the result of samples goes.
#[derive(Args)]
pub(crate) struct ToleranceResultArgs {
    /// File for the figures of every sample: .csv, .npz or .parquet. Parts are .csv
    #[arg(long, value_name = "FILE")]
    pub(crate) save: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) text: ResultArgs,
}

#[derive(Subcommand)]
pub(crate) enum ToleranceVerb {
    Merge(MergeArgs),
}

/// Join parts of the samples of a layout. The result is that of one run, to the last bit.
#[derive(Args)]
pub(crate) struct MergeArgs {
    /// Layout file that the parts were computed from
    pub(crate) layout: PathBuf,
    /// Files that `tolerance --save` wrote, in any order
    #[arg(required = true, value_name = "PART")]
    pub(crate) parts: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) preset: PresetArgs,
    #[command(flatten)]
    pub(crate) result: ToleranceResultArgs,
    #[command(flatten)]
    pub(crate) sorting: SortingArgs,
}

/// Formats of the figures of samples.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum SampleFormat {
    /// Text with one line per sample, after a line that tells what they are samples of
    Csv,
    /// NumPy: one array per figure
    Npz,
    /// Parquet, if the program was built with the feature `parquet`
    Parquet,
}

impl FileFormat for SampleFormat {
    const OPTION: &'static str = "--save";

    fn endings(self) -> &'static [&'static str] {
        match self {
            SampleFormat::Csv => &["csv"],
            SampleFormat::Npz => &["npz"],
            SampleFormat::Parquet => &["parquet"],
        }
    }

    fn is_binary(self) -> bool {
        self != SampleFormat::Csv
    }

    fn is_known_by_ending(self) -> bool {
        true
    }
}

fn samples(text: &str) -> Result<u64, String> {
    let samples = text.parse().ok().filter(|n| (1..=MAX_SAMPLES).contains(n));
    samples.ok_or_else(|| format!("must be a whole number from 1 to {MAX_SAMPLES}"))
}

fn number(text: &str) -> Result<u64, String> {
    let number = text.parse().ok().filter(|n| *n < MAX_SAMPLES);
    number.ok_or_else(|| format!("must be a whole number below {MAX_SAMPLES}: samples are counted from 0"))
}

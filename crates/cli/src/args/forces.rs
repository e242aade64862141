//! Arguments of `forces`.

use std::path::PathBuf;

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};

use super::formats::FileFormat;

/// Tell with what force and torque the tiles of a film act on each other.
///
/// Each tile has the force by all others, and the torque about its own centre. Tiles with parallel
/// edges have them in closed form, exact to round-off, also where they touch. The magnetization is
/// rigid: a tile is not magnetized by the field of the others.
///
/// With --order, tiles are laid one after another, each at its place, where it is glued. The
/// holding of a step is the magnitude of the force on the tile that is being laid, by those that
/// are already there. The holding of an order is the largest of its steps. --order least searches
/// the order with the least holding, and prints a bound that no order is below.
#[derive(Args)]
#[command(after_help = "Example:\n  magsplice forces layouts/published-film.toml\n  \
    magsplice forces film.toml --order least --figure order.svg --format csv -o order.csv\n  \
    magsplice forces film.toml --order order.csv")]
pub(crate) struct ForcesArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    /// Order of laying: given (that of the layout file), least (searched), or a CSV file whose
    /// column tile has the names of the tiles
    #[arg(long, value_name = "ORDER")]
    pub(crate) order: Option<String>,
    /// Seed of the random numbers of --order least
    #[arg(long, value_name = "S", default_value = "1", requires = "order")]
    pub(crate) seed: u64,
    /// Largest relative error of the force of two tiles that are turned against each other
    #[arg(long, value_name = "ERROR", default_value = "1e-9", value_parser = relative_error)]
    pub(crate) turned_error: f64,
    /// File for a figure of the tiles with their forces: .svg or .png
    #[cfg(feature = "report")]
    #[arg(long, value_name = "FILE")]
    pub(crate) figure: Option<PathBuf>,
    /// Format of the result [default: by the file's ending, else text]
    #[arg(long, value_enum)]
    pub(crate) format: Option<ForcesFormat>,
    /// File to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// Smallest relative error: below it, the round-off of the field decides.
const LEAST_ERROR: f64 = 1e-13;

fn relative_error(text: &str) -> Result<f64, String> {
    let error = text.parse().ok().filter(|error| (LEAST_ERROR..=0.1).contains(error));
    error.ok_or_else(|| format!("must be a number from {LEAST_ERROR:e} to 0.1"))
}

/// Formats of `forces`.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum ForcesFormat {
    Text,
    Json,
    Csv,
}

impl ValueEnum for ForcesFormat {
    fn value_variants<'a>() -> &'a [ForcesFormat] {
        &[ForcesFormat::Text, ForcesFormat::Json, ForcesFormat::Csv]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(match self {
            ForcesFormat::Text => PossibleValue::new("text").help("Printed tables"),
            ForcesFormat::Json => PossibleValue::new("json").help("Tiles, sums, and steps of the order"),
            ForcesFormat::Csv => PossibleValue::new("csv").help("One line per tile, in the order of laying"),
        })
    }
}

impl FileFormat for ForcesFormat {
    const OPTION: &'static str = "--format";

    fn endings(self) -> &'static [&'static str] {
        match self {
            ForcesFormat::Text => &["txt"],
            ForcesFormat::Json => &["json"],
            ForcesFormat::Csv => &["csv"],
        }
    }

    fn is_binary(self) -> bool {
        false
    }

    fn is_known_by_ending(self) -> bool {
        false
    }
}

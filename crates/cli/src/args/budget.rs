//! Arguments of `budget`.

use std::path::PathBuf;

use clap::Args;

use super::formats::ResultArgs;
use super::preset::PresetArgs;

/// Tell where the displacement error of the films that are made comes from.
///
/// Divides the expected mean square of the displacement error, along x, y and z, into the splicing
/// pattern (the same pattern without end, against the ideal film), the end of the film, and each
/// cause of [tolerance]: of the tiles, of the surroundings, and of the sensor. The division is to
/// first order, by exact derivatives. Exact samples check it; where they disagree by more than 5 %,
/// the program says so and divides by samples of each cause alone.
#[derive(Args)]
#[command(after_help = "Example:\n  magsplice budget layouts/robust-in-plane.toml\n  \
    magsplice budget layouts/published-film.toml --preset workshop --figure budget.png")]
pub(crate) struct BudgetArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    #[command(flatten)]
    pub(crate) preset: PresetArgs,
    /// Number of samples that check the division, or divide
    #[arg(long, value_name = "N", default_value = "200", value_parser = clap::value_parser!(u64).range(20..=1_000_000))]
    pub(crate) samples: u64,
    /// Seed of the random numbers [default: that of [tolerance], else 1]
    #[arg(long, value_name = "S")]
    pub(crate) seed: Option<u64>,
    /// File for a bar chart of the budget: .svg or .png
    #[cfg(feature = "report")]
    #[arg(long, value_name = "FILE")]
    pub(crate) figure: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) result: ResultArgs,
}

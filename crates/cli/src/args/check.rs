//! Arguments of `check`.

use std::path::PathBuf;

use super::formats::CheckFormat;

/// Validate layouts, and check their films against what their [expect] tables state.
///
/// Prints one line per expectation: the value found, its bound and the margin. Exit status: 0 every
/// expectation is met; 1 an expectation is not met, or a layout has a finding, which is allowed but
/// rarely intended; 2 a layout cannot be used, or an expectation cannot be evaluated.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  magsplice check layouts/*.toml\n  magsplice check layouts --format junit > checks.xml"
)]
pub(crate) struct CheckArgs {
    /// Layout files, and folders with all layouts (*.toml) below them
    #[arg(required = true)]
    pub(crate) layouts: Vec<PathBuf>,
    /// Format of the result
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) format: CheckFormat,
    /// First rewrite the field baselines that the layouts name, each complete or not at all
    #[arg(long)]
    pub(crate) update: bool,
}

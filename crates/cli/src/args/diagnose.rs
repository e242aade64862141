//! Arguments of `diagnose`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use magsplice::scan::FreeParameters;
use magsplice::sensor::Noise;

use super::preset::PresetArgs;
use super::sensor::{FitArg, noise};

/// Tell which tiles of a film that was made are weak, turned or displaced, from a scan of its
/// field.
///
/// The scan is of the field near the film, for example in steps of 1 mm, 1 mm below it. Each tile
/// may be weaker or stronger, turned, magnetized in another direction, or displaced. An error is
/// named if neither the noise nor the ordinary errors of tiles explain it. Ordinary errors are
/// those of [tolerance] or of --preset. Without either, or with --as-ordered, tiles that are not
/// named count as ordered. The result has each error with its standard deviation, errors that would
/// explain the scan nearly as well, and what the scan cannot tell.
///
/// With -o the film that was found is written as a layout, which `tolerance`, `decouple` and `read`
/// take.
#[derive(Args)]
#[command(after_help = "Example:\n  magsplice diagnose film.toml --scan scan.csv --noise 10uT\n  \
    magsplice diagnose film.toml --scan scan.csv --fit --preset workshop -o found.toml --figure wrong.svg")]
pub(crate) struct DiagnoseArgs {
    /// Layout file of the film as ordered
    pub(crate) layout: PathBuf,
    /// CSV file with columns x_mm, y_mm, z_mm and bx_mt, by_mt, bz_mt, or in other units, such as
    /// bx (uT); - is standard input
    #[arg(long, value_name = "FILE")]
    pub(crate) scan: PathBuf,
    /// Standard deviation of a reading, such as 10uT, or of its x, y and z: 5uT,5uT,8uT [default:
    /// that of [sensor] in the layout]
    #[arg(long, value_name = "NOISE", value_parser = noise)]
    pub(crate) noise: Option<Noise>,
    #[command(flatten)]
    pub(crate) preset: PresetArgs,
    /// Tiles that are not named count as exactly as ordered, whatever [tolerance] states
    ///
    /// Smaller errors are then named. Ordinary errors of several tiles are all named, too.
    #[arg(long, conflicts_with = "preset")]
    pub(crate) as_ordered: bool,
    /// Fit what is not known of the scan beside the errors of tiles, such as --fit=offset,start;
    /// --fit alone fits everything
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        value_name = "WHAT",
        num_args = 0..,
        require_equals = true,
        default_missing_value = "strength,offset,rotation,start"
    )]
    pub(crate) fit: Vec<FitArg>,
    /// Probability that a tile of a film without wrong tiles is named
    #[arg(long, value_name = "P", default_value = "0.01", value_parser = probability)]
    pub(crate) false_alarm: f64,
    /// Layout file to write, with the tiles that were found
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// File for a figure of the wrong tiles and of what the scan cannot tell: .svg or .png
    #[cfg(feature = "report")]
    #[arg(long, value_name = "FILE")]
    pub(crate) figure: Option<PathBuf>,
    /// Format of the result
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) format: DiagnoseFormat,
}

/// Formats of `diagnose`.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum DiagnoseFormat {
    Text,
    Json,
    /// One line for each component of each error
    Csv,
}

impl DiagnoseArgs {
    pub(crate) fn free(&self) -> FreeParameters {
        let is_free = |what: FitArg| self.fit.contains(&what);
        FreeParameters {
            strength: is_free(FitArg::Strength),
            offset: is_free(FitArg::Offset),
            rotation: is_free(FitArg::Rotation),
            start: is_free(FitArg::Start),
        }
    }
}

fn probability(text: &str) -> Result<f64, String> {
    let value: Option<f64> = text.parse().ok().filter(|value| *value > 0.0 && *value < 1.0);
    value.ok_or_else(|| "must be a number greater than 0 and less than 1, such as 0.01".to_owned())
}

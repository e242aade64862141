//! Arguments of `assign`, and errors of measurements of tiles.

use std::path::PathBuf;

use clap::Args;
use magsplice::making::MeasurementErrors;

use super::formats::TextOrJson;
use super::numbers::{angle_rad, fraction, length_mm};

/// Choose which measured tile goes to which place of a film, and which way round.
///
/// Each row of the table is a tile that was cut: its name in the column tile; its part, by its
/// number in `magsplice tiles` or the name of a tile or kind of the layout, in the column part; and
/// its polarization (jx_t, jy_t, jz_t), magnetization (mx_a_per_m, ...), moment (moment_x_a_m2,
/// ...) or strength (strength_t, with or without direction_deg and tilt_deg). Axes are those of the
/// part: x along its first side, y along its second, z up. Sides that were measured are in
/// size_x_mm, size_y_mm, size_z_mm. Tiles beyond the places are spares.
///
/// The tiles are placed so that the displacement error of the film is least: local searches from
/// many starts, by the exact derivatives and then the exact field. The result is a layout with the
/// measured tiles, and a plan: for each place the tile, the side that is up, and where its mark
/// points. The mark is drawn on a tile along +x of its part when it is measured.
#[derive(Args)]
#[command(
    after_help = "Example:\n  magsplice assign layouts/designed-stock.toml --measured tiles.csv -o assigned.toml \
    --plan plan.csv --figure plan.png\n  \
    magsplice assign film.toml --measured tiles.csv --placed plan.csv -o assigned.toml --shim rim-1"
)]
pub(crate) struct AssignArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    /// CSV file with the measured tiles
    #[arg(long, value_name = "FILE")]
    pub(crate) measured: PathBuf,
    /// CSV file with the tiles that lie already, with the columns of --plan: they stay, and the
    /// others make up for them. Positions are as measured; rows whose cell in the column laid is no
    /// are left out
    #[arg(long, value_name = "FILE")]
    pub(crate) placed: Option<PathBuf>,
    /// Place of a shim tile, whose strength is chosen; may be given again
    #[arg(long, value_name = "PLACE")]
    pub(crate) shim: Vec<String>,
    /// Turn no tile over: the side that was up when it was measured stays up
    #[arg(long)]
    pub(crate) keep_side_up: bool,
    /// Number of random starts
    #[arg(long, value_name = "N", default_value = "16", value_parser = starts)]
    pub(crate) starts: usize,
    /// Seed of the random numbers
    #[arg(long, value_name = "S", default_value = "1")]
    pub(crate) seed: u64,
    /// Layout file to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// CSV file for the plan
    #[arg(long, value_name = "FILE")]
    pub(crate) plan: Option<PathBuf>,
    /// Draw the plan into this file, .svg or .png
    #[cfg(feature = "report")]
    #[arg(long, value_name = "FILE")]
    pub(crate) figure: Option<PathBuf>,
    /// Write the plan and the bill of materials as a page to print (HTML)
    #[cfg(feature = "report")]
    #[arg(long, value_name = "FILE")]
    pub(crate) page: Option<PathBuf>,
    /// Format of the summary
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) format: TextOrJson,
    #[command(flatten)]
    pub(crate) errors: MeasurementArgs,
}

/// Errors of the measurements of tiles.
#[derive(Args)]
#[command(next_help_heading = "Standard deviations of the errors of the measurements of tiles")]
pub(crate) struct MeasurementArgs {
    /// Error of the strength, such as 0.5%
    #[arg(long, value_name = "FRACTION", value_parser = strength)]
    pub(crate) strength_error: Option<f64>,
    /// Error of the direction of J about each axis normal to it, such as 0.3deg
    #[arg(long, value_name = "ANGLE", value_parser = direction_rad)]
    pub(crate) direction_error: Option<f64>,
    /// Error of each side, such as 0.01mm [default: sides are not measured]
    #[arg(long, value_name = "LENGTH", value_parser = size_mm)]
    pub(crate) size_error: Option<f64>,
}

impl MeasurementArgs {
    /// The errors, if any is given.
    pub(crate) fn errors(&self) -> Option<MeasurementErrors> {
        let MeasurementArgs { strength_error, direction_error, size_error } = *self;
        [strength_error, direction_error, size_error].iter().any(Option::is_some).then(|| MeasurementErrors {
            strength: strength_error.unwrap_or(0.0),
            direction_rad: direction_error.unwrap_or(0.0),
            size_mm: size_error,
        })
    }
}

/// Largest number of starts.
const MAX_STARTS: usize = 10_000;

fn starts(text: &str) -> Result<usize, String> {
    let starts = text.parse().ok().filter(|n| (1..=MAX_STARTS).contains(n));
    starts.ok_or_else(|| format!("must be a whole number from 1 to {MAX_STARTS}"))
}

/// Errors beyond which nothing was measured.
const MOST_STRENGTH: f64 = 0.5;
const MOST_DIRECTION_DEG: f64 = 45.0;
const MOST_SIZE_MM: f64 = 10.0;

fn strength(text: &str) -> Result<f64, String> {
    within(fraction(text)?, MOST_STRENGTH, "0 to 50%")
}

fn direction_rad(text: &str) -> Result<f64, String> {
    within(angle_rad(text)?, MOST_DIRECTION_DEG.to_radians(), "0 to 45 deg")
}

fn size_mm(text: &str) -> Result<f64, String> {
    within(length_mm(text)?, MOST_SIZE_MM, "0 to 10 mm")
}

fn within(value: f64, most: f64, range: &str) -> Result<f64, String> {
    if (0.0..=most).contains(&value) { Ok(value) } else { Err(format!("must be from {range}")) }
}

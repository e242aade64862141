//! Command-line arguments.

use std::path::PathBuf;

use clap::{Parser, Subcommand, ValueEnum};
use magsplice::field::{Accuracy, Tolerance};

/// Exact simulation of spliced magnet films.
///
/// Reads a layout file (TOML; lengths in mm, polarization in T) and computes the magnetic field of its tiles, its distance from
/// the ideal sinusoidal film, and how well it decouples.
#[derive(Parser)]
#[command(name = "magsplice", version, max_term_width = 100)]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

#[derive(Subcommand)]
pub(crate) enum Verb {
    Field(FieldArgs),
    /// Compare the field with the ideal film (Eq. 2) over the working volume.
    #[command(after_help = "Example:\n  magsplice compare layouts/published-film.toml")]
    Compare(LayoutArgs),
    /// Evaluate the film: its field, its distance from the ideal film, and its decoupling error.
    #[command(after_help = "Example:\n  magsplice decouple layouts/published-film.toml --format json")]
    Decouple(LayoutArgs),
    #[cfg(feature = "report")]
    Report(ReportArgs),
    Check(CheckArgs),
}

/// Compute the field at points, as CSV.
///
/// Points are read from the columns x_mm, y_mm, z_mm of a CSV file (other columns are ignored), or are the grid of the layout's
/// working volume. They are written in the order given, with digits that read back to the same numbers.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice field layouts/published-film.toml --points points.csv -o field.csv")]
pub(crate) struct FieldArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    /// CSV file with columns x_mm, y_mm, z_mm, - for standard input [default: the grid of the working volume]
    #[arg(long, value_name = "CSV")]
    pub(crate) points: Option<PathBuf>,
    /// File to write, whole or not at all; - for standard output, the default
    #[arg(short, long, value_name = "CSV")]
    pub(crate) output: Option<PathBuf>,
    /// Which quantity
    #[arg(long, value_enum, default_value = "b")]
    pub(crate) quantity: QuantityArg,
    #[command(flatten)]
    pub(crate) accuracy: AccuracyArg,
}

#[derive(clap::Args)]
pub(crate) struct AccuracyArg {
    /// Largest error of B (of mu0 H for H) that is accepted: a fraction of |B| such as 1e-6, or with a unit, such as 10nT (T, mT, uT, nT)
    ///
    /// Without it the field is exact. With it the program takes the cheapest way that keeps the tolerance at every point, which pays for grids of many
    /// points, or names the points at which it cannot be kept. J and the gradient are always exact.
    #[arg(long, value_name = "TOLERANCE", value_parser = tolerance)]
    within: Option<Tolerance>,
}

impl AccuracyArg {
    pub(crate) fn get(&self) -> Accuracy {
        self.within.map_or(Accuracy::Exact, Accuracy::Within)
    }
}

/// Units of a tolerance that is not a fraction, in tesla; longer names first.
const UNITS_T: [(&str, f64); 4] = [("mT", 1e-3), ("uT", 1e-6), ("nT", 1e-9), ("T", 1.0)];

fn tolerance(text: &str) -> Result<Tolerance, String> {
    let unit = UNITS_T.iter().find_map(|(name, in_t)| Some((text.strip_suffix(name)?.trim_end(), in_t)));
    let number = unit.map_or(text, |(number, _)| number);
    let value: f64 = number.parse().map_err(|_| {
        "must be a number, a fraction of |B| such as 1e-6, or with one of the units T, mT, uT, nT, such as 10nT"
            .to_owned()
    })?;
    let tolerance = match unit {
        Some((_, in_t)) => Tolerance::absolute_t(value * in_t),
        None => Tolerance::relative(value),
    };
    tolerance.map_err(|error| error.to_string())
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum QuantityArg {
    /// Flux density B, in T
    B,
    /// Field strength H, in A/m
    H,
    /// Polarization J, in T
    J,
    /// Gradient of B, nine components in T/mm
    Gradient,
}

impl QuantityArg {
    /// Names of the columns, with unit.
    pub(crate) fn columns(self) -> &'static str {
        match self {
            QuantityArg::B => "bx_t,by_t,bz_t",
            QuantityArg::H => "hx_a_per_m,hy_a_per_m,hz_a_per_m",
            QuantityArg::J => "jx_t,jy_t,jz_t",
            QuantityArg::Gradient => {
                "dbx_dx_t_per_mm,dbx_dy_t_per_mm,dbx_dz_t_per_mm,dby_dx_t_per_mm,dby_dy_t_per_mm,dby_dz_t_per_mm,\
                 dbz_dx_t_per_mm,dbz_dy_t_per_mm,dbz_dz_t_per_mm"
            }
        }
    }
}

#[derive(clap::Args)]
pub(crate) struct LayoutArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    /// How to write the result
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) format: Format,
    #[command(flatten)]
    pub(crate) accuracy: AccuracyArg,
}

/// Draw the film and its field: figures as SVG and PNG, and one page with all of them.
///
/// The figures of Dai 2024 for any layout: the tiles from above, field vectors in three views, B beside the ideal film on planes, the decoupling
/// parameters through the working volume and along their axes. The page report.html needs no network and no other file: numbers, a view of the
/// tiles to turn, maps to point at. The folder appears whole or not at all; a report that is there is replaced.
#[cfg(feature = "report")]
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice report layouts/published-film.toml -o report")]
pub(crate) struct ReportArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    /// Folder to write: new, empty, or with a report that is replaced
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) accuracy: AccuracyArg,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum Format {
    Text,
    Json,
}

/// Read and validate layouts, and list their tiles.
///
/// Exit status: 0 all fine, 1 something that is allowed but rarely meant, 2 a layout that cannot be used.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice check layouts/*.toml")]
pub(crate) struct CheckArgs {
    /// Layout files
    #[arg(required = true)]
    pub(crate) layouts: Vec<PathBuf>,
}

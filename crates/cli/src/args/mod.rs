//! The command line.

/// `--within`: the accuracy of a field.
pub(crate) mod accuracy;
/// Parameters of a scan that can be fitted.
pub(crate) mod fit;
/// Output formats, their names and file endings.
pub(crate) mod formats;
/// `--unit`: units of columns.
pub(crate) mod given_units;
/// Errors of measurements of tiles.
pub(crate) mod measurement;
/// Numbers with units as a person types them.
pub(crate) mod numbers;
/// `--points` and `--unit`: points from a file.
pub(crate) mod points;
/// `--preset`: usual errors of tiles.
pub(crate) mod preset;
/// The noise of readings.
pub(crate) mod readings;
/// `--sorted`: tiles that are measured and sorted.
pub(crate) mod sorting;

use clap::Parser;
use numbers::whole;

use crate::verbs::Verb;

const FIRST_STEPS: &str = if cfg!(feature = "report") {
    "Example:\n  magsplice init film.toml\n  magsplice report film.toml -o report\n  magsplice decouple film.toml"
} else {
    "Example:\n  magsplice init film.toml\n  magsplice decouple film.toml"
};

/// Exact simulation of spliced magnet films.
///
/// Reads a layout file (TOML; lengths in mm, polarization in T). Computes the magnetic field of its
/// tiles, compares it with the field of the ideal sinusoidal film, and evaluates how well the film
/// decouples: how far each of R_x, R_y and S_z depends on one coordinate only.
#[derive(Parser)]
#[command(name = "magsplice", version, max_term_width = 100)]
#[command(after_help = FIRST_STEPS)]
pub(crate) struct Args {
    #[command(flatten)]
    pub(crate) common: CommonArgs,
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

/// Options of every verb.
#[derive(clap::Args)]
#[command(next_help_heading = "Options of every command")]
pub(crate) struct CommonArgs {
    /// Number of threads that compute [default: one per processor]; results do not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = |text: &str| whole(text, 1..=MAX_THREADS))]
    pub(crate) threads: Option<usize>,
    /// Print results and errors only: no progress and no remarks; check prints only what fails
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
}

/// Largest number of threads: above the number of processors of any machine the program is meant
/// for.
const MAX_THREADS: usize = 1024;

//! Command-line arguments.

use std::path::PathBuf;

use clap::{Parser, Subcommand, ValueEnum};
use magsplice::design::SpliceRequest;
use magsplice::field::{Accuracy, Tolerance};
use magsplice::layout::Goal;

use crate::formats::{ExportFormat, ReportFormat, TableFormat};

const FIRST_STEPS: &str = if cfg!(feature = "report") {
    "Example:\n  magsplice init film.toml\n  magsplice report film.toml -o report\n  magsplice decouple film.toml"
} else {
    "Example:\n  magsplice init film.toml\n  magsplice decouple film.toml"
};

/// Exact simulation of spliced magnet films.
///
/// Reads a layout file (TOML; lengths in mm, polarization in T) and computes the magnetic field of its tiles, its distance from
/// the ideal sinusoidal film, and how well it decouples.
#[derive(Parser)]
#[command(name = "magsplice", version, max_term_width = 100)]
#[command(after_help = FIRST_STEPS)]
pub(crate) struct Args {
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

/// What every verb takes.
#[derive(clap::Args)]
#[command(next_help_heading = "With every command")]
pub(crate) struct Common {
    /// How many threads compute [default: one per processor]; the results are the same
    #[arg(long, global = true, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<usize>,
    /// Only results and errors: no progress, no remarks, and of check only what fails
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
}

/// More threads than any machine this is meant for has processors.
const MAX_THREADS: usize = 1024;

fn threads(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|n| (1..=MAX_THREADS).contains(n));
    number.ok_or_else(|| format!("must be a whole number from 1 to {MAX_THREADS}"))
}

#[derive(Subcommand)]
pub(crate) enum Verb {
    Field(FieldArgs),
    /// Compare the field with the ideal film (Eq. 2) over the working volume.
    #[command(after_help = "Example:\n  magsplice compare layouts/published-film.toml")]
    Compare(LayoutArgs),
    Decouple(DecoupleArgs),
    Plan(PlanArgs),
    #[cfg(feature = "report")]
    Report(ReportArgs),
    Check(CheckArgs),
    Design(DesignArgs),
    Splice(SplicedArgs),
    Tiles(TilesArgs),
    Export(ExportArgs),
    Init(InitArgs),
    /// Print a JSON Schema of layout files, for editors.
    #[command(after_help = "Example:\n  magsplice schema > layout.schema.json")]
    Schema,
    Completions(CompletionsArgs),
}

/// Compute the field at points, as CSV or in a file of another tool.
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
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// How to write the result [default: as the ending of the file says, else csv]
    #[arg(long, value_enum)]
    pub(crate) format: Option<TableFormat>,
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
    #[arg(long, value_name = "TOLERANCE", value_parser = tolerance, allow_hyphen_values = true)]
    within: Option<Tolerance>,
}

impl AccuracyArg {
    pub(crate) fn get(&self) -> Accuracy {
        self.within.map_or(Accuracy::Exact, Accuracy::Within)
    }
}

/// Units of a tolerance that is not a fraction, how many make a tesla; longer names first.
const UNITS: [(&str, f64); 4] = [("mT", 1e3), ("uT", 1e6), ("nT", 1e9), ("T", 1.0)];

fn tolerance(text: &str) -> Result<Tolerance, String> {
    let unit = UNITS.iter().find_map(|(name, per_t)| Some((text.strip_suffix(name)?.trim_end(), per_t)));
    let number = unit.map_or(text, |(number, _)| number);
    let value: f64 = number.parse().map_err(|_| {
        "must be a number, a fraction of |B| such as 1e-6, or with one of the units T, mT, uT, nT, such as 10nT"
            .to_owned()
    })?;
    let tolerance = match unit {
        // Divided, so that 2.5 uT are 2.5e-6 T to the last digit.
        Some((_, per_t)) => Tolerance::absolute_t(value / per_t),
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
    /// Its name with unit, as a vector or tensor, and those of its columns.
    pub(crate) fn names(self) -> (&'static str, &'static [&'static str]) {
        match self {
            QuantityArg::B => ("b_t", &["bx_t", "by_t", "bz_t"]),
            QuantityArg::H => ("h_a_per_m", &["hx_a_per_m", "hy_a_per_m", "hz_a_per_m"]),
            QuantityArg::J => ("j_t", &["jx_t", "jy_t", "jz_t"]),
            QuantityArg::Gradient => (
                "gradient_b_t_per_mm",
                &[
                    "dbx_dx_t_per_mm",
                    "dbx_dy_t_per_mm",
                    "dbx_dz_t_per_mm",
                    "dby_dx_t_per_mm",
                    "dby_dy_t_per_mm",
                    "dby_dz_t_per_mm",
                    "dbz_dx_t_per_mm",
                    "dbz_dy_t_per_mm",
                    "dbz_dz_t_per_mm",
                ],
            ),
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

/// Evaluate the film: its field, its distance from the ideal film, and its decoupling error.
///
/// As text this is a report. As JSON it is the report with every point of the working volume; the other formats hold the points: B, R_x, R_y, S_z.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  magsplice decouple layouts/published-film.toml\n  magsplice decouple layouts/published-film.toml -o film.npz"
)]
pub(crate) struct DecoupleArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    /// File to write, whole or not at all; - for standard output, the default
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// How to write the result [default: as the ending of the file says, else text]
    #[arg(long, value_enum)]
    pub(crate) format: Option<ReportFormat>,
    #[command(flatten)]
    pub(crate) accuracy: AccuracyArg,
}

/// Tell which models a tolerance is kept with, and what each leaves out and costs.
///
/// For the points that `field` would take. Costs are multiply-adds counted, in units of one exact value of one tile at one point. Expansions are made to see whether
/// they hold, so a plan takes a part of the time of the evaluation. Points where the field turns out too weak for what was left out are
/// evaluated more exactly later on; the plan does not know them yet.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice plan layouts/film-80mm.toml --within 1e-6")]
pub(crate) struct PlanArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    /// CSV file with columns x_mm, y_mm, z_mm, - for standard input [default: the grid of the working volume]
    #[arg(long, value_name = "CSV")]
    pub(crate) points: Option<PathBuf>,
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

/// Validate layouts, and hold their films against what their [expect] tables state.
///
/// One line per expectation, with the value found, its bound and the margin. Exit status: 0 all fine, 1 an expectation that is not met or something that
/// is allowed but rarely meant, 2 a layout that cannot be used or an expectation that cannot be evaluated.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice check layouts/*.toml --format junit > checks.xml")]
pub(crate) struct CheckArgs {
    /// Layout files
    #[arg(required = true)]
    pub(crate) layouts: Vec<PathBuf>,
    /// How to write the result
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) format: CheckFormat,
    /// First rewrite the field baselines the layouts name, whole or not at all
    #[arg(long)]
    pub(crate) update: bool,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum CheckFormat {
    Text,
    Json,
    /// JUnit XML, for build systems
    Junit,
}

/// Search for a better film, as the table [design] of the layout asks.
///
/// The result is a complete layout: the tiles found, what it reached as what it must meet, and a line of history. Faces and angles are rounded to the resolution of
/// [design]. Ctrl-C ends the search with the best film so far. Exit status: 0 fine, 1 an amplitude or a number of parts that was not reached, 2 no film.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  magsplice design film.toml -o better.toml\n  magsplice design film.toml --front -o front"
)]
pub(crate) struct DesignArgs {
    /// Layout file with a table [design]
    pub(crate) layout: PathBuf,
    /// File to write, whole or not at all, - for standard output, the default; with --front a folder
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Instead of one film find the trade: films for several amplitudes, and films of fewer and fewer parts, as tables, figures and layouts
    #[arg(long)]
    pub(crate) front: bool,
    /// Least amplitudes of the front
    #[arg(long, value_name = "LIST", value_delimiter = ',', requires = "front", value_parser = fraction,
        default_value = "0.6,0.7,0.8,0.85,0.9,0.95,1.0,1.05")]
    pub(crate) amplitudes: Vec<f64>,
    /// How to say what was found
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) format: Format,
}

fn fraction(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|value: &f64| *value > 0.0 && value.is_finite());
    number.ok_or_else(|| "must be a number greater than 0".to_owned())
}

/// Find a film from nothing, for an ideal film of this wavelength.
///
/// Begins with the pattern of Dai 2024, Fig. 5: intervals of a third of the wavelength about the crests of the ideal polarization, of a sixth about its zeros; then
/// searches as design does, with sizes, positions and directions free. Lengths in mm.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice splice --wavelength 10 --film 20x20 --parts 3 -o film.toml")]
pub(crate) struct SplicedArgs {
    /// Wavelength of the ideal film, in mm
    #[arg(long, value_name = "MM")]
    wavelength: f64,
    /// Extent of the film along x and y, in mm, such as 20x20
    #[arg(long, value_name = "XxY", value_parser = extents)]
    film: [f64; 2],
    /// At most so many distinct parts [default: any number]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    parts: Option<u32>,
    /// Thickness of the film, in mm [default: a tenth of the wavelength]
    #[arg(long, value_name = "MM")]
    thickness: Option<f64>,
    /// Polarization of every tile, in T
    #[arg(long, value_name = "T", default_value_t = 0.12)]
    remanence: f64,
    /// Extent of the working volume along x and y, in mm [default: two fifths of the wavelength each]
    #[arg(long, value_name = "XxY", value_parser = extents)]
    range: Option<[f64; 2]>,
    /// Least and largest distance of the sensor below the film, in mm [default: 0.3 and 0.5 of the wavelength]
    #[arg(long, value_name = "A..B", value_parser = interval)]
    distance: Option<[f64; 2]>,
    /// Shortest side of a tile, in mm [default: 0.08 of the wavelength]
    #[arg(long, value_name = "MM")]
    smallest_cut: Option<f64>,
    /// Least distance of neighbouring tiles, in mm
    #[arg(long, value_name = "MM", default_value_t = 0.0)]
    gap: f64,
    /// Least amplitude of the field, of that of an ideal film as strong as the tiles
    #[arg(long, value_name = "FRACTION", value_parser = fraction, default_value_t = 0.65)]
    amplitude: f64,
    /// What is to become small
    #[arg(long, value_enum, default_value = "displacement")]
    goal: GoalArg,
    /// From how many points the search starts
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    starts: u32,
    /// Which random numbers vary them
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// File to write, whole or not at all; - for standard output, the default
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// How to say what was found
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) format: Format,
}

impl SplicedArgs {
    pub(crate) fn request(&self) -> SpliceRequest {
        let lambda = self.wavelength;
        SpliceRequest {
            wavelength_mm: lambda,
            film_mm: self.film,
            thickness_mm: self.thickness.unwrap_or(rounded(0.1 * lambda)),
            remanence_t: self.remanence,
            range_mm: self.range.unwrap_or([rounded(0.4 * lambda); 2]),
            distance_mm: self.distance.unwrap_or([rounded(0.3 * lambda), rounded(0.5 * lambda)]),
            smallest_cut_mm: self.smallest_cut.unwrap_or(rounded(0.08 * lambda)),
            gap_mm: self.gap,
            least_amplitude: self.amplitude,
            parts: self.parts.map(|parts| parts as usize),
            goal: match self.goal {
                GoalArg::Uniformity => Goal::Uniformity,
                GoalArg::Displacement => Goal::Displacement,
                GoalArg::Field => Goal::Field,
            },
            starts: self.starts as usize,
            seed: self.seed,
        }
    }
}

/// A default as a person would write it.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

#[derive(Clone, Copy, ValueEnum)]
enum GoalArg {
    /// The uniformity RMSE of R_x, R_y, S_z
    Uniformity,
    /// The RMSE of displacement against the true one
    Displacement,
    /// The RMSE of B against the ideal film times the amplitude
    Field,
}

fn extents(text: &str) -> Result<[f64; 2], String> {
    pair(text, "x").ok_or_else(|| "must be two numbers with an x between them, such as 20x20".to_owned())
}

fn interval(text: &str) -> Result<[f64; 2], String> {
    pair(text, "..").ok_or_else(|| "must be two numbers with .. between them, such as 3..5".to_owned())
}

fn pair(text: &str, between: &str) -> Option<[f64; 2]> {
    let (first, second) = text.split_once(between)?;
    Some([first.trim().parse().ok()?, second.trim().parse().ok()?])
}

/// List the tiles of a layout, and its bill of materials.
///
/// The bill counts pieces: tiles that differ only in where they are and how they are turned are the same.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice tiles layouts/published-film.toml")]
pub(crate) struct TilesArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    /// How to write the result; json is the plain form of the layout file, one entry per tile
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) format: Format,
}

/// Write the film for another program.
///
/// For magpylib this is a Python script that rebuilds the film and prints its field, for ParaView the faces of the tiles with their polarization.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice export layouts/published-film.toml --to magpylib -o film.py")]
pub(crate) struct ExportArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    /// For which program [default: as the ending of the file says]
    #[arg(long, value_enum, required_unless_present = "output")]
    pub(crate) to: Option<ExportFormat>,
    /// File to write, whole or not at all; - for standard output, the default
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// Write a commented layout to start from; never overwrites.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice init my-film.toml")]
pub(crate) struct InitArgs {
    /// File to write, - for standard output
    #[arg(default_value = "film.toml")]
    pub(crate) file: PathBuf,
}

/// Print a script that lets a shell complete arguments.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice completions bash > ~/.local/share/bash-completion/completions/magsplice")]
pub(crate) struct CompletionsArgs {
    /// Which shell
    pub(crate) shell: clap_complete::Shell,
}

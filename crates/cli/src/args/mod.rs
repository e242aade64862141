//! The command line.

/// `--within`: the accuracy of a field.
pub(crate) mod accuracy;
/// Arguments of `assign`, and errors of measurements of tiles.
pub(crate) mod assign;
/// Arguments of `budget`.
pub(crate) mod budget;
/// Arguments of the verbs that search for films: `design`, `splice`.
pub(crate) mod design;
/// Arguments of `diagnose`.
pub(crate) mod diagnose;
/// Arguments of `experiment`.
pub(crate) mod experiment;
/// Output formats, their names and file endings.
pub(crate) mod formats;
/// Arguments of `import`.
pub(crate) mod import;
/// Numbers with units as a person types them.
pub(crate) mod numbers;
/// `--points` and `--unit`: points from a file.
pub(crate) mod points;
/// `--preset`: usual errors of tiles.
pub(crate) mod preset;
/// Arguments of the verbs about sensors.
pub(crate) mod sensor;
/// `--sorted`: tiles that are measured and sorted.
pub(crate) mod sorting;
/// Arguments of `tolerance`.
pub(crate) mod tolerance;

use clap::{Parser, Subcommand};

use self::assign::AssignArgs;
use self::budget::BudgetArgs;
use self::design::{DesignArgs, SpliceArgs};
use self::diagnose::DiagnoseArgs;
use self::experiment::ExperimentArgs;
use self::import::ImportArgs;
use self::sensor::{CalibrateArgs, ReadArgs, ResolutionArgs, ScanArgs};
use self::tolerance::ToleranceArgs;
#[cfg(feature = "report")]
use crate::verbs::report;
use crate::verbs::{bench, check, compare, completions, decouple, export, field, forces, init, plan, tiles};

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
    #[arg(long, global = true, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<usize>,
    /// Print results and errors only: no progress and no remarks; check prints only what fails
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
}

/// Largest number of threads: above the number of processors of any machine the program is meant
/// for.
const MAX_THREADS: usize = 1024;

fn threads(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|n| (1..=MAX_THREADS).contains(n));
    number.ok_or_else(|| format!("must be a whole number from 1 to {MAX_THREADS}"))
}

#[derive(Subcommand)]
pub(crate) enum Verb {
    Field(field::FieldArgs),
    Compare(compare::CompareArgs),
    Decouple(decouple::DecoupleArgs),
    Plan(plan::PlanArgs),
    Bench(bench::BenchArgs),
    #[cfg(feature = "report")]
    Report(report::ReportArgs),
    Tolerance(ToleranceArgs),
    Budget(BudgetArgs),
    Forces(forces::ForcesArgs),
    Read(ReadArgs),
    Resolution(ResolutionArgs),
    Experiment(ExperimentArgs),
    Calibrate(CalibrateArgs),
    Scan(ScanArgs),
    Diagnose(DiagnoseArgs),
    Check(check::CheckArgs),
    Design(DesignArgs),
    Splice(SpliceArgs),
    Assign(AssignArgs),
    Tiles(tiles::TilesArgs),
    Export(export::ExportArgs),
    Import(ImportArgs),
    Init(init::InitArgs),
    /// Print the JSON Schema of layout files, for editors.
    #[command(after_help = "Example:\n  magsplice schema > layout.schema.json")]
    Schema,
    Completions(completions::CompletionsArgs),
}

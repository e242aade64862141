//! One file per verb. A verb reads its inputs, runs the library, and passes on the result.

/// Places measured tiles.
pub(crate) mod assign;
/// Measures how fast the field is computed.
pub(crate) mod bench;
/// Splits the displacement error of films as made into its causes.
pub(crate) mod budget;
/// Fits the stiffness of the elastic layer.
pub(crate) mod calibrate;
/// Validates layouts, and checks films against their expectations.
pub(crate) mod check;
/// Compares the field with the ideal film.
pub(crate) mod compare;
/// Prints the script with which a shell completes arguments.
pub(crate) mod completions;
/// Evaluates a film: field, comparison and decoupling errors.
pub(crate) mod decouple;
/// Searches for a better film.
pub(crate) mod design;
/// Finds the faulty tiles of a film as made.
pub(crate) mod diagnose;
/// Moves the film and computes the readings of its sensor.
pub(crate) mod experiment;
/// Writes the film for another program.
pub(crate) mod export;
/// Computes the field at points.
pub(crate) mod field;
/// Computes the forces of the tiles on each other.
pub(crate) mod forces;
/// Makes a layout from a table of blocks.
pub(crate) mod import;
/// Writes a commented layout to start from.
pub(crate) mod init;
/// Shows which methods a tolerance allows.
pub(crate) mod plan;
/// Finds displacements of the sensor from its readings.
pub(crate) mod read;
/// Draws figures and a page.
#[cfg(feature = "report")]
pub(crate) mod report;
/// Computes the displacement resolution of a sensor with noise.
pub(crate) mod resolution;
/// Compares a measured scan with the layout.
pub(crate) mod scan;
/// Prints the JSON Schema of layout files.
pub(crate) mod schema;
/// Designs a film from nothing.
pub(crate) mod splice;
/// Serves a live page of a layout.
#[cfg(feature = "studio")]
pub(crate) mod studio;
/// Lists the tiles of a layout and its bill of materials.
pub(crate) mod tiles;
/// Samples films as made.
pub(crate) mod tolerance;

use clap::{Command, Subcommand};

use crate::failure::Failure;

/// The commands by task, as the help lists them: the ones of every day first.
pub(crate) const GROUPS: [(&str, &[&[&str]]); 6] = [
    ("Layouts", &[&["init", "check", "import", "export", "schema"]]),
    ("Evaluate a film", &[&["decouple"], REPORT, STUDIO, &["compare", "field"]]),
    ("Design a film", &[&["splice", "design"]]),
    ("Make a film", &[&["tiles", "tolerance", "budget", "forces", "assign", "diagnose"]]),
    ("Use a sensor", &[&["read", "resolution", "experiment", "calibrate", "scan"]]),
    ("Speed and help", &[&["plan", "bench", "completions", "help"]]),
];

/// Figures, if the program has them.
#[cfg(feature = "report")]
const REPORT: &[&str] = &["report"];
#[cfg(not(feature = "report"))]
const REPORT: &[&str] = &[];
/// The live page, if the program has it.
#[cfg(feature = "studio")]
const STUDIO: &[&str] = &["studio"];
#[cfg(not(feature = "studio"))]
const STUDIO: &[&str] = &[];

/// The commands.
#[derive(Subcommand)]
pub(crate) enum Verb {
    Init(init::InitArgs),
    Check(check::CheckArgs),
    Decouple(decouple::DecoupleArgs),
    #[cfg(feature = "report")]
    Report(report::ReportArgs),
    #[cfg(feature = "studio")]
    Studio(studio::StudioArgs),
    Compare(compare::CompareArgs),
    Field(field::FieldArgs),
    Splice(splice::SpliceArgs),
    Design(design::DesignArgs),
    Tiles(tiles::TilesArgs),
    Tolerance(tolerance::ToleranceArgs),
    Budget(budget::BudgetArgs),
    Forces(forces::ForcesArgs),
    Assign(assign::AssignArgs),
    Diagnose(diagnose::DiagnoseArgs),
    Read(read::ReadArgs),
    Resolution(resolution::ResolutionArgs),
    Experiment(experiment::ExperimentArgs),
    Calibrate(calibrate::CalibrateArgs),
    Scan(scan::ScanArgs),
    Import(import::ImportArgs),
    Export(export::ExportArgs),
    /// Print the JSON Schema of layout files, for editors.
    #[command(after_help = "Example:\n  magsplice schema > layout.schema.json")]
    Schema,
    Plan(plan::PlanArgs),
    Bench(bench::BenchArgs),
    Completions(completions::CompletionsArgs),
}

impl Verb {
    /// Runs the verb, and returns its exit status. `program` is the whole command line.
    pub(crate) fn run(&self, quiet: bool, program: fn() -> Command) -> Result<u8, Failure> {
        match self {
            Verb::Check(args) => return check::run(args, quiet),
            Verb::Design(args) => return design::run(args, quiet),
            Verb::Splice(args) => return splice::run(args, quiet),
            Verb::Tolerance(args) => return tolerance::run(args, quiet),
            Verb::Field(args) => field::run(args, quiet),
            Verb::Compare(args) => compare::run(args, quiet),
            Verb::Decouple(args) => decouple::run(args, quiet),
            Verb::Plan(args) => plan::run(args, quiet),
            Verb::Bench(args) => bench::run(args, quiet),
            Verb::Budget(args) => budget::run(args, quiet),
            Verb::Forces(args) => forces::run(args, quiet),
            Verb::Read(args) => read::run(args, quiet),
            Verb::Experiment(args) => experiment::run(args, quiet),
            Verb::Calibrate(args) => calibrate::run(args, quiet),
            Verb::Scan(args) => scan::run(args, quiet),
            Verb::Diagnose(args) => diagnose::run(args, quiet),
            Verb::Resolution(args) => resolution::run(args, quiet),
            #[cfg(feature = "report")]
            Verb::Report(args) => report::run(args, quiet),
            #[cfg(feature = "studio")]
            Verb::Studio(args) => studio::run(args, quiet),
            Verb::Assign(args) => assign::run(args, quiet),
            Verb::Tiles(args) => tiles::run(args, quiet),
            Verb::Export(args) => export::run(args, quiet),
            Verb::Import(args) => import::run(args, quiet),
            Verb::Init(args) => init::run(args, quiet),
            Verb::Schema => schema::run(),
            Verb::Completions(args) => completions::run(args, program()),
        }
        .map(|()| 0)
    }
}

//! The program `magsplice`. Results go to standard output, everything else to standard error.
//!
//! Exit status: 0 success; 1 a check fails or has a finding, or a designed film misses a
//! requirement; 2 the work could not be done; 130 interrupted.
//!
//! A verb in `verbs/` has its arguments, runs the library on the film of a `Session`, and passes
//! the result as text, JSON or a table to a destination in `output/`.

/// The command line: verbs, options and their help texts.
mod args;
/// Tables of numbers: their lines, columns and units.
mod csv_input;
/// Decimal numbers with a unit.
mod decimal;
/// Reasons why the program stops, and how it tells them.
mod failure;
/// Lists of faulty lines and points.
mod faults;
/// Tables that users bring, each with its columns.
mod inputs;
/// Ctrl-C: temporary files are removed, a search ends with its best film.
mod interrupt;
/// Where results go: standard output, files, folders, tables.
mod output;
/// The progress line on a terminal.
mod progress;
/// Remarks on standard error.
mod remarks;
/// A layout file at work.
mod session;
/// Results as printed tables.
mod text;
/// Units that people write.
mod units;
/// One file per verb.
mod verbs;
/// Errors of the library in words with the names of tiles.
mod words;

use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use args::{Args, Verb};
use failure::Failure;

fn main() -> ExitCode {
    let Args { common, verb } = Args::parse();
    if let Some(count) = common.threads
        && let Err(error) = rayon::ThreadPoolBuilder::new().num_threads(count).build_global()
    {
        failure::tell(&format_args!("cannot start {count} threads: {error}"));
        return ExitCode::from(2);
    }
    match run(&verb, common.quiet) {
        Ok(status) => ExitCode::from(status),
        // A reader that closes the pipe early, such as `head`, has what it wanted.
        Err(Failure::PipeClosed) => ExitCode::SUCCESS,
        Err(failure) => {
            failure::tell(&failure);
            ExitCode::from(2)
        }
    }
}

/// The exit status of a verb that could do its work.
fn run(verb: &Verb, quiet: bool) -> Result<u8, Failure> {
    match verb {
        Verb::Check(args) => return verbs::check::run(args, quiet),
        Verb::Design(args) => return verbs::design::run(args, quiet),
        Verb::Splice(args) => return verbs::splice::run(args, quiet),
        Verb::Tolerance(args) => return verbs::tolerance::run(args, quiet),
        Verb::Field(args) => verbs::field::run(args, quiet),
        Verb::Compare(args) => verbs::compare::run(args, quiet),
        Verb::Decouple(args) => verbs::decouple::run(args, quiet),
        Verb::Plan(args) => verbs::plan::run(args, quiet),
        Verb::Bench(args) => verbs::bench::run(args, quiet),
        Verb::Budget(args) => verbs::budget::run(args, quiet),
        Verb::Forces(args) => verbs::forces::run(args, quiet),
        Verb::Read(args) => verbs::read::run(args, quiet),
        Verb::Experiment(args) => verbs::experiment::run(args, quiet),
        Verb::Calibrate(args) => verbs::calibrate::run(args, quiet),
        Verb::Scan(args) => verbs::scan::run(args, quiet),
        Verb::Diagnose(args) => verbs::diagnose::run(args, quiet),
        Verb::Resolution(args) => verbs::resolution::run(args, quiet),
        #[cfg(feature = "report")]
        Verb::Report(args) => verbs::report::run(args, quiet),
        Verb::Assign(args) => verbs::assign::run(args, quiet),
        Verb::Tiles(args) => verbs::tiles::run(args, quiet),
        Verb::Export(args) => verbs::export::run(args, quiet),
        Verb::Import(args) => verbs::import::run(args, quiet),
        Verb::Init(args) => verbs::init::run(args, quiet),
        Verb::Schema => verbs::schema::run(),
        Verb::Completions(args) => verbs::completions::run(args, Args::command()),
    }
    .map(|()| 0)
}

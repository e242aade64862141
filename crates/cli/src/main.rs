//! The program `magsplice`. Results go to standard output, everything else to standard error.
//!
//! Exit status: 0 fine, 1 a finding of `check`, or a film that is not as good as was asked, 2 the work could not be done, 130 it was interrupted.

mod args;
mod baseline;
mod failure;
mod folder;
mod formats;
mod interrupt;
mod output;
mod points;
mod progress;
mod text;
mod verbs;

use std::process::ExitCode;

use clap::Parser;

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
    let mut reached = 0;
    let done = match verb {
        Verb::Field(args) => verbs::field::run(&args, common.quiet),
        Verb::Compare(args) => verbs::compare::run(&args, common.quiet),
        Verb::Decouple(args) => verbs::decouple::run(&args, common.quiet),
        Verb::Tiles(args) => verbs::tiles::run(&args, common.quiet),
        Verb::Export(args) => verbs::export::run(&args, common.quiet),
        Verb::Init(args) => verbs::init::run(&args, common.quiet),
        Verb::Schema => verbs::schema::run(),
        Verb::Completions(args) => verbs::completions::run(&args),
        Verb::Check(args) => return ExitCode::from(verbs::check::run(&args, common.quiet)),
        Verb::Design(args) => verbs::design::run(&args, common.quiet).map(|status| reached = status),
        Verb::Splice(args) => verbs::design::splice(&args, common.quiet).map(|status| reached = status),
        Verb::Plan(args) => verbs::plan::run(&args, common.quiet),
        #[cfg(feature = "report")]
        Verb::Report(args) => verbs::report::run(&args, common.quiet),
    };
    match done {
        // A reader that closes the pipe early, such as `head`, has what it wanted.
        Ok(()) | Err(Failure::PipeClosed) => ExitCode::from(reached),
        Err(failure) => {
            failure::tell(&failure);
            ExitCode::from(2)
        }
    }
}

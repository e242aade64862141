//! The program `magsplice`. Results go to standard output, everything else to standard error.
//!
//! Exit status: 0 fine, 1 a finding of `check`, 2 the work could not be done.

mod args;
mod failure;
#[cfg(feature = "report")]
mod folder;
mod interrupt;
mod output;
mod points;
mod text;
mod verbs;

use std::process::ExitCode;

use clap::Parser;

use args::{Args, Verb};
use failure::Failure;

fn main() -> ExitCode {
    let done = match Args::parse().verb {
        Verb::Field(args) => verbs::field::run(&args),
        Verb::Compare(args) => verbs::compare::run(&args),
        Verb::Decouple(args) => verbs::decouple::run(&args),
        #[cfg(feature = "report")]
        Verb::Report(args) => verbs::report::run(&args),
        Verb::Check(args) => return ExitCode::from(verbs::check::run(&args)),
    };
    match done {
        // A reader that closes the pipe early, such as `head`, has what it wanted.
        Ok(()) | Err(Failure::PipeClosed) => ExitCode::SUCCESS,
        Err(failure) => {
            failure::tell(&failure);
            ExitCode::from(2)
        }
    }
}

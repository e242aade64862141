//! The program `magsplice`, as a function that its binary and the Python package call. Results go
//! to standard output, everything else to standard error.
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
/// Reasons why the program stops, and how it tells them.
mod failure;
/// Lists of faulty lines and points.
mod faults;
/// Files whose changes are awaited.
#[cfg(any(feature = "report", feature = "studio"))]
mod file_watch;
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
/// Hashes of files.
mod sha256;
/// Results as printed tables.
mod text;
/// Units that people write.
mod units;
/// One file per verb.
mod verbs;
/// Errors of the library in words with the names of tiles.
mod words;

use std::ffi::OsString;

use clap::{CommandFactory, FromArgMatches};

use args::Args;
use failure::Failure;
use magsplice::threads;

/// The exit status of the program, called with words whose first is its name.
///
/// It belongs to a process of its own: it sets the number of threads and handles signals, and
/// Ctrl-C ends the process.
pub fn run(words: impl IntoIterator<Item = OsString>) -> u8 {
    let words = args::layout_first(words.into_iter().collect());
    let parsed = args::command().try_get_matches_from(words).and_then(|matches| Args::from_arg_matches(&matches));
    let Args { common, verb } = match parsed {
        Ok(args) => args,
        // A help text is such an error too, with status 0.
        Err(error) => {
            let _ = error.print();
            return if error.use_stderr() { 2 } else { 0 };
        }
    };
    if let Err(error) = threads::start(common.threads) {
        failure::tell(&format_args!("cannot start threads: {error}; give a smaller --threads"));
        return 2;
    }
    match verb.run(common.quiet, Args::command) {
        Ok(status) => status,
        // A reader that closes the pipe early, such as `head`, has what it wanted.
        Err(Failure::PipeClosed) => 0,
        Err(failure) => {
            failure::tell(&failure);
            2
        }
    }
}

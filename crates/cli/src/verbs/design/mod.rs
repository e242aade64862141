//! `magsplice design`: searches for a better film.

use std::path::PathBuf;

use magsplice::design::DesignProblem;
use search::Origin;

use crate::args::formats::TextOrJson;
use crate::args::numbers::positive;
use crate::failure::Failure;
use crate::output::destination::Output;
use crate::remarks;
use crate::session::Session;

/// `--front`: searches the films of a trade-off.
mod front;
/// Shared parts of `design`, `design --front` and `splice`: the search, its progress, its result.
pub(super) mod search;
/// A film that was found, and the films of a front, as text.
mod text;

/// Search for a better film, as specified by the table [design] of the layout.
///
/// The result is a complete layout: the tiles, an [expect] table with the values reached, and a
/// line of history. Sides and angles are rounded to the resolution of [design]. Ctrl-C ends the
/// search and keeps the best film so far. Exit status: 0 success; 1 a requirement was not reached:
/// the amplitude, the number of parts, or an error below a tenth of the travel of the sensor; 2
/// there is no film.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  magsplice design film.toml -o better.toml\n  magsplice design film.toml --front -o front"
)]
pub(crate) struct DesignArgs {
    /// Layout file with a table [design]
    layout: PathBuf,
    /// File to write, complete or not at all [default: -, standard output]; with --front a folder
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Search for a series of trade-off films instead of one film: one for each amplitude of
    /// --amplitudes, and films with fewer and fewer distinct parts. Writes tables, figures and
    /// layouts
    #[arg(long)]
    front: bool,
    /// Least amplitudes of the films of --front, as fractions of the ideal film's amplitude
    #[arg(long, value_name = "LIST", value_delimiter = ',', requires = "front", value_parser = positive,
        default_value = "0.6,0.7,0.8,0.85,0.9,0.95,1.0,1.05")]
    amplitudes: Vec<f64>,
    /// Format of the summary
    #[arg(long, value_enum, default_value = "text")]
    format: TextOrJson,
}

pub(crate) fn run(args: &DesignArgs, quiet: bool) -> Result<u8, Failure> {
    let session = Session::open(&args.layout, remarks::OF_DESIGNS, quiet)?;
    session.progress.end();
    if args.front {
        return front::run(&session, &args.amplitudes, args.output.as_deref(), args.format, quiet);
    }
    let failed = |error| Failure::design(&args.layout, error);
    let problem = DesignProblem::new(&session.layout).map_err(failed)?;
    let output = Output::open(args.output.as_deref(), &[&args.layout])?;
    let result = search::search(&problem, quiet).map_err(failed)?;
    search::finish(&problem, result, Origin::Layout, output, args.output.as_deref(), args.format, quiet)
}

//! `magsplice design`: searches for a better film.

use magsplice::design::DesignProblem;

use super::{front, search};
use crate::args::design::DesignArgs;
use crate::failure::Failure;
use crate::output::destination::Output;
use crate::progress::ProgressLine;
use crate::remarks;

pub(crate) fn run(args: &DesignArgs, quiet: bool) -> Result<u8, Failure> {
    let progress = ProgressLine::start(!quiet);
    let layout = remarks::read_layout(&args.layout, remarks::OF_DESIGNS, quiet, &progress)?;
    progress.end();
    if args.front {
        return front::run(args, &layout, quiet);
    }
    let failed = |error| Failure::Design { place: args.layout.display().to_string(), error };
    let problem = DesignProblem::new(&layout).map_err(failed)?;
    let output = Output::open(args.output.as_deref(), &[&args.layout])?;
    let result = search::search(&problem, quiet).map_err(failed)?;
    search::finish(&problem, &result, "design", output, args.output.as_deref(), args.format, quiet)
}

//! `magsplice splice`: designs a film from nothing.

use magsplice::design::DesignProblem;

use super::search;
use crate::args::design::SpliceArgs;
use crate::failure::Failure;
use crate::output::destination::Output;

pub(crate) fn run(args: &SpliceArgs, quiet: bool) -> Result<u8, Failure> {
    let failed = |error| Failure::Design { place: "splice".to_owned(), error };
    let layout = args.request().layout().map_err(failed)?;
    let problem = DesignProblem::new(&layout).map_err(failed)?;
    let output = Output::open(args.output.as_deref(), &[])?;
    let result = search::search(&problem, quiet).map_err(failed)?;
    search::finish(&problem, &result, search::SPLICE, output, args.output.as_deref(), args.format, quiet)
}

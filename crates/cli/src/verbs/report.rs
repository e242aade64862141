//! `magsplice report`: draws figures and a page, once or whenever a layout is saved.

use super::{report_draw, report_watch};
use crate::args::evaluate::ReportArgs;
use crate::failure::Failure;

pub(crate) fn run(args: &ReportArgs, quiet: bool) -> Result<(), Failure> {
    if args.watch { report_watch::run(args, quiet) } else { report_draw::draw(args, quiet) }
}

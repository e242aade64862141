//! `magsplice export`: writes the film for another program.

use magsplice_export::{magpylib, vtk};

use crate::args::files::ExportArgs;
use crate::args::formats::ExportFormat;
use crate::failure::Failure;
use crate::output::destination::Output;
use crate::output::{choice, table};
use crate::progress::ProgressLine;
use crate::remarks;

pub(crate) fn run(args: &ExportArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let format = choice::choose(args.to, args.output.as_deref(), None)?;
    let layout = remarks::read_layout(&args.layout, remarks::OF_TILES, quiet, &progress)?;
    let mut output = Output::open(args.output.as_deref(), &[&args.layout])?;
    if let Output::Stdout(_) = output {
        progress.end();
    }
    output.write(|w| match format {
        ExportFormat::Magpylib => magpylib::script(&layout, env!("CARGO_PKG_VERSION"), w),
        ExportFormat::Vtk => vtk::film(&layout, &table::layout_metadata(&layout), w),
    })?;
    output.finish()
}

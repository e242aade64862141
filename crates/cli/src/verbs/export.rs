//! `magsplice export`: the film for another program.

use magsplice::layout::Layout;
use magsplice_export::{magpylib, vtk};

use crate::args::ExportArgs;
use crate::failure::Failure;
use crate::formats::{self, ExportFormat};
use crate::output::Output;
use crate::progress::Progress;

pub(crate) fn run(args: &ExportArgs, quiet: bool) -> Result<(), Failure> {
    let progress = Progress::start(!quiet);
    let format = formats::choose(args.to, args.output.as_deref(), None)?;
    let layout = Layout::read(&args.layout)?;
    let mut output = Output::open(args.output.as_deref(), &[&args.layout])?;
    if let Output::Stdout(_) = output {
        progress.end();
    }
    output.write(|w| match format {
        ExportFormat::Magpylib => magpylib::script(&layout, env!("CARGO_PKG_VERSION"), w),
        ExportFormat::Vtk => vtk::film(&layout, &formats::origin(&layout), w),
    })?;
    output.finish()
}

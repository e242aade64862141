//! `magsplice export`: the film for another program.

use magsplice::layout::Layout;
use magsplice_export::{magpylib, vtk};

use crate::args::ExportArgs;
use crate::failure::Failure;
use crate::formats::{self, ExportFormat};
use crate::output::Output;

pub(crate) fn run(args: &ExportArgs) -> Result<(), Failure> {
    let format = formats::choose(args.to, args.output.as_deref(), None)?;
    let layout = Layout::read(&args.layout)?;
    let mut output = Output::open(args.output.as_deref(), &[&args.layout])?;
    output.write(|w| match format {
        ExportFormat::Magpylib => magpylib::script(&layout, env!("CARGO_PKG_VERSION"), w),
        ExportFormat::Vtk => vtk::film(&layout, &formats::origin(&layout), w),
    })?;
    output.finish()
}

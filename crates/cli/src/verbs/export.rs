//! `magsplice export`: writes the film for another program.

use magsplice_export::{dxf, magpylib, magpylib_import, stl, vtk};

use crate::args::files::ExportArgs;
use crate::args::formats::{ExportFormat, FileFormat};
use crate::failure::Failure;
use crate::output::destination::Output;
use crate::output::{choice, table};
use crate::progress::ProgressLine;
use crate::remarks;

pub(crate) fn run(args: &ExportArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let format = choice::choose(args.to, args.output.as_deref(), None)?;
    let path = match (format, &args.layout) {
        (ExportFormat::MagpylibImport, None) => {
            let mut output = Output::open(args.output.as_deref(), &[])?;
            progress.end();
            output.write(|w| magpylib_import::script(env!("CARGO_PKG_VERSION"), w))?;
            return output.finish();
        }
        (ExportFormat::MagpylibImport, Some(path)) => {
            let why = "--to magpylib-import writes a script that reads a magpylib collection, and takes no layout";
            return Err(Failure::Format(format!("{}: {why}", path.display())));
        }
        (_, None) => return Err(Failure::Format(format!("--to {} needs a layout file", format.name()))),
        (_, Some(path)) => path,
    };
    let layout = remarks::read_layout(path, remarks::OF_TILES, quiet, &progress)?;
    let mut output = Output::open(args.output.as_deref(), &[path])?;
    if let Output::Stdout(_) = output {
        progress.end();
    }
    output.write(|w| match format {
        ExportFormat::Magpylib => magpylib::script(&layout, env!("CARGO_PKG_VERSION"), w),
        ExportFormat::MagpylibImport => unreachable!("refused above"),
        ExportFormat::Vtk => vtk::film(&layout, &table::layout_metadata(&layout), w),
        ExportFormat::Dxf => dxf::film(&layout, w),
        ExportFormat::Stl => stl::film(&layout, w),
    })?;
    output.finish()
}

//! `magsplice export`: writes the film for another program.

use std::path::Path;

use magsplice::layout::{Layout, WorkingVolume};
use magsplice::sensor::{DisplacementPolynomial, PolynomialError};
use magsplice::{Film, FilmError};
use magsplice_export::c_header::{self, DisplacementTable};
use magsplice_export::{dxf, magpylib, magpylib_import, stl, vtk};

use crate::args::files::ExportArgs;
use crate::args::formats::{ExportFormat, FileFormat};
use crate::failure::Failure;
use crate::output::destination::Output;
use crate::output::{choice, table};
use crate::progress::ProgressLine;
use crate::remarks;
use crate::words::{film_failure, no_volume};

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
    let table = match format {
        ExportFormat::CHeader => Some(polynomial(args, path, &layout)?),
        _ => None,
    };
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
        ExportFormat::CHeader => match &table {
            Some((polynomial, volume)) => {
                c_header::displacement(&layout, &displacement_table(polynomial, volume), env!("CARGO_PKG_VERSION"), w)
            }
            None => unreachable!("computed above"),
        },
    })?;
    output.finish()
}

/// The displacement in the working volume as a polynomial.
fn polynomial(
    args: &ExportArgs,
    path: &Path,
    layout: &Layout,
) -> Result<(DisplacementPolynomial, WorkingVolume), Failure> {
    let film = Film::new(layout);
    let volume = *film.volume().map_err(|error| no_volume(path, error))?;
    let found = DisplacementPolynomial::fit(film.scene(), &volume.grid, volume.reference_mm, args.error);
    let refused = |message: String| Failure::Points { path: path.to_owned(), message };
    found.map(|polynomial| (polynomial, volume)).map_err(|error| match error {
        PolynomialError::Points(errors) => film_failure(path, layout, FilmError::Points(errors)),
        PolynomialError::NotReached { least } => refused(format!(
            "no polynomial reaches an error of {} mm; the least is {least:.1e} mm: give a larger --error or a smaller \
             volume",
            args.error
        )),
        other => refused(other.to_string()),
    })
}

fn displacement_table<'a>(found: &'a DisplacementPolynomial, volume: &WorkingVolume) -> DisplacementTable<'a> {
    DisplacementTable {
        degree: found.degree,
        branch_sign: found.branch_sign,
        lower: found.lower,
        upper: found.upper,
        coefficients: &found.coefficients,
        largest_error_mm: found.largest_error,
        checked: found.checked,
        volume_lower_mm: volume.grid.lower(),
        volume_upper_mm: volume.grid.upper(),
        reference_mm: volume.reference_mm,
    }
}

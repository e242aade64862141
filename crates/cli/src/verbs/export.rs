//! `magsplice export`: writes the film for another program.

use std::path::PathBuf;

use magsplice::FilmError;
use magsplice::results::{LayoutSource, SensorPolynomial};
use magsplice::sensor::PolynomialError;
use magsplice_export::{c_header, dxf, magpylib, magpylib_import, stl, vtk};

use crate::args::formats::{ExportFormat, FileFormat};
use crate::args::numbers::length_mm;
use crate::failure::Failure;
use crate::output::choice;
use crate::output::destination::Output;
use crate::remarks;
use crate::session::{OF_SENSORS, Session};

/// Write the film for another program.
///
/// For magpylib: a Python script that rebuilds the film and prints its field. For ParaView: the
/// faces of the tiles with their polarization. For CAD: a drawing (DXF) or bodies (STL). For
/// firmware: the displacement of a sensor from its reading, as a function in C.
///
/// The other way round, --to magpylib-import writes a Python script that turns a magpylib
/// collection into a table for `magsplice import`.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice export layouts/published-film.toml --to magpylib -o film.py\n  \
    magsplice export layouts/published-film.toml --to c-header --error 0.005mm -o film.h")]
pub(crate) struct ExportArgs {
    /// Layout file; none for --to magpylib-import
    layout: Option<PathBuf>,
    /// Program to write for [default: by the file's ending]
    #[arg(long, value_enum, required_unless_present = "output")]
    to: Option<ExportFormat>,
    /// For --to c-header: largest length of the error of the displacement in the working volume
    /// [default: 0.005mm]
    #[arg(long, value_name = "LENGTH", value_parser = error_mm)]
    error: Option<f64>,
    /// File to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

fn error_mm(text: &str) -> Result<f64, String> {
    let value = length_mm(text)?;
    if value > 0.0 { Ok(value) } else { Err("must be above 0".to_owned()) }
}

/// Error of a displacement that goes with c-header if none is given: below the noise of most
/// sensors.
const DEFAULT_ERROR_MM: f64 = 0.005;

pub(crate) fn run(args: &ExportArgs, quiet: bool) -> Result<(), Failure> {
    let format = choice::choose(args.to, args.output.as_deref(), None)?;
    let path = match (format, &args.layout) {
        (ExportFormat::MagpylibImport, None) => {
            let mut output = Output::open(args.output.as_deref(), &[])?;
            output.write(|w| magpylib_import::script(env!("CARGO_PKG_VERSION"), w))?;
            return output.finish();
        }
        (ExportFormat::MagpylibImport, Some(path)) => {
            let why = "--to magpylib-import writes a script that reads a magpylib collection, and takes no layout";
            return Err(Failure::Refused(format!("{}: {why}", path.display())));
        }
        (_, None) => return Err(Failure::Refused(format!("--to {} needs a layout file", format.name()))),
        (_, Some(path)) => path,
    };
    let session = Session::open(path, remarks::OF_TILES, quiet)?;
    let layout = &*session.layout;
    let polynomial = match format {
        ExportFormat::CHeader => Some(polynomial(args, &session)?),
        _ if args.error.is_some() => {
            return Err(Failure::Refused(format!("--error is for --to c-header, not {}: leave it out", format.name())));
        }
        _ => None,
    };
    if matches!(format, ExportFormat::Magpylib) && !layout.iron.is_empty() {
        return Err(Failure::at(path, "magpylib has no field of iron, which [[plane]] adds: leave out [[plane]]"));
    }
    let mut output = session.output(args.output.as_deref(), None)?;
    session.progress.end();
    output.write(|w| match format {
        ExportFormat::Magpylib => magpylib::script(layout, env!("CARGO_PKG_VERSION"), w),
        ExportFormat::MagpylibImport => unreachable!("refused above"),
        ExportFormat::Vtk => vtk::film(layout, &LayoutSource::of(layout).metadata(layout.tiles.len()), w),
        ExportFormat::Dxf => dxf::film(layout, w),
        ExportFormat::Stl => stl::film(layout, w),
        ExportFormat::CHeader => match &polynomial {
            Some(polynomial) => c_header::displacement(layout, polynomial, env!("CARGO_PKG_VERSION"), w),
            None => unreachable!("computed above"),
        },
    })?;
    output.finish()
}

/// The displacement in the working volume as a polynomial.
fn polynomial(args: &ExportArgs, session: &Session) -> Result<SensorPolynomial, Failure> {
    let error_mm = args.error.unwrap_or(DEFAULT_ERROR_MM);
    session.volume(OF_SENSORS)?;
    session.film()?.displacement_polynomial(error_mm).map_err(|error| match error {
        FilmError::Polynomial(PolynomialError::NotReached { least }) => Failure::at(session.path, format_args!(
            "no polynomial reaches an error of {error_mm} mm; the least is {least:.1e} mm: give a larger --error or a \
             smaller volume"
        )),
        FilmError::Polynomial(other) => Failure::at(session.path, other),
        error => session.failed(error),
    })
}

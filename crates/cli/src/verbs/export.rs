//! `magsplice export`: writes the film for another program.

use std::path::Path;

use magsplice::FilmError;
use magsplice::layout::{Layout, WorkingVolume};
use magsplice::magnet::HallSensor;
use magsplice::prelude::{DMat3, DVec3};
use magsplice::sensor::{DisplacementPolynomial, PolynomialError};
use magsplice_export::c_header::{self, DisplacementTable};
use magsplice_export::{dxf, magpylib, magpylib_import, stl, vtk};

use crate::args::files::ExportArgs;
use crate::args::formats::{ExportFormat, FileFormat};
use crate::failure::Failure;
use crate::output::destination::Output;
use crate::output::{choice, table};
use crate::prepared_film::prepare;
use crate::progress::ProgressLine;
use crate::remarks;
use crate::words::{film_failure, no_volume};

/// Error of a displacement that goes with c-header if none is given: below the noise of most
/// sensors.
const DEFAULT_ERROR_MM: f64 = 0.005;

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
        ExportFormat::CHeader => Some(polynomial(args, path, &layout, &remarks::teller(quiet, &progress))?),
        _ if args.error.is_some() => {
            return Err(Failure::Format(format!("--error is for --to c-header, not {}: leave it out", format.name())));
        }
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
                let table = displacement_table(polynomial, volume, &layout);
                c_header::displacement(&layout, &table, env!("CARGO_PKG_VERSION"), w)
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
    tell: &dyn Fn(&str),
) -> Result<(DisplacementPolynomial, WorkingVolume), Failure> {
    let film = prepare(path, layout, &|_| {}, tell)?;
    let volume = *film.volume().map_err(|error| no_volume(path, error))?;
    let sensed = film.sensed_field(&volume.grid).map_err(|error| film_failure(path, layout, error))?;
    let error_mm = args.error.unwrap_or(DEFAULT_ERROR_MM);
    let found = DisplacementPolynomial::fit(sensed, &volume.grid, volume.reference_mm, error_mm);
    let refused = |message: String| Failure::Points { path: path.to_owned(), message };
    found.map(|polynomial| (polynomial, volume)).map_err(|error| match error {
        PolynomialError::Points(errors) => film_failure(path, layout, FilmError::Points(errors)),
        PolynomialError::NotReached { least } => refused(format!(
            "no polynomial reaches an error of {error_mm} mm; the least is {least:.1e} mm: give a larger --error or a \
             smaller volume"
        )),
        other => refused(other.to_string()),
    })
}

fn displacement_table<'a>(
    found: &'a DisplacementPolynomial,
    volume: &WorkingVolume,
    layout: &Layout,
) -> DisplacementTable<'a> {
    let sensor = layout.sensor.as_ref().map_or_else(HallSensor::default, |sensor| sensor.element);
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
        field_of_reading: DMat3::from_quat(sensor.rotation) * DMat3::from_diagonal(DVec3::ONE / sensor.gain),
        offset_t: sensor.offset_t,
    }
}

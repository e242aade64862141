//! `magsplice read`: displacements of the sensor from what it read.

use std::path::{Path, PathBuf};

use magsplice::prelude::{Branch, DVec3, Parameters};
use magsplice::sensor::{LocateError, Located, Locator};
use magsplice::{Film, FilmError, Stage};
use magsplice_export::{ColumnQuantity, Rows, Table};

use crate::args::formats::TableFormat;
use crate::args::sensor::ReadArgs;
use crate::failure::{self, Failure};
use crate::faults::FaultList;
use crate::json::sensor::ReadJson;
use crate::output::destination::Output;
use crate::output::{choice, table};
use crate::progress::ProgressLine;
use crate::words::{film_failure, no_points};
use crate::{reading_file, remarks};

pub(crate) fn run(args: &ReadArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let layout = remarks::read_layout(&args.layout, remarks::OF_FIELDS, quiet, &progress)?;
    let film = Film::new(&layout);
    let failed = |error| film_failure(&args.layout, &layout, error);
    let volume = film.volume().map_err(|error| no_points(&args.layout, error))?;
    let format = choice::choose(args.format, args.output.as_deref(), Some(TableFormat::Csv))?;
    if format == TableFormat::Vtk {
        return Err(Failure::Format("readings have no place in VTK: give another --format".to_owned()));
    }
    choice::accept(format, None, false)?;
    let inputs: Vec<&Path> = [&args.layout, &args.readings].into_iter().map(PathBuf::as_path).collect();
    let mut output = Output::open(args.output.as_deref(), &inputs)?;
    let (rows, lines) = reading_file::read_all(&args.readings, &[reading_file::flux_densities(args.unit)])?;
    let mut readings_t: Vec<DVec3> = rows.into_iter().map(|[reading]| reading).collect();

    progress.show(Stage::uncounted("readings"));
    let at_reference_t = film.reference_field_t().map_err(failed)?;
    let offset_t = offset_t(args, &readings_t, at_reference_t)?;
    readings_t.iter_mut().for_each(|reading| *reading -= offset_t);
    let locator = Locator::new(film.scene(), volume.grid).map_err(|errors| failed(FilmError::Points(errors)))?;
    let found = locator.locate(&readings_t);
    let mut columns = columns(args, &found, volume.reference_mm);
    if let Ok(ideal) = film.ideal() {
        columns.push(closed_form(&readings_t, at_reference_t, ideal.wavenumber()));
    }
    let status = found.iter().map(|found| f64::from(status(found))).collect();
    columns.push(ColumnQuantity { name: "status", components: &["status"], values: status });
    let mut metadata = table::film_metadata(&film);
    metadata.push(("readings", magsplice_export::MetadataValue::Text(args.readings.display().to_string())));
    let rows = Rows::Numbered { name: "reading", first: 1, count: found.len() };
    let result = Table::new(rows, columns, metadata).expect("a value for each reading");
    table::write(&result, &ReadJson::new(&film, &result), format, &mut output)?;
    output.finish()?;
    progress.end();
    if !quiet {
        tell_unlocated(args, &found, &lines);
    }
    Ok(())
}

/// What the readings at rest show beyond the field of the film at the reference point.
fn offset_t(args: &ReadArgs, readings_t: &[DVec3], at_reference_t: DVec3) -> Result<DVec3, Failure> {
    let Some(at_rest) = readings_t.get(..args.zero) else {
        let message = format!("has {} readings, fewer than the {} of --zero", readings_t.len(), args.zero);
        return Err(Failure::Points { path: args.readings.clone(), message });
    };
    Ok(match at_rest.len() {
        0 => DVec3::ZERO,
        count => at_rest.iter().sum::<DVec3>() / count as f64 - at_reference_t,
    })
}

/// The displacement of each reading, and its standard deviations if there is noise.
fn columns(args: &ReadArgs, found: &[Result<Located, LocateError>], reference_mm: DVec3) -> Vec<ColumnQuantity> {
    let located = |found: &Result<Located, LocateError>| match found {
        Ok(located) | Err(LocateError::Outside(located)) => Some(*located),
        Err(_) => None,
    };
    let of_each = |value: &dyn Fn(Located) -> Option<DVec3>| -> Vec<f64> {
        let value = |one| located(one).and_then(value).unwrap_or(DVec3::NAN);
        found.iter().flat_map(|found| value(found).to_array()).collect()
    };
    let mut columns = vec![ColumnQuantity {
        name: "displacement_mm",
        components: &["dx_mm", "dy_mm", "dz_mm"],
        values: of_each(&|located| Some(located.position - reference_mm)),
    }];
    if let Some(noise) = &args.noise.noise {
        columns.push(ColumnQuantity {
            name: "deviation_mm",
            components: &["deviation_x_mm", "deviation_y_mm", "deviation_z_mm"],
            values: of_each(&|located| noise.of_position(located.gradient)),
        });
    }
    columns
}

/// The displacement of each reading by the closed form of the ideal film.
fn closed_form(readings_t: &[DVec3], at_reference_t: DVec3, wavenumber: f64) -> ColumnQuantity {
    let of = |reading_t: DVec3| {
        let branch = Branch::from_axis_field(at_reference_t)?;
        let before = Parameters::from_field(at_reference_t, branch)?;
        Some(Parameters::from_field(reading_t, branch)?.displacement_from(&before, wavenumber))
    };
    ColumnQuantity {
        name: "closed_form_mm",
        components: &["closed_form_dx_mm", "closed_form_dy_mm", "closed_form_dz_mm"],
        values: readings_t.iter().flat_map(|reading| of(*reading).unwrap_or(DVec3::NAN).to_array()).collect(),
    }
}

/// The number in the column `status`.
fn status(found: &Result<Located, LocateError>) -> u8 {
    match found {
        Ok(_) => 0,
        Err(LocateError::Outside(_)) => 1,
        Err(LocateError::Ambiguous(_)) => 2,
        Err(_) => 3,
    }
}

/// Names the readings without a position in the volume.
fn tell_unlocated(args: &ReadArgs, found: &[Result<Located, LocateError>], lines: &[u64]) {
    let mut faults = FaultList::default();
    for (found, line) in found.iter().zip(lines) {
        if let Err(error) = found {
            faults.add(*line, format!("line {line}: {error}"));
        }
    }
    if !faults.is_empty() {
        failure::tell(&faults.remarks(&args.readings.display().to_string()));
    }
}

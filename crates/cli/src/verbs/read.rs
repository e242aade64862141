//! `magsplice read`: displacements of the sensor from what it read.

use std::path::{Path, PathBuf};

use magsplice::Stage;
use magsplice::layout::Elastomer;
use magsplice::prelude::DVec3;
use magsplice::results::{ColumnQuantity, Rows, Source, Table};
use magsplice::sensor::{LocateError, Located};

use crate::args::formats::TableFormat;
use crate::args::sensor::ReadArgs;
use crate::failure::{self, Failure};
use crate::faults::FaultList;
use crate::inputs::readings;
use crate::json::read::ReadJson;
use crate::output::destination::Output;
use crate::output::{choice, table};
use crate::prepared_film::prepare;
use crate::progress::ProgressLine;
use crate::remarks;
use crate::sensor::film_readings::{FilmReadings, Resting};
use crate::words::no_volume;

pub(crate) fn run(args: &ReadArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let layout = remarks::read_layout(&args.layout, remarks::OF_FIELDS, quiet, &progress)?;
    let film = prepare(&args.layout, &layout, &progress, &remarks::teller(quiet, &progress))?;
    film.volume().map_err(|error| no_volume(&args.layout, error))?;
    let format = choice::choose(args.format, args.output.as_deref(), Some(TableFormat::Csv))?;
    if format == TableFormat::Vtk {
        return Err(Failure::Format("readings have no place in VTK: give another --format".to_owned()));
    }
    choice::accept(format, None, false)?;
    let inputs: Vec<&Path> = [&args.layout, &args.readings].into_iter().map(PathBuf::as_path).collect();
    let mut output = Output::open(args.output.as_deref(), &inputs)?;
    let (rows, lines) = readings::read_all(&args.readings, &[readings::flux_densities(args.unit)])?;

    let readings_t: Vec<DVec3> = rows.into_iter().map(|[reading]| reading).collect();
    progress.show(Stage::uncounted("readings"));
    let readings = FilmReadings::new(
        &film,
        &args.layout,
        &args.readings,
        &readings_t,
        Resting::new(args.zero, args.rest),
        args.noise,
    )?;
    let found = &readings.found;
    let mut columns = columns(&readings, layout.elastomer.as_ref());
    if let Some(closed_form_mm) = &readings.closed_form_mm {
        columns.push(ColumnQuantity {
            name: "closed_form_mm",
            components: &["closed_form_dx_mm", "closed_form_dy_mm", "closed_form_dz_mm"],
            values: closed_form_mm.iter().flat_map(DVec3::to_array).collect(),
        });
    }
    let status = found.iter().map(|found| f64::from(status(found))).collect();
    columns.push(ColumnQuantity { name: "status", components: &["status"], values: status });
    let mut metadata = Source::of(&film).metadata();
    metadata.push(("readings", magsplice::results::MetadataValue::Text(args.readings.display().to_string())));
    let rows = Rows::Numbered { name: "reading", first: 1, count: found.len() };
    let result = Table::new(rows, columns, metadata).expect("a value for each reading");
    table::write(&result, &ReadJson::new(&film, &result), format, &mut output)?;
    output.finish()?;
    progress.end();
    if !quiet {
        let mut faults = FaultList::default();
        readings.unlocated(&lines).for_each(|(line, fault)| faults.add(line, fault));
        if !faults.is_empty() {
            failure::tell(&faults.remarks(&args.readings.display().to_string()));
        }
    }
    Ok(())
}

/// The displacement of each reading, its standard deviations if there is noise, and the force if
/// there is an elastic layer.
fn columns(readings: &FilmReadings, layer: Option<&Elastomer>) -> Vec<ColumnQuantity> {
    let of_each = |value: &dyn Fn(Located) -> Option<DVec3>| -> Vec<f64> {
        let values = readings.positions().map(|located| located.and_then(value).unwrap_or(DVec3::NAN));
        values.flat_map(|value| value.to_array()).collect()
    };
    let mut columns = vec![ColumnQuantity {
        name: "displacement_mm",
        components: &["dx_mm", "dy_mm", "dz_mm"],
        values: of_each(&|located| Some(located.position - readings.origin_mm)),
    }];
    let noise = readings.noise;
    if let Some(noise) = noise {
        columns.push(ColumnQuantity {
            name: "deviation_mm",
            components: &["deviation_x_mm", "deviation_y_mm", "deviation_z_mm"],
            values: of_each(&|located| noise.of_position(located.gradient)),
        });
    }
    if let Some(layer) = layer {
        // The film moves by the opposite of the sensor's displacement.
        columns.push(ColumnQuantity {
            name: "force_n",
            components: &["fx_n", "fy_n", "fz_n"],
            values: of_each(&|located| Some(layer.force_n(readings.origin_mm - located.position))),
        });
        if let Some(noise) = noise {
            let stiffness = layer.stiffness_n_per_mm();
            columns.push(ColumnQuantity {
                name: "deviation_n",
                components: &["deviation_fx_n", "deviation_fy_n", "deviation_fz_n"],
                values: of_each(&|located| Some(stiffness * noise.of_position(located.gradient)?)),
            });
        }
    }
    columns
}

/// The number in the column `status`.
fn status(found: &Result<Located, LocateError>) -> u8 {
    match found {
        Ok(_) => 0,
        Err(LocateError::Outside(_)) => 1,
        Err(LocateError::Ambiguous(_)) => 2,
        Err(LocateError::Saturated) => 4,
        Err(_) => 3,
    }
}

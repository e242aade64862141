//! `magsplice calibrate`: the stiffness of the elastic layer from forces and readings.

use std::path::{Path, PathBuf};

use magsplice::Stage;
use magsplice::prelude::DVec3;
use magsplice::sensor::Stiffness;

use crate::args::formats::TextOrJson;
use crate::args::sensor::CalibrateArgs;
use crate::failure::{self, Failure};
use crate::faults::FaultList;
use crate::inputs::readings;
use crate::json::calibrate::CalibrationJson;
use crate::output::destination::Output;
use crate::prepared_film::prepare;
use crate::progress::ProgressLine;
use crate::sensor::calibration::Calibration;
use crate::sensor::film_readings::{FilmReadings, Resting};
use crate::{json, remarks, text};

pub(crate) fn run(args: &CalibrateArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let layout = remarks::read_layout(&args.layout, remarks::OF_FIELDS, quiet, &progress)?;
    let film = prepare(&args.layout, &layout, &progress, &remarks::teller(quiet, &progress))?;
    let inputs: Vec<&Path> = [&args.layout, &args.readings].into_iter().map(PathBuf::as_path).collect();
    let mut output = Output::open(args.result.output.as_deref(), &inputs)?;
    let groups = [readings::FORCES, readings::flux_densities(None)];
    let (rows, lines) = readings::read_all(&args.readings, &groups)?;
    let (forces_n, readings_t): (Vec<DVec3>, Vec<DVec3>) =
        rows.into_iter().map(|[force, reading]| (force, reading)).unzip();
    progress.show(Stage::uncounted("readings"));
    let readings =
        FilmReadings::new(&film, &args.layout, &args.readings, &readings_t, Resting::new(args.zero, args.rest), None)?;
    let place = args.readings.display().to_string();
    let mut faults = FaultList::default();
    readings.unlocated(&lines).for_each(|(line, fault)| faults.add(line, fault));
    // The film moves by the opposite of the sensor's displacement.
    let by_field: Option<Vec<DVec3>> =
        readings.positions().map(|located| located.map(|located| readings.origin_mm - located.position)).collect();
    let Some(by_field) = by_field else { return Err(faults.failure(place)) };
    // A reading at the border of the volume may be outside by its noise.
    if !faults.is_empty() && !quiet {
        failure::tell(&faults.remarks(&place));
    }
    let by_closed_form: Option<Vec<DVec3>> =
        readings.closed_form_mm.as_ref().map(|moved| moved.iter().map(|moved| -*moved).collect());
    let fit = |displacements_mm: &[DVec3]| -> Result<[Stiffness; 3], Failure> {
        let mut axes = Vec::new();
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let [displacements, forces] =
                [displacements_mm, &forces_n].map(|of| -> Vec<f64> { of.iter().map(|v| v[axis]).collect() });
            axes.push(Stiffness::fit(&displacements, &forces).map_err(|error| Failure::Points {
                path: args.readings.clone(),
                message: format!("along {name}: {error}"),
            })?);
        }
        Ok(axes.try_into().expect("three axes"))
    };
    let calibration = Calibration {
        readings: forces_n.len(),
        hooke_n_per_mm: layout.elastomer.map(|layer| layer.hooke_n_per_mm()),
        by_field: fit(&by_field)?,
        by_closed_form: by_closed_form.as_deref().map(fit).transpose()?,
    };
    progress.end();
    let result = match args.result.format {
        TextOrJson::Text => text::calibrate::calibration(&film, args, &calibration),
        TextOrJson::Json => json::pretty(&CalibrationJson::new(&film, &calibration)),
    };
    output.write(|w| w.write_all(result.as_bytes()))?;
    output.finish()
}

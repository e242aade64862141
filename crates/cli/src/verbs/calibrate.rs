//! `magsplice calibrate`: the stiffness of the elastic layer from forces and readings.

use std::fmt::Write;
use std::path::PathBuf;

use magsplice::decouple::PerAxis;
use magsplice::prelude::DVec3;
use magsplice::results::FilmCalibration;
use magsplice::sensor::Stiffness;
use magsplice::{Film, FilmError};

use super::read::{located, unlocated};
use crate::args::formats::ResultArgs;
use crate::failure::Failure;
use crate::inputs::readings;
use crate::remarks;
use crate::session::Session;
use crate::text::number::{counted, number};
use crate::text::{header, rows};

/// Fit the stiffness of the elastic layer: forces against displacements.
///
/// Each row has a force on the film and a reading of the sensor. The displacement of the film is
/// computed from the reading, by the exact field of the layout and, with [ideal], by the closed
/// form of the ideal film. For each axis, a line F = stiffness x displacement + force at rest is
/// fitted by least squares (Dai 2024, Eqs. 16 and 17): six coefficients for each method, with
/// intervals of 95 % confidence.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice calibrate forces.csv --layout film.toml --zero 20")]
pub(crate) struct CalibrateArgs {
    /// CSV file with columns fx_n, fy_n, fz_n and bx_mt, by_mt, bz_mt, or in other units, such as
    /// Fx (mN) and Bx (uT); - is standard input
    readings: PathBuf,
    /// Layout file of the film
    #[arg(long, value_name = "LAYOUT")]
    layout: PathBuf,
    /// The first N readings are of the film at rest: their mean, less the field of the film at the
    /// reference point, is subtracted from all
    #[arg(long, value_name = "N", default_value = "0")]
    zero: usize,
    /// The first N readings are of the film at rest: displacements count from the position of their
    /// mean, not from the reference point
    #[arg(long, value_name = "N", default_value = "0", conflicts_with = "zero")]
    rest: usize,
    #[command(flatten)]
    result: ResultArgs,
}

pub(crate) fn run(args: &CalibrateArgs, quiet: bool) -> Result<(), Failure> {
    let session = Session::open(&args.layout, remarks::OF_FIELDS, quiet)?;
    let film = session.film()?;
    let output = session.output(args.result.output.as_deref(), [&*args.readings])?;
    let (rows, lines) = readings::read_all(&args.readings, &[readings::FORCES, readings::flux_densities(None)])?;
    let (forces_n, readings_t): (Vec<DVec3>, Vec<DVec3>) =
        rows.into_iter().map(|[force, reading]| (force, reading)).unzip();
    let readings = located(&session, &film, &args.readings, &readings_t, [args.zero, args.rest], None)?;
    let (place, faults) = (args.readings.display().to_string(), unlocated(&readings, &lines));
    let found = match readings.calibrate(&forces_n) {
        Err(FilmError::NoPosition { .. }) => return Err(faults.failure(place)),
        // A reading at the border of the volume may be outside by its noise.
        found => {
            if !faults.is_empty() {
                session.tell(&faults.remarks(&place));
            }
            found.map_err(|error| Failure::at(&args.readings, error.to_string()))?
        }
    };
    let result = args.result.format.shown(&found, || text(&film, args, &found));
    session.write(output, &result)
}

fn text(film: &Film, args: &CalibrateArgs, found: &FilmCalibration) -> String {
    let mut text = header::with_recoil(film);
    let readings = counted(found.readings, "reading", "readings");
    let _ = writeln!(
        text,
        "{}: {readings}; force = stiffness x displacement of the film + force at rest\n",
        args.readings.display()
    );
    rows::heading(&mut text, "displacements by the field of the layout", ["x", "y", "z"]);
    axes(&mut text, &found.by_field, found.hooke_n_per_mm);
    if let Some(by_closed_form) = &found.by_closed_form {
        rows::heading(&mut text, "displacements by the closed form", ["x", "y", "z"]);
        axes(&mut text, by_closed_form, found.hooke_n_per_mm);
    }
    text += "intervals hold with 95 % confidence\n";
    text
}

fn axes(text: &mut String, axes: &PerAxis<Stiffness>, hooke_n_per_mm: Option<DVec3>) {
    let axes = [axes.x, axes.y, axes.z];
    let row = |text: &mut String, name: &str, of: &dyn Fn(&Stiffness) -> f64| {
        rows::cells(text, name, axes.each_ref().map(|axis| number(of(axis))));
    };
    row(text, "  stiffness, N/mm", &|axis| axis.stiffness);
    row(text, "    +-", &|axis| axis.stiffness_95);
    if let Some(hooke) = hooke_n_per_mm {
        let scale = [0, 1, 2].map(|axis| number(axes[axis].stiffness / hooke[axis]));
        rows::cells(text, "    over Hooke's law of [elastomer]", scale);
    }
    row(text, "  force at rest, N", &|axis| axis.force_at_rest);
    row(text, "    +-", &|axis| axis.force_at_rest_95);
    row(text, "  residual, N", &|axis| axis.residual);
}

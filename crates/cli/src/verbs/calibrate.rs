//! `magsplice calibrate`: the stiffness of the elastic layer from forces and readings.

use std::fmt::Write;
use std::path::PathBuf;

use magsplice::Film;
use magsplice::decouple::PerAxis;
use magsplice::prelude::DVec3;
use magsplice::results::{FilmCalibration, FilmReadings};
use magsplice::sensor::Stiffness;

use super::read::{HeadFitArg, located, unlocated};
use crate::args::formats::ResultArgs;
use crate::args::given_units::{GivenUnits, given_units};
use crate::args::numbers::whole;
use crate::failure::Failure;
use crate::faults::FaultList;
use crate::inputs::readings::{self, Readings};
use crate::remarks;
use crate::session::Session;
use crate::text::number::{counted, number, number_beside};
use crate::text::{header, rows};

/// Fit the stiffness of the elastic layer: forces against displacements.
///
/// Each row has a force on the film and a reading of the sensor. The displacement of the film is
/// computed from the reading, by the exact field of the layout and, with [ideal], by the closed
/// form of the ideal film. For each axis, a line F = stiffness x displacement + force at rest is
/// fitted by least squares (Dai 2024, Eqs. 16 and 17): six coefficients for each method, with
/// intervals of 95 % confidence.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice calibrate film.toml forces.csv --zero 20")]
pub(crate) struct CalibrateArgs {
    /// Layout file of the film
    layout: PathBuf,
    /// Table (CSV) with columns fx_n, fy_n, fz_n (one at least) and bx_mt, by_mt, bz_mt, or in
    /// other units, such as Fx (mN) and Bx (uT); - is standard input
    #[arg(value_name = "TABLE")]
    readings: PathBuf,
    /// Units of columns without a unit in their names, such as N,mT; the line of column names is
    /// still required
    #[arg(long, value_name = "UNITS", value_parser = given_units)]
    unit: Option<GivenUnits>,
    /// The first N readings are of the film at rest: their mean, less the field of the film at the
    /// reference point, is subtracted from all
    #[arg(long, value_name = "N", default_value = "0", value_parser = |text: &str| whole(text, 0..=usize::MAX))]
    zero: usize,
    /// The first N readings are of the film at rest: displacements count from the position of their
    /// mean, not from the reference point
    #[arg(long, value_name = "N", default_value = "0", conflicts_with = "zero",
        value_parser = |text: &str| whole(text, 0..=usize::MAX))]
    rest: usize,
    #[command(flatten)]
    result: ResultArgs,
}

pub(crate) fn run(args: &CalibrateArgs, quiet: bool) -> Result<(), Failure> {
    let session = Session::open(&args.layout, remarks::OF_FIELDS, quiet)?;
    let film = session.film()?;
    let output = session.output(args.result.output.as_deref(), [&*args.readings])?;
    let read = readings::with_forces(&session, &args.readings, args.unit.as_ref())?;
    let fitted = HeadFitArg::StrayField;
    let readings = located(&session, &film, &args.readings, &read, [args.zero, args.rest], None, fitted)?;
    let Readings { beside: forces_n, lines, .. } = read;
    let (place, faults) = (args.readings.display().to_string(), unlocated(&readings, &lines));
    if !faults.is_empty() {
        session.tell(&faults.remarks(&place));
    }
    let found =
        readings.calibrate(&forces_n, &lines).map_err(|error| Failure::at(&args.readings, error.to_string()))?;
    let result = args.result.format.shown(&found, || text(&film, args, &found));
    session.write(output, &result)?;
    tell_doubts(&session, &place, &readings, &lines, &found);
    Ok(())
}

/// Prints missing forces, outliers, axes without a stiffness and negative stiffnesses on standard
/// error.
fn tell_doubts(session: &Session, place: &str, readings: &FilmReadings, lines: &[u64], found: &FilmCalibration) {
    let mut faults = FaultList::default();
    let located = lines.iter().zip(&readings.found).filter(|(_, found)| found.is_ok());
    for (line, _) in located.filter(|(line, _)| found.excluded.incomplete.contains(line)) {
        faults.add(*line, format!("line {line}: excluded as incomplete: a force is missing"));
    }
    for line in &found.excluded.outliers {
        faults.add(*line, format!("line {line}: excluded as an outlier: its force contradicts the others"));
    }
    if !faults.is_empty() {
        session.tell(&faults.remarks(place));
    }
    for remark in found.remarks() {
        session.tell(&format!("{place}: {remark}"));
    }
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

fn axes(text: &mut String, axes: &PerAxis<Option<Stiffness>>, hooke_n_per_mm: Option<DVec3>) {
    let axes = [axes.x, axes.y, axes.z];
    let row = |text: &mut String, name: &str, of: &dyn Fn(usize, &Stiffness) -> String| {
        let cell = |axis: usize| axes[axis].as_ref().map_or("none".to_owned(), |line| of(axis, line));
        rows::cells(text, name, [0, 1, 2].map(cell));
    };
    row(text, "  stiffness, N/mm", &|_, line| number(line.stiffness));
    row(text, "    +-", &|_, line| number(line.stiffness_95));
    if let Some(hooke) = hooke_n_per_mm {
        row(text, "    over Hooke's law of [elastomer]", &|axis, line| number(line.stiffness / hooke[axis]));
    }
    // Exact data leave round-off of the force that moves the film by 1 mm.
    row(text, "  force at rest, N", &|_, line| number_beside(line.force_at_rest, line.stiffness));
    row(text, "    +-", &|_, line| number_beside(line.force_at_rest_95, line.stiffness));
    row(text, "  residual, N", &|_, line| number_beside(line.residual, line.stiffness));
}

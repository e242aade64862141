//! `magsplice experiment`: moves the film and prints the readings of its sensor.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use magsplice::magnet::{Bend, Deformation, HeightMap, HeightMapError};
use magsplice::prelude::DVec3;
use magsplice::results::{EXPERIMENT_STEP_MM, FilmExperiments, larger_range};
use magsplice::sensor::ExperimentStep;
#[cfg(feature = "report")]
use magsplice_report::{SvgText, experiment_figure};

use crate::args::formats::TableFormat;
use crate::args::numbers::{angle_rad, length_mm, seed, vector};
use crate::failure::Failure;
use crate::inputs::points;
use crate::output::{choice, table};
use crate::remarks;
use crate::session::{OF_SENSORS, Session};
use crate::text::number::counted;

/// Move the film along x, y and z, and compute the readings of its sensor.
///
/// The film moves by multiples of a step as far as the sensor stays in the working volume: in shear
/// along x and y, and towards the sensor along z (Dai 2024, Fig. 9). The table has the displacement
/// of the film, the readings, R_x, R_y and S_z, and the displacement computed from the readings: by
/// the field of the layout and, with [ideal], by the closed form. With [elastomer] it also has the
/// forces (Eqs. 16 and 17), so that `magsplice calibrate` reads it. With [sensor] the readings are
/// from this sensor.
///
/// The film of the experiment may differ from the layout: it may be bent, then turned about its
/// centre, then shifted. Its tiles follow as rigid blocks. Displacements count from its apparent
/// position at rest, as with `read --rest`.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  magsplice experiment layouts/published-film.toml -o moved.csv --figure moved.png\n  \
    magsplice experiment film.toml --seed 1 --rotate 0,0.5deg,0 --bend-radius 200mm --bend-along x"
)]
pub(crate) struct ExperimentArgs {
    /// Layout file
    layout: PathBuf,
    /// Step of the film, or steps along x, y and z, in mm
    #[arg(long, value_name = "LENGTHS", default_value = "0.5mm,0.5mm,1mm", value_parser = steps_mm)]
    step: DVec3,
    /// Add the noise of [sensor] to the readings, with this seed
    #[arg(long, value_name = "SEED", value_parser = seed)]
    seed: Option<u64>,
    /// Shift of the film from its place in the layout, along x, y and z, such as 0.1mm,0,0
    #[arg(long, value_name = "LENGTHS", value_parser = lengths_mm, allow_hyphen_values = true)]
    shift: Option<DVec3>,
    /// Rotation vector of the film from its pose in the layout: angles about axes parallel to x, y
    /// and z, such as 0,0.5deg,0
    #[arg(long, value_name = "ANGLES", value_parser = angles_rad, allow_hyphen_values = true)]
    rotate: Option<DVec3>,
    /// Bending radius of the film; with a positive radius its ends rise away from the sensor
    #[arg(long, value_name = "LENGTH", value_parser = length_mm, allow_hyphen_values = true)]
    bend_radius: Option<f64>,
    /// Axis along which the film is bent
    #[arg(long, value_enum, value_name = "AXIS", default_value = "x", requires = "bend_radius")]
    bend_along: BendAxis,
    /// CSV file with the heights of the film over its flat shape: columns x_mm, y_mm, z_mm, on a
    /// full grid
    #[arg(long, value_name = "TABLE", conflicts_with = "bend_radius")]
    heights: Option<PathBuf>,
    /// Draw the curves of Dai 2024, Fig. 9, into this file, .pdf, .svg or .png
    #[cfg(feature = "report")]
    #[arg(long, value_name = "FIGURE")]
    figure: Option<PathBuf>,
    /// File to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "TABLE")]
    output: Option<PathBuf>,
    /// Format of the result [default: by the file's ending, else csv]
    #[arg(long, value_enum)]
    format: Option<TableFormat>,
}

/// An axis of the film.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum BendAxis {
    /// The ends of x rise or fall
    X,
    /// The ends of y rise or fall
    Y,
}

pub(crate) fn run(args: &ExperimentArgs, quiet: bool) -> Result<(), Failure> {
    let session = Session::open(&args.layout, remarks::OF_FIELDS, quiet)?;
    let film = session.film()?;
    session.volume(OF_SENSORS)?;
    let has_noise = film.layout().sensor.as_ref().is_some_and(|sensor| sensor.as_one().noise_t != DVec3::ZERO);
    if args.seed.is_some() && !has_noise {
        let message = "the layout has no noise for --seed: give noise_ut or part in [sensor]";
        return Err(Failure::at(&args.layout, message));
    }
    let format = choice::choose_rows(args.format, args.output.as_deref(), "steps")?;
    let mut output = session.output(args.output.as_deref(), args.heights.as_deref())?;
    #[cfg(feature = "report")]
    let figure = session.figure(args.figure.as_deref(), args.heights.as_deref())?;
    let deformation = deformation(&session, args)?;
    let made = (deformation != Deformation::default()).then(|| film.deformed(&deformation)).transpose();
    let made = made.map_err(|error| {
        Failure::at(&args.layout, format_args!("this bend or shift of the film is impossible (lengths in mm): {error}"))
    })?;
    let found = film.experiments(args.step, args.seed, made.as_ref()).map_err(|error| session.failed(error))?;
    table::write(&found.table(), &found, format, &mut output)?;
    output.finish()?;
    #[cfg(feature = "report")]
    if let Some(file) = figure {
        file.write(experiment_figure(&found, SvgText::Text))?;
    }
    session.progress.end();
    remark(&session, &found);
    Ok(())
}

/// The deformation of the film that is read.
fn deformation(session: &Session, args: &ExperimentArgs) -> Result<Deformation, Failure> {
    let along = if args.bend_along == BendAxis::X { 0 } else { 1 };
    let bend = match (args.bend_radius, &args.heights) {
        (Some(radius), _) => Some(Bend::Cylinder { along, radius }),
        (None, Some(path)) => Some(Bend::Heights(heights(path, &|remark| session.tell(remark))?)),
        (None, None) => None,
    };
    Ok(Deformation { bend, rotation_rad: args.rotate.unwrap_or_default(), shift: args.shift.unwrap_or_default() })
}

/// The heights of a CSV file.
fn heights(path: &Path, tell: &dyn Fn(&str)) -> Result<HeightMap, Failure> {
    let (points, lines) = points::read_all(path, None, tell)?;
    HeightMap::from_points(&points).map_err(|error| {
        let message = match error {
            HeightMapError::Repeated { point } => {
                format!("line {}: has the x and y of an earlier line", lines[point])
            }
            error => error.to_string(),
        };
        Failure::at(path, message)
    })
}

/// Prints on standard error at how many steps a reading gives nothing.
fn remark(session: &Session, found: &FilmExperiments) {
    let layout = session.path.display();
    let count = |is_so: &dyn Fn(&ExperimentStep) -> bool| found.all_steps().filter(|step| is_so(step)).count();
    let saturated = count(&|step| step.is_saturated);
    if saturated > 0 {
        let steps = counted(saturated, "step", "steps");
        let readings_t = found.all_steps().map(|step| &step.reading_t);
        let larger = session.layout.sensor.as_ref().and_then(|sensor| larger_range(sensor, readings_t));
        let larger = larger.unwrap_or_default();
        session.tell(&format!("{layout}: at {steps} the flux density exceeds the range of the sensor{larger}"));
    }
    let lost = count(&|step| step.by_field.is_none() && !step.is_saturated);
    if lost > 0 {
        let steps = counted(lost, "step", "steps");
        session.tell(&format!(
            "{layout}: at {steps} the reading fits no position in the field of the layout, or two positions\n"
        ));
    }
}

fn steps_mm(text: &str) -> Result<DVec3, String> {
    let steps = match text.split(',').count() {
        1 => DVec3::splat(length_mm(text)?),
        _ => lengths_mm(text)?,
    };
    let example = EXPERIMENT_STEP_MM;
    if steps.cmpgt(DVec3::ZERO).all() {
        Ok(steps)
    } else {
        Err(format!("each step must be above 0, such as {}mm,{}mm,{}mm", example.x, example.y, example.z))
    }
}

fn lengths_mm(text: &str) -> Result<DVec3, String> {
    vector(text, length_mm, "must be three lengths, such as 0.1mm,0,0")
}

fn angles_rad(text: &str) -> Result<DVec3, String> {
    vector(text, angle_rad, "must be three angles, such as 0,0.5deg,0")
}

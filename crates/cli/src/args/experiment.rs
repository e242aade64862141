//! Arguments of `experiment`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use magsplice::EXPERIMENT_STEP_MM;
use magsplice::prelude::DVec3;

use super::formats::TableFormat;
use super::numbers::{angle_rad, length_mm};

/// Move the film along x, y and z, and tell what its sensor reads.
///
/// The film moves by multiples of a step as far as the sensor stays in the working volume: in shear
/// along x and y, and towards the sensor along z (Dai 2024, Fig. 9). The table has the displacement
/// of the film, the readings, R_x, R_y and S_z, and the displacement that the readings tell: by the
/// field of the layout and, with [ideal], by the closed form. With [elastomer] it also has the
/// forces (Eqs. 16 and 17), so that `magsplice calibrate` reads it. With [sensor] the readings are
/// those of this sensor.
///
/// The film that is read may differ from the layout: it is bent, then turned about its centre, then
/// shifted. Its tiles follow as rigid blocks. Displacements count from where it seems to be at
/// rest, as with `read --rest`.
#[derive(Args)]
#[command(
    after_help = "Example:\n  magsplice experiment layouts/published-film.toml -o moved.csv --figure moved.png\n  \
    magsplice experiment film.toml --seed 1 --rotate 0,0.5deg,0 --bend-radius 200mm --bend-along x"
)]
pub(crate) struct ExperimentArgs {
    /// Layout file
    pub(crate) layout: PathBuf,
    /// Step of the film, or steps along x, y and z, in mm
    #[arg(long, value_name = "LENGTHS", default_value = "0.5mm,0.5mm,1mm", value_parser = steps_mm)]
    pub(crate) step: DVec3,
    /// Add the noise of [sensor] to the readings, with this seed
    #[arg(long, value_name = "SEED")]
    pub(crate) seed: Option<u64>,
    /// Shift of the film that is read along x, y and z, such as 0.1mm,0,0
    #[arg(long, value_name = "LENGTHS", value_parser = lengths_mm, allow_hyphen_values = true)]
    pub(crate) shift: Option<DVec3>,
    /// Rotation vector of the film that is read: angles about axes parallel to x, y and z, such as
    /// 0,0.5deg,0
    #[arg(long, value_name = "ANGLES", value_parser = angles_rad, allow_hyphen_values = true)]
    pub(crate) rotate: Option<DVec3>,
    /// Radius to which the film is bent; its ends rise from the sensor if it is positive
    #[arg(long, value_name = "LENGTH", value_parser = length_mm, allow_hyphen_values = true)]
    pub(crate) bend_radius: Option<f64>,
    /// Axis along which the film is bent
    #[arg(long, value_enum, value_name = "AXIS", default_value = "x", requires = "bend_radius")]
    pub(crate) bend_along: BendAxis,
    /// CSV file with the heights of the film over its flat shape: columns x_mm, y_mm, z_mm, on a
    /// full grid
    #[arg(long, value_name = "FILE", conflicts_with = "bend_radius")]
    pub(crate) heights: Option<PathBuf>,
    /// Draw the curves of Dai 2024, Fig. 9, into this file, .svg or .png
    #[cfg(feature = "report")]
    #[arg(long, value_name = "FILE")]
    pub(crate) figure: Option<PathBuf>,
    /// File to write, complete or not at all [default: -, standard output]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Format of the result [default: by the file's ending, else csv]
    #[arg(long, value_enum)]
    pub(crate) format: Option<TableFormat>,
}

/// An axis of the film.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum BendAxis {
    /// The ends of x rise or fall
    X,
    /// The ends of y rise or fall
    Y,
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

fn vector(text: &str, value: fn(&str) -> Result<f64, String>, rule: &str) -> Result<DVec3, String> {
    let parts: Vec<&str> = text.split(',').collect();
    let [x, y, z] = parts[..] else { return Err(rule.to_owned()) };
    Ok(DVec3::new(value(x)?, value(y)?, value(z)?))
}

//! Errors of measurements of tiles.

use std::f64::consts::FRAC_PI_4;

use clap::Args;
use magsplice::making::MeasurementErrors;

use super::numbers::{angle_rad, fraction, length_mm};

/// Errors of the measurements of tiles.
#[derive(Args)]
#[command(next_help_heading = "Standard deviations of the measurement errors of tiles")]
pub(crate) struct MeasurementArgs {
    /// Error of the strength, such as 0.5%
    #[arg(long, value_name = "FRACTION", value_parser = strength)]
    pub(crate) strength_error: Option<f64>,
    /// Error of the direction of J about each axis normal to it, such as 0.3deg
    #[arg(long, value_name = "ANGLE", value_parser = direction_rad)]
    pub(crate) direction_error: Option<f64>,
    /// Error of each side, such as 0.01mm [default: sides are not measured]
    #[arg(long, value_name = "LENGTH", value_parser = size_mm)]
    pub(crate) size_error: Option<f64>,
}

impl MeasurementArgs {
    /// The errors, if any is given.
    pub(crate) fn errors(&self) -> Option<MeasurementErrors> {
        let MeasurementArgs { strength_error, direction_error, size_error } = *self;
        [strength_error, direction_error, size_error].iter().any(Option::is_some).then(|| MeasurementErrors {
            strength: strength_error.unwrap_or(0.0),
            direction_rad: direction_error.unwrap_or(0.0),
            size_mm: size_error,
        })
    }
}

/// Errors beyond which nothing was measured.
const MOST_STRENGTH: f64 = 0.5;
const MOST_DIRECTION_RAD: f64 = FRAC_PI_4;
const MOST_SIZE_MM: f64 = 10.0;

fn strength(text: &str) -> Result<f64, String> {
    within(fraction(text)?, MOST_STRENGTH, "0 to 50%")
}

fn direction_rad(text: &str) -> Result<f64, String> {
    within(angle_rad(text)?, MOST_DIRECTION_RAD, "0 to 45 deg")
}

fn size_mm(text: &str) -> Result<f64, String> {
    within(length_mm(text)?, MOST_SIZE_MM, "0 to 10 mm")
}

fn within(value: f64, most: f64, range: &str) -> Result<f64, String> {
    if (0.0..=most).contains(&value) { Ok(value) } else { Err(format!("must be from {range}")) }
}

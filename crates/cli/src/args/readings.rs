//! The noise of readings.

use magsplice::magnet::MAX_SENSOR_ERROR_T;
use magsplice::prelude::DVec3;
use magsplice::sensor::Noise;

use super::numbers::flux_density_t;

pub(crate) fn noise(text: &str) -> Result<Noise, String> {
    let parts: Vec<&str> = text.split(',').collect();
    let axes = match parts[..] {
        [all] => [all; 3],
        [x, y, z] => [x, y, z],
        _ => return Err("must be one flux density, or one for each of x, y, z, such as 5uT,5uT,8uT".to_owned()),
    };
    let mut deviation_t = DVec3::ZERO;
    for (axis, text) in axes.into_iter().enumerate() {
        let value = flux_density_t(text)?;
        if !(value > 0.0 && value <= MAX_SENSOR_ERROR_T) {
            // A number without a unit was probably meant in microtesla, as in layouts.
            let meant = if value > 0.0 && text.trim().parse::<f64>().is_ok() { text.trim() } else { "5" };
            return Err(format!("{value} T, must be above 0 and at most {MAX_SENSOR_ERROR_T} T, such as {meant}uT"));
        }
        deviation_t[axis] = value;
    }
    Ok(Noise { deviation_t })
}

//! Readings that a fit does not use.

use glam::DVec3;
use magsplice_magnet::HallSensor;

/// The reason why a fit does not use a reading.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Exclusion {
    /// A component is missing: it is not a finite number.
    Incomplete,
    /// A component is at the limit of the sensor's range.
    Saturated,
    /// The reading contradicts the fit of the others.
    Outlier,
}

impl Exclusion {
    /// The reading cannot be used with any parameters.
    pub fn of_reading(sensor: &HallSensor, reading_t: DVec3) -> Option<Exclusion> {
        match reading_t {
            incomplete if !incomplete.is_finite() => Some(Exclusion::Incomplete),
            saturated if sensor.is_saturated(saturated) => Some(Exclusion::Saturated),
            _ => None,
        }
    }
}

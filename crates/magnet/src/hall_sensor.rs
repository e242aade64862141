//! A three-axis Hall sensor and its readings.

use std::error::Error;
use std::fmt;
use std::ops::RangeInclusive;

use glam::{DQuat, DVec3};

use crate::tolerances::{MAX_LENGTH, UNIT_NORM_TOLERANCE};

/// Magnitudes of the gain of a sensor: the reading is as finite as the field.
pub const GAIN_MAGNITUDES: RangeInclusive<f64> = 1e-6..=1e6;

/// Largest noise, count and offset of a sensor: a sensor with larger ones cannot detect any
/// permanent magnet.
pub const MAX_SENSOR_ERROR_T: f64 = 1.0;

/// A three-axis Hall sensor. One plate per axis reads the component of B along this axis, averaged
/// over the plate. The default sensor is perfect: plates are points, without errors or limits.
///
/// At the position p of the sensor, the plate of axis a reads
///
/// ```text
/// gain_a e_a . R^-1 mean of B(p + R (plate_a + s)) + offset_a
/// ```
///
/// with the rotation R of the sensor, and the mean over all s of the active area. Readings have
/// noise, are rounded to whole counts, and are limited to the range.
///
/// # Units
/// Lengths in the unit of the tiles, flux densities in tesla.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct HallSensor {
    /// Centres of the plates that read x, y, z, in the frame of the sensor.
    pub plates: [DVec3; 3],
    /// Sides of the rectangle that each plate averages over, along x and y of the sensor; 0 for a
    /// point.
    pub active_area: [f64; 2],
    /// Rotation from the axes of the sensor to the axes of the film. A unit quaternion.
    pub rotation: DQuat,
    /// Reading over flux density, for each axis.
    pub gain: DVec3,
    /// Reading without a field.
    pub offset_t: DVec3,
    /// Standard deviation of normal noise of one reading.
    pub noise_t: DVec3,
    /// Flux density of one count; 0 for unrounded readings.
    pub count_t: DVec3,
    /// Largest magnitude of a reading; infinite without a limit.
    pub range_t: DVec3,
}

impl Default for HallSensor {
    fn default() -> HallSensor {
        HallSensor {
            plates: [DVec3::ZERO; 3],
            active_area: [0.0; 2],
            rotation: DQuat::IDENTITY,
            gain: DVec3::ONE,
            offset_t: DVec3::ZERO,
            noise_t: DVec3::ZERO,
            count_t: DVec3::ZERO,
            range_t: DVec3::INFINITY,
        }
    }
}

/// A rule that a sensor breaks.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum HallSensorFault {
    /// A coordinate of a plate is not finite or beyond [`MAX_LENGTH`].
    Plate,
    /// A side of the active area is negative, not finite, or longer than [`MAX_LENGTH`].
    ActiveArea,
    /// The rotation is not a unit quaternion.
    Rotation,
    /// The magnitude of a gain is not one of [`GAIN_MAGNITUDES`].
    Gain,
    /// The magnitude of an offset is not finite or larger than [`MAX_SENSOR_ERROR_T`].
    Offset,
    /// A noise is negative, not finite, or larger than [`MAX_SENSOR_ERROR_T`].
    Noise,
    /// A count is negative, not finite, or larger than [`MAX_SENSOR_ERROR_T`].
    Count,
    /// A range is not greater than 0.
    Range,
}

impl HallSensor {
    /// The sensor, if it obeys the rules.
    ///
    /// # Errors
    /// The first broken rule.
    pub fn checked(self) -> Result<HallSensor, HallSensorFault> {
        let is_error = |magnitudes: DVec3| {
            magnitudes.cmpge(DVec3::ZERO).all() && magnitudes.cmple(DVec3::splat(MAX_SENSOR_ERROR_T)).all()
        };
        let is_length = |length: f64| (0.0..=MAX_LENGTH).contains(&length);
        let rules = [
            (self.plates.iter().all(|plate| plate.abs().cmple(DVec3::splat(MAX_LENGTH)).all()), HallSensorFault::Plate),
            (self.active_area.into_iter().all(is_length), HallSensorFault::ActiveArea),
            ((self.rotation.length() - 1.0).abs() <= UNIT_NORM_TOLERANCE, HallSensorFault::Rotation),
            (self.gain.abs().to_array().iter().all(|gain| GAIN_MAGNITUDES.contains(gain)), HallSensorFault::Gain),
            (is_error(self.offset_t.abs()), HallSensorFault::Offset),
            (is_error(self.noise_t), HallSensorFault::Noise),
            (is_error(self.count_t), HallSensorFault::Count),
            (self.range_t.cmpgt(DVec3::ZERO).all(), HallSensorFault::Range),
        ];
        rules.into_iter().find(|(is_kept, _)| !is_kept).map_or(Ok(self), |(_, fault)| Err(fault))
    }

    /// Standard deviation of a reading of each axis, from noise and from rounding to counts, whose
    /// error is uniform over one count.
    pub fn deviation_t(&self) -> DVec3 {
        (self.noise_t * self.noise_t + self.count_t * self.count_t / 12.0).map(f64::sqrt)
    }

    /// A reading rounded to counts and limited to the range.
    pub fn digitized_t(&self, reading_t: DVec3) -> DVec3 {
        let rounded = DVec3::from([0, 1, 2].map(|axis| {
            let (reading, count) = (reading_t[axis], self.count_t[axis]);
            if count > 0.0 { (reading / count).round() * count } else { reading }
        }));
        rounded.clamp(-self.range_t, self.range_t)
    }

    /// Whether a reading is at the limit of the range along any axis, to within one count.
    pub fn is_saturated(&self, reading_t: DVec3) -> bool {
        // Readings converted from another unit have the round-off of the conversion.
        let limit = self.range_t * (1.0 - 1e-12) - self.count_t;
        reading_t.abs().cmpge(limit).any()
    }
}

impl fmt::Display for HallSensorFault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            HallSensorFault::Plate => "the plates of a sensor must have finite positions",
            HallSensorFault::ActiveArea => "the sides of an active area must be finite and at least 0",
            HallSensorFault::Rotation => "the rotation of a sensor must be a unit quaternion",
            HallSensorFault::Gain => {
                "the gains of a sensor must be from 1e-6 to 1e6, or negative ones from -1e6 to -1e-6"
            }
            HallSensorFault::Offset => "the offsets of a sensor must be at most 1 T in magnitude",
            HallSensorFault::Noise => "the noise of a sensor must be from 0 to 1 T",
            HallSensorFault::Count => "the counts of a sensor must be from 0 to 1 T",
            HallSensorFault::Range => "the ranges of a sensor must be greater than 0",
        })
    }
}

impl Error for HallSensorFault {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_are_whole_counts_within_the_range() {
        let sensor =
            HallSensor { count_t: DVec3::new(1e-6, 2e-6, 0.0), range_t: DVec3::splat(1e-3), ..HallSensor::default() };
        let read = sensor.digitized_t(DVec3::new(3.4e-6, -5.1e-6, 2.0e-3));
        assert!((read - DVec3::new(3e-6, -6e-6, 1e-3)).abs().max_element() < 1e-20, "{read}");
        assert!(sensor.is_saturated(read));
        assert!(!sensor.is_saturated(DVec3::new(9.9e-4, 0.0, 0.0)));
        assert!(sensor.is_saturated(DVec3::new(0.0, -9.99e-4, 0.0)));
        // sqrt(3^2 + 12^2 / 12) = sqrt(21)
        let noisy = HallSensor { noise_t: DVec3::splat(3.0), count_t: DVec3::splat(12.0), ..sensor };
        assert!((noisy.deviation_t() - DVec3::splat(21_f64.sqrt())).length() < 1e-15);
    }

    #[test]
    fn each_rule_is_checked() {
        let perfect = HallSensor::default();
        assert_eq!(perfect.checked(), Ok(perfect));
        let nan = DVec3::new(0.0, f64::NAN, 0.0);
        for (sensor, fault) in [
            (HallSensor { plates: [DVec3::ZERO, nan, DVec3::ZERO], ..perfect }, HallSensorFault::Plate),
            (HallSensor { active_area: [0.1, -0.1], ..perfect }, HallSensorFault::ActiveArea),
            (HallSensor { rotation: DQuat::from_xyzw(0.0, 0.0, 0.1, 1.0), ..perfect }, HallSensorFault::Rotation),
            (HallSensor { gain: DVec3::new(1.0, 0.0, 1.0), ..perfect }, HallSensorFault::Gain),
            (HallSensor { offset_t: DVec3::INFINITY, ..perfect }, HallSensorFault::Offset),
            (HallSensor { noise_t: -DVec3::X, ..perfect }, HallSensorFault::Noise),
            (HallSensor { noise_t: DVec3::splat(1.1), ..perfect }, HallSensorFault::Noise),
            (HallSensor { count_t: nan, ..perfect }, HallSensorFault::Count),
            (HallSensor { count_t: DVec3::splat(1.1), ..perfect }, HallSensorFault::Count),
            (HallSensor { offset_t: DVec3::splat(-1.1), ..perfect }, HallSensorFault::Offset),
            (HallSensor { range_t: DVec3::ZERO, ..perfect }, HallSensorFault::Range),
        ] {
            assert_eq!(sensor.checked(), Err(fault));
        }
    }
}

//! Sensors with places and weights.

use glam::{DMat3, DVec3};
use magsplice_magnet::HallSensor;

use crate::form::HeadForm;

/// A Hall sensor of a head.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct HeadElement {
    /// The sensor.
    pub sensor: HallSensor,
    /// Its place on the board. The board has the axes of the film.
    pub place: DVec3,
    /// The factor of its reading in the sum, for each axis.
    pub weight: DVec3,
}

/// Hall sensors on one rigid board. The head reads the sum of their corrected readings, each times
/// its weight. Its position is that of the origin of the board.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SensorHead {
    /// The sensors, at least one.
    pub elements: Vec<HeadElement>,
}

impl From<HallSensor> for SensorHead {
    /// One sensor at the origin of the board.
    fn from(sensor: HallSensor) -> SensorHead {
        SensorHead { elements: vec![HeadElement { sensor, place: DVec3::ZERO, weight: DVec3::ONE }] }
    }
}

impl SensorHead {
    /// The response to an ideal film with this wavenumber, and to stray fields.
    pub fn form(&self, wavenumber: f64) -> HeadForm {
        let (places, weights): (Vec<DVec3>, Vec<DVec3>) = self.elements.iter().map(|of| (of.place, of.weight)).unzip();
        HeadForm::new(&places, &weights, wavenumber)
    }

    /// The weighted sum of a field at the places of the sensors, of a head at a position.
    ///
    /// # Errors
    /// The first error of the field at a place.
    pub fn seen<E>(&self, position: DVec3, field: impl Fn(DVec3) -> Result<DVec3, E>) -> Result<DVec3, E> {
        self.elements.iter().try_fold(DVec3::ZERO, |sum, of| Ok(sum + of.weight * field(position + of.place)?))
    }

    /// Standard deviation of the weighted sum of one corrected reading of each sensor, along each
    /// axis of the film.
    pub fn deviation_t(&self) -> DVec3 {
        let variance = |of: &HeadElement| -> DVec3 {
            let own_t = of.sensor.deviation_t() / of.sensor.gain;
            let axes = DMat3::from_quat(of.sensor.rotation);
            let squared = DMat3::from_cols_array(&axes.to_cols_array().map(|element| element * element));
            of.weight * of.weight * (squared * (own_t * own_t))
        };
        self.elements.iter().map(variance).sum::<DVec3>().map(f64::sqrt)
    }

    /// The head with this noise of the readings of every sensor.
    pub fn with_noise(mut self, noise_t: DVec3) -> SensorHead {
        self.elements.iter_mut().for_each(|of| of.sensor.noise_t = noise_t);
        self
    }

    /// The sensor that reads the weighted sum: without errors but for the noise of the sum, and
    /// without the limits of the sensors.
    pub fn as_one(&self) -> HallSensor {
        HallSensor { noise_t: self.deviation_t(), ..HallSensor::default() }
    }

    /// The weighted sum of one reading of each sensor, in their order, along the axes of the film
    /// and without the offsets, gains and rotations of the sensors.
    ///
    /// # Panics
    /// If there are not as many readings as sensors.
    pub fn sum_t(&self, readings_t: &[DVec3]) -> DVec3 {
        assert_eq!(readings_t.len(), self.elements.len(), "one reading of each sensor");
        let corrected_t = |of: &HallSensor, reading_t: DVec3| of.rotation * ((reading_t - of.offset_t) / of.gain);
        let terms = self.elements.iter().zip(readings_t);
        terms.map(|(of, reading_t)| of.weight * corrected_t(&of.sensor, *reading_t)).sum()
    }
}

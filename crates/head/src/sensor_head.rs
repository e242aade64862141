//! Sensors with places and weights.

use glam::DVec3;
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

/// Hall sensors on one rigid board. The head reads the sum of their readings, each times its
/// weight. Its position is that of the origin of the board.
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

    /// Standard deviation of the weighted sum of one reading of each sensor, along each axis.
    pub fn deviation_t(&self) -> DVec3 {
        let squares = self.elements.iter().map(|of| {
            let deviation_t = of.weight * of.sensor.deviation_t();
            deviation_t * deviation_t
        });
        squares.sum::<DVec3>().map(f64::sqrt)
    }

    /// The weighted sum of one reading of each sensor, in their order.
    ///
    /// # Panics
    /// If there are not as many readings as sensors.
    pub fn sum_t(&self, readings_t: &[DVec3]) -> DVec3 {
        assert_eq!(readings_t.len(), self.elements.len(), "one reading of each sensor");
        self.elements.iter().zip(readings_t).map(|(of, reading_t)| of.weight * *reading_t).sum()
    }
}

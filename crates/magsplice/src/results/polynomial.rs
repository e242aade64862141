//! The displacement of a sensor from its reading, as a polynomial for firmware.

use glam::{DMat3, DVec3};
use magsplice_layout::WorkingVolume;
use magsplice_magnet::HallSensor;
use magsplice_sensor::{DisplacementPolynomial, PolynomialError};

use crate::film::Film;
use crate::film_error::FilmError;

/// The displacement of the sensor of a film as a polynomial of R_x, R_y and S_z, in millimetres.
#[derive(Clone, Debug)]
pub struct SensorPolynomial {
    /// The polynomial.
    pub polynomial: DisplacementPolynomial,
    /// The volume in which it holds.
    pub volume: WorkingVolume,
    /// Takes readings without their offset to flux densities along the axes of the film.
    pub field_of_reading: DMat3,
    /// Offset of the readings.
    pub offset_t: DVec3,
}

impl Film {
    /// The displacement in the working volume as a polynomial with this error.
    ///
    /// # Errors
    /// [`FilmError::Missing`] without a working volume; [`FilmError::Sensor`] if the sensor cannot
    /// read the field; [`FilmError::Polynomial`] if there is no such polynomial.
    pub fn displacement_polynomial(&self, error_mm: f64) -> Result<SensorPolynomial, FilmError> {
        let volume = *self.volume()?;
        let sensed = self.sensed_field(&volume.grid)?;
        let found = DisplacementPolynomial::fit(sensed, &volume.grid, volume.reference_mm, error_mm);
        let polynomial = found.map_err(|error| match error {
            PolynomialError::Points(errors) => FilmError::Points(errors),
            error => FilmError::Polynomial(error),
        })?;
        let sensor = self.layout().sensor.as_ref().map_or_else(HallSensor::default, |sensor| sensor.as_one());
        let field_of_reading = DMat3::from_quat(sensor.rotation) * DMat3::from_diagonal(DVec3::ONE / sensor.gain);
        Ok(SensorPolynomial { polynomial, volume, field_of_reading, offset_t: sensor.offset_t })
    }
}

//! What a sensor reads of a film as made.

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_magnet::{Grid, HallSensor, PointError, PointErrorCause, PointErrors, is_in_range};
use magsplice_sensor::{SensedField, SensedFieldError};
use magsplice_tolerance::FilmSample;
use thiserror::Error;

use crate::parameters::ScanParameters;

/// A computed scan of a film as made.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleScan {
    /// The readings of the sensor in tesla: with noise, rounded to counts, and limited to its
    /// range.
    pub readings_t: Vec<DVec3>,
    /// The parameters that [`fit_scan`](crate::fit_scan) fits, with the film as made and the sensor
    /// as ordered. If the film is turned, the start is that of the middle of the scan.
    pub parameters: ScanParameters,
}

/// Why a film as made cannot be scanned.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SampleScanError {
    /// The film has no field at points. Indices of tiles are those of the film.
    #[error("{0}")]
    Points(#[source] PointErrors),
    /// The neighbour, or the images in iron, have no field at points.
    #[error("the neighbour: {0}")]
    Beside(#[source] PointErrors),
    /// The sensor cannot read the field.
    #[error("{0}")]
    Sensor(#[source] SensedFieldError),
}

impl SampleScan {
    /// The scan of a sample by a sensor at points in millimetres. `sensor` is the sensor as
    /// ordered, to which the errors of the sample are added.
    ///
    /// # Errors
    /// See [`SampleScanError`].
    pub fn new(sample: &FilmSample, sensor: &HallSensor, points_mm: &[DVec3]) -> Result<SampleScan, SampleScanError> {
        let far = points_mm.iter().enumerate().filter(|(_, point)| !is_in_range(**point));
        let far: Vec<PointError> =
            far.map(|(index, point)| PointError { index, point: *point, cause: PointErrorCause::OutOfRange }).collect();
        if !far.is_empty() {
            return Err(SampleScanError::Points(PointErrors(far)));
        }
        sample.check_before_iron(points_mm).map_err(SampleScanError::Points)?;
        let real = sample.sensor(sensor);
        let turned = sample.rotation().inverse() * real.rotation;
        let in_film: Vec<DVec3> = points_mm.iter().map(|point| sample.point_of_film(*point)).collect();
        let mut readings_t = vec![real.rotation.inverse() * sample.stray_field_t(); points_mm.len()];
        for part in sample.film() {
            let read = HallSensor { rotation: turned.normalize(), ..real };
            let part_t = read_t(part, read, &in_film, SampleScanError::Points)?;
            readings_t.iter_mut().zip(part_t).for_each(|(sum_t, b_t)| *sum_t += sample.strength() * b_t);
        }
        if let Some(beside) = sample.beside() {
            let beside_mm: Vec<DVec3> = points_mm.iter().map(|point| sample.point_beside(*point)).collect();
            let beside_t = read_t(beside, real, &beside_mm, SampleScanError::Beside)?;
            readings_t.iter_mut().zip(beside_t).for_each(|(sum_t, b_t)| *sum_t += b_t);
        }
        let noise_t = sample.noise_t(points_mm.len(), &real);
        for (reading_t, noise_t) in readings_t.iter_mut().zip(noise_t) {
            *reading_t = real.digitized_t(real.gain * *reading_t + real.offset_t + noise_t);
        }
        Ok(SampleScan { readings_t, parameters: parameters(sample, sensor, &real, points_mm) })
    }
}

/// The readings of a sensor without gain and offset.
fn read_t(
    scene: &Scene,
    sensor: HallSensor,
    points_mm: &[DVec3],
    failed: impl Fn(PointErrors) -> SampleScanError,
) -> Result<Vec<DVec3>, SampleScanError> {
    let sensed = SensedField::new(scene, sensor, &Grid::around(points_mm)).map_err(SampleScanError::Sensor)?;
    sensed.without_gain_and_offset().readings_t(points_mm).map_err(failed)
}

/// The parameters of the scan for a sensor that counts as ordered.
fn parameters(sample: &FilmSample, ordered: &HallSensor, real: &HallSensor, points_mm: &[DVec3]) -> ScanParameters {
    let stray_t = real.gain * (real.rotation.inverse() * sample.stray_field_t());
    let turn = ordered.rotation.inverse() * sample.rotation().inverse() * real.rotation;
    let around = Grid::around(points_mm);
    let middle = 0.5 * (around.lower() + around.upper());
    ScanParameters {
        strength: sample.strength(),
        offset_t: (stray_t + real.offset_t - ordered.offset_t) / ordered.gain,
        rotation_rad: turn.normalize().to_scaled_axis(),
        start: sample.point_of_film(middle) - middle,
    }
}

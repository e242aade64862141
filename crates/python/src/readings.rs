//! Positions and forces from readings of a sensor.

use glam::DVec3;
use magsplice::FilmError;
use magsplice::decouple::{Branch, Parameters};
use magsplice::sensor::{LocateError, Located, Locator, Noise};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::exceptions::{of_film, of_points};
use crate::film::Film;
use crate::vectors::{rows_of, vectors};

/// Number of readings between two polls for signals.
const STRETCH_READINGS: usize = 1 << 12;

/// What was found from readings, with the fields of the Python class. NaN where a reading has no value.
#[derive(IntoPyObject)]
pub(crate) struct ReadingNumbers<'py> {
    displacement_mm: Bound<'py, PyArray2<f64>>,
    deviation_mm: Option<Bound<'py, PyArray2<f64>>>,
    force_n: Option<Bound<'py, PyArray2<f64>>>,
    closed_form_mm: Option<Bound<'py, PyArray2<f64>>>,
    /// 0: in the volume; 1: outside; 2: ambiguous; 3: none; 4: saturated.
    status: Bound<'py, PyArray1<u8>>,
    /// Why a reading has no position in the volume; empty where it has one.
    messages: Vec<String>,
}

/// The displacement of the sensor from the reference point for each reading, in millimetres.
#[pyfunction]
#[pyo3(signature = (film, readings_t, noise_t=None, constant_t=[0.0; 3]))]
pub(crate) fn read<'py>(
    py: Python<'py>,
    film: &Film,
    readings_t: PyReadonlyArray2<'py, f64>,
    noise_t: Option<[f64; 3]>,
    constant_t: [f64; 3],
) -> PyResult<ReadingNumbers<'py>> {
    let readings_t = vectors(&readings_t)?;
    let constant_t = DVec3::from(constant_t);
    let film = film.evaluated(py)?;
    let volume = *film.volume().map_err(of_film)?;
    let (sensed, at_reference_t, locator) = py
        .detach(|| {
            let sensed = film.sensed_field(&volume.grid)?;
            let at_reference_t = sensed.readings_t(&[volume.reference_mm]).map_err(FilmError::Points)?[0];
            let locator = Locator::new(sensed.clone(), volume.grid).map_err(FilmError::Points)?;
            Ok((sensed, at_reference_t, locator.with_constant_reading(constant_t)))
        })
        .map_err(of_film)?;
    let mut found = Vec::new();
    for readings_t in readings_t.chunks(STRETCH_READINGS) {
        found.extend(py.detach(|| locator.locate(readings_t)));
        py.check_signals()?;
    }
    let noise = noise_t.map(|d| Noise { deviation_t: d.into() }).or(Noise::of_sensor(sensed.sensor()));
    let closed_form_mm = film.ideal().ok().map(|ideal| {
        let parameters = |reading_t: DVec3| {
            let branch = Branch::from_axis_field(sensed.field_of_reading_t(at_reference_t))?;
            Parameters::from_field(sensed.field_of_reading_t(reading_t), branch)
        };
        let before = parameters(at_reference_t);
        let of = |reading_t: &DVec3| {
            Some(parameters(*reading_t - constant_t)?.displacement_from(&before?, ideal.wavenumber()))
        };
        readings_t.iter().map(|reading| of(reading).unwrap_or(DVec3::NAN)).collect::<Vec<DVec3>>()
    });
    let located = |found: &Result<Located, LocateError>| match found {
        Ok(located) | Err(LocateError::Outside(located)) => Some(*located),
        Err(_) => None,
    };
    let of_each = |value: &dyn Fn(Located) -> Option<DVec3>| {
        let values = found.iter().map(|f| located(f).and_then(value).unwrap_or(DVec3::NAN));
        rows_of(py, &values.collect::<Vec<DVec3>>())
    };
    let layer = film.layout().elastomer;
    Ok(ReadingNumbers {
        displacement_mm: of_each(&|located| Some(located.position - volume.reference_mm)),
        deviation_mm: noise.map(|noise| of_each(&|located| noise.of_position(located.gradient))),
        // The film moves by the opposite of the sensor's displacement.
        force_n: layer.map(|l| of_each(&|located| Some(l.force_n(volume.reference_mm - located.position)))),
        closed_form_mm: closed_form_mm.map(|values| rows_of(py, &values)),
        status: PyArray1::from_vec(py, found.iter().map(status).collect()),
        messages: found.iter().map(|f| f.as_ref().err().map_or(String::new(), ToString::to_string)).collect(),
    })
}

fn status(found: &Result<Located, LocateError>) -> u8 {
    match found {
        Ok(_) => 0,
        Err(LocateError::Outside(_)) => 1,
        Err(LocateError::Ambiguous(..)) => 2,
        Err(LocateError::Saturated) => 4,
        Err(_) => 3,
    }
}

/// Standard deviations of the position that one reading gives, at points, in millimetres; infinite where a
/// displacement leaves the reading unchanged. None without noise.
#[pyfunction]
#[pyo3(signature = (film, points, noise_t=None))]
pub(crate) fn resolution<'py>(
    py: Python<'py>,
    film: &Film,
    points: PyReadonlyArray2<'py, f64>,
    noise_t: Option<[f64; 3]>,
) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
    let points = vectors(&points)?;
    let film = film.evaluated(py)?;
    let found = py.detach(|| {
        let volume = film.volume().map_err(of_film)?;
        let sensed = film.sensed_field(&volume.grid).map_err(of_film)?;
        let Some(noise) = noise_t.map(|d| Noise { deviation_t: d.into() }).or(Noise::of_sensor(sensed.sensor())) else {
            return Ok(None);
        };
        let gradients = sensed.gradients(points).map_err(|errors| of_points(&errors))?;
        let of = |gradient| noise.of_position(gradient).unwrap_or(DVec3::INFINITY);
        Ok::<_, PyErr>(Some(gradients.into_iter().map(of).collect::<Vec<DVec3>>()))
    })?;
    Ok(found.map(|found| rows_of(py, &found)))
}

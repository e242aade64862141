//! Positions and forces from readings of a sensor.

use glam::DVec3;
use magsplice::AtRest;
use magsplice::sensor::{LocateError, Located, Noise};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::exceptions::{of_film, of_points};
use crate::film::Film;
use crate::vectors::{rows_of, vectors};

/// Number of readings between two polls for signals.
const STRETCH_READINGS: usize = 1 << 12;

/// What was found from readings, with the fields of the Python class. NaN where a reading has no
/// value.
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

/// The displacement of the sensor for each reading, in millimetres: from the reference point, or
/// from where it had the readings `rest`. What the mean of the readings `zero` has beyond the field
/// of the reference point is in all readings, else `constant_t` is.
#[pyfunction]
#[pyo3(signature = (film, readings_t, noise_t=None, constant_t=[0.0; 3], zero_t=None, rest_t=None))]
pub(crate) fn read<'py>(
    py: Python<'py>,
    film: &Film,
    readings_t: PyReadonlyArray2<'py, f64>,
    noise_t: Option<[f64; 3]>,
    constant_t: [f64; 3],
    zero_t: Option<PyReadonlyArray2<'py, f64>>,
    rest_t: Option<PyReadonlyArray2<'py, f64>>,
) -> PyResult<ReadingNumbers<'py>> {
    let readings_t = vectors(&readings_t)?;
    let at_rest = match (zero_t.as_ref().map(vectors).transpose()?, rest_t.as_ref().map(vectors).transpose()?) {
        (_, Some(rest_t)) => AtRest::Rest(rest_t),
        (Some(zero_t), None) => AtRest::Zero(zero_t),
        (None, None) => AtRest::Constant(constant_t.into()),
    };
    let film = film.evaluated(py)?;
    let reader = py.detach(|| film.reader(at_rest, noise_t.map(noise_of))).map_err(of_film)?;
    let mut found = Vec::new();
    for readings_t in readings_t.chunks(STRETCH_READINGS) {
        found.extend(py.detach(|| reader.locate(readings_t)));
        py.check_signals()?;
    }
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
        displacement_mm: of_each(&|located| Some(located.position - reader.origin_mm)),
        deviation_mm: reader.noise.map(|noise| of_each(&|located| noise.of_position(located.gradient))),
        // The film moves by the opposite of the sensor's displacement.
        force_n: layer.map(|l| of_each(&|located| Some(l.force_n(reader.origin_mm - located.position)))),
        closed_form_mm: reader.closed_form_mm(readings_t).map(|values| rows_of(py, &values)),
        status: PyArray1::from_vec(py, found.iter().map(status).collect()),
        messages: found.iter().map(|f| f.as_ref().err().map_or(String::new(), ToString::to_string)).collect(),
    })
}

fn noise_of(deviation_t: [f64; 3]) -> Noise {
    Noise { deviation_t: deviation_t.into() }
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

/// Standard deviations of the position that one reading gives, at points, in millimetres; infinite
/// where a displacement leaves the reading unchanged. None without noise.
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
        let Some(noise) = noise_t.map(noise_of).or(Noise::of_sensor(sensed.sensor())) else {
            return Ok(None);
        };
        let gradients = sensed.gradients(points).map_err(|errors| of_points(&errors))?;
        let of = |gradient| noise.of_position(gradient).unwrap_or(DVec3::INFINITY);
        Ok::<_, PyErr>(Some(gradients.into_iter().map(of).collect::<Vec<DVec3>>()))
    })?;
    Ok(found.map(|found| rows_of(py, &found)))
}

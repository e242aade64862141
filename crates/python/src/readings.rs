//! Positions and forces from readings of a sensor.

use glam::DVec3;
use magsplice::FilmError;
use magsplice::results::AtRest;
use magsplice::sensor::{LocateError, Located, Noise};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

use crate::film::Film;
use crate::results::{WithArrays, with_arrays};
use crate::vectors::{rows_of, vectors};

/// The displacement of the sensor for each reading, in millimetres, from the reference point or
/// from the position of the readings `rest`. The constant part of all readings is `constant_t`, or
/// the difference of the mean of the readings `zero` from the field at the reference point.
#[pyfunction]
pub(crate) fn read<'py>(
    py: Python<'py>,
    film: &Film,
    readings_t: PyReadonlyArray2<'py, f64>,
    noise_t: Option<[f64; 3]>,
    constant_t: [f64; 3],
    zero_t: Option<PyReadonlyArray2<'py, f64>>,
    rest_t: Option<PyReadonlyArray2<'py, f64>>,
) -> PyResult<WithArrays<'py>> {
    let readings_t = vectors(&readings_t)?;
    let at_rest = match (zero_t.as_ref().map(vectors).transpose()?, rest_t.as_ref().map(vectors).transpose()?) {
        (_, Some(rest_t)) => AtRest::Rest(rest_t),
        (Some(zero_t), None) => AtRest::Zero(zero_t),
        (None, None) => AtRest::Constant(constant_t.into()),
    };
    let noise = noise_t.map(noise_of);
    let read = film.run(py, |film| film.read(readings_t, at_rest, noise))?;
    let rows = |vectors: Option<Vec<DVec3>>| vectors.map(|vectors| rows_of(py, &vectors)).into_bound_py_any(py);
    let message =
        |found: &Result<Located, LocateError>| found.as_ref().err().map_or(String::new(), ToString::to_string);
    let messages: Vec<String> = read.found.iter().map(message).collect();
    let more = [
        ("displacement_mm", rows(Some(read.displacement_mm()))?),
        ("deviation_mm", rows(read.deviation_mm())?),
        ("force_n", rows(read.force_n())?),
        ("closed_form_mm", rows(read.closed_form_mm.clone())?),
        ("status", PyArray1::from_iter(py, read.status()).into_any()),
        ("messages", messages.into_bound_py_any(py)?),
    ];
    with_arrays(py, &read, more)
}

fn noise_of(deviation_t: [f64; 3]) -> Noise {
    Noise { deviation_t: deviation_t.into() }
}

/// Standard deviations of the position from one reading, at points, in millimetres; infinite where
/// a displacement does not change the reading, or the reading is at the limit of the sensor's
/// range. None without noise.
#[pyfunction]
pub(crate) fn resolution<'py>(
    py: Python<'py>,
    film: &Film,
    points: PyReadonlyArray2<'py, f64>,
    noise_t: Option<[f64; 3]>,
) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
    let points = vectors(&points)?;
    let noise = noise_t.map(noise_of);
    let found = film.run(py, |film| match film.resolution_at(points, noise) {
        Ok(found) => Ok(Some(found.by_field_mm)),
        Err(FilmError::NoNoise) => Ok(None),
        Err(error) => Err(error),
    })?;
    Ok(found.map(|deviations_mm| rows_of(py, &deviations_mm)))
}

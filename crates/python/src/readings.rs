//! Positions and forces from readings of a sensor, and the stiffness of its elastic layer.

use glam::DVec3;
use magsplice::FilmError;
use magsplice::results::{AtRest, ColumnQuantity, FilmReadings, HeadFits};
use magsplice::sensor::{HeadUnknowns, LocateError, Located, Noise};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

use crate::exceptions::{of_film, one_of};
use crate::film::Film;
use crate::results::{WithArrays, with_arrays};
use crate::vectors::{rows_of, vectors};

/// The displacement of the sensor for each reading, in millimetres, from the reference point or
/// from the position of the readings `rest`, the second of `at_rest`. The constant part of all
/// readings is `constant_t`, or the difference of the mean of the first, `zero`, from the field at
/// the reference point. `fit` is what is fitted to the readings of all sensors of a head, and the
/// number of readings for each position; without it, readings are those of one sensor or weighted
/// sums. And remarks.
#[pyfunction]
pub(crate) fn read<'py>(
    py: Python<'py>,
    film: &Film,
    readings_t: PyReadonlyArray2<'py, f64>,
    noise_t: Option<[f64; 3]>,
    constant_t: [f64; 3],
    at_rest: [Option<PyReadonlyArray2<'py, f64>>; 2],
    fit: Option<(String, usize)>,
) -> PyResult<(WithArrays<'py>, Vec<String>)> {
    let unknowns = match &fit {
        Some((fit, given)) => {
            let sensors =
                film.layout.sensor.as_ref().and_then(|of| of.head.as_ref()).map(|of| of.sensors.elements.len());
            if let Some(sensors) = sensors.filter(|sensors| sensors != given) {
                return Err(of_film(FilmError::SensorReadings { sensors, given: *given }));
            }
            Some(one_of("fit", fit, "position, stray-field or pose")?)
        }
        None => None,
    };
    let read = located(py, film, &readings_t, noise_t, constant_t, at_rest, unknowns)?;
    let rows = |vectors: Option<Vec<DVec3>>| vectors.map(|vectors| rows_of(py, &vectors)).into_bound_py_any(py);
    let message =
        |found: &Result<Located, LocateError>| found.as_ref().err().map_or(String::new(), ToString::to_string);
    let messages: Vec<String> = read.found.iter().map(message).collect();
    let columns = read.of_head.as_ref().map(HeadFits::columns).unwrap_or_default();
    let of_head = |name: &str| -> PyResult<Bound<'py, PyAny>> {
        let Some(ColumnQuantity { components, values, .. }) = columns.iter().find(|of| of.name == name) else {
            return Ok(py.None().into_bound(py));
        };
        let array = values.clone().into_pyarray(py);
        match components.len() {
            1 => Ok(array.into_any()),
            width => Ok(array.reshape([values.len() / width, width])?.into_any()),
        }
    };
    let more = [
        ("displacement_mm", rows(Some(read.displacement_mm()))?),
        ("deviation_mm", rows(read.deviation_mm())?),
        ("force_n", rows(read.force_n())?),
        ("closed_form_mm", rows(read.closed_form_mm.clone())?),
        ("status", PyArray1::from_iter(py, read.status()).into_any()),
        ("messages", messages.into_bound_py_any(py)?),
        ("stray_t", of_head("stray_t")?),
        ("stray_deviation_t", of_head("stray_deviation_t")?),
        ("rotation_deg", of_head("rotation_deg")?),
        ("rotation_deviation_deg", of_head("rotation_deviation_deg")?),
        ("chi_squared_over_freedom", of_head("chi_squared_over_freedom")?),
    ];
    let remarks = read.of_head.iter().flat_map(HeadFits::remarks).chain(read.hint.clone());
    Ok((with_arrays(py, &read, more)?, remarks.collect()))
}

/// Words for readings at the limit of the sensor's range or beyond it, at these points or, without
/// points, anywhere.
#[pyfunction]
pub(crate) fn remark_on_range(
    py: Python<'_>,
    film: &Film,
    points: PyReadonlyArray2<'_, f64>,
    readings_t: PyReadonlyArray2<'_, f64>,
) -> PyResult<Option<String>> {
    let (points, readings_t) = (vectors(&points)?, vectors(&readings_t)?);
    film.run(py, |film| Ok(film.remark_on_range(points, readings_t)))
}

/// The positions of readings. `at_rest` are the readings `zero` and `rest`.
fn located(
    py: Python<'_>,
    film: &Film,
    readings_t: &PyReadonlyArray2<'_, f64>,
    noise_t: Option<[f64; 3]>,
    constant_t: [f64; 3],
    at_rest: [Option<PyReadonlyArray2<'_, f64>>; 2],
    unknowns: Option<HeadUnknowns>,
) -> PyResult<FilmReadings> {
    let readings_t = vectors(readings_t)?;
    let [zero_t, rest_t] = at_rest.each_ref().map(|of| of.as_ref().map(vectors).transpose());
    let at_rest = match (zero_t?, rest_t?) {
        (_, Some(rest_t)) => AtRest::Rest(rest_t),
        (Some(zero_t), None) => AtRest::Zero(zero_t),
        (None, None) => AtRest::Constant(constant_t.into()),
    };
    let noise = noise_t.map(noise_of);
    film.run(py, |film| match unknowns {
        Some(unknowns) => film.read_sensors(readings_t, at_rest, noise, unknowns),
        None => film.read(readings_t, at_rest, noise),
    })
}

/// The stiffness of the elastic layer from forces in newton and readings, the displacements of the
/// film, and remarks. The other arguments are those of [`read`].
#[pyfunction]
pub(crate) fn calibrate<'py>(
    py: Python<'py>,
    film: &Film,
    forces_n: PyReadonlyArray2<'py, f64>,
    readings_t: PyReadonlyArray2<'py, f64>,
    constant_t: [f64; 3],
    zero_t: Option<PyReadonlyArray2<'py, f64>>,
    rest_t: Option<PyReadonlyArray2<'py, f64>>,
) -> PyResult<(WithArrays<'py>, Vec<String>)> {
    let read = located(py, film, &readings_t, None, constant_t, [zero_t, rest_t], None)?;
    let forces_n = vectors(&forces_n)?;
    let indices: Vec<u64> = (0..forces_n.len() as u64).collect();
    let found = read.calibrate(forces_n, &indices).map_err(of_film)?;
    // The film moves in the direction opposite to the sensor.
    let moved_mm = |sensor_mm: &[DVec3]| rows_of(py, &sensor_mm.iter().map(|moved| -*moved).collect::<Vec<DVec3>>());
    let more = [
        ("film_mm", moved_mm(&read.displacement_mm()).into_any()),
        ("closed_form_mm", read.closed_form_mm.as_deref().map(moved_mm).into_bound_py_any(py)?),
    ];
    Ok((with_arrays(py, &found, more)?, found.remarks()))
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

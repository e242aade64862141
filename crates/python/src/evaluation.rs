//! Numbers of a film: comparison with the ideal film, and decoupling.

use magsplice::decouple::Parameters;
use magsplice::prelude::DVec3;
use magsplice::results::FilmComparison;
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::pythonize;

use crate::exceptions::of_film;
use crate::film::Film;
use crate::results::dictionary;
use crate::scene::{Within, accuracy};
use crate::vectors::{rows_of, vectors};

/// The comparison with the ideal film, at points or on the grid of the volume.
#[pyfunction]
#[pyo3(signature = (film, points=None, within=None))]
pub(crate) fn compare<'py>(
    py: Python<'py>,
    film: &Film,
    points: Option<PyReadonlyArray2<'py, f64>>,
    within: Within,
) -> PyResult<Bound<'py, PyAny>> {
    let (points, accuracy) = (points.as_ref().map(vectors).transpose()?, accuracy(within)?);
    let FilmComparison { comparison, .. } = film.run(py, |film| {
        let film = film.with_accuracy(accuracy);
        points.map_or_else(|| film.compare(), |points| film.compare_at(points))
    })?;
    Ok(pythonize(py, &comparison)?)
}

/// The decoupling parameters at points or on the grid of the volume, with B there.
#[pyfunction]
#[pyo3(signature = (film, points=None, within=None))]
pub(crate) fn decouple<'py>(
    py: Python<'py>,
    film: &Film,
    points: Option<PyReadonlyArray2<'py, f64>>,
    within: Within,
) -> PyResult<Bound<'py, PyDict>> {
    let (points, accuracy) = (points.as_ref().map(vectors).transpose()?, accuracy(within)?);
    let (numbers, parameters, field_t) = match points {
        Some(points) => {
            let found = film.run(py, |film| film.with_accuracy(accuracy).decouple_at(points.to_vec()))?;
            let parameters = found.decoupling.parameters.iter().map(vector).collect();
            (dictionary(py, &found)?, parameters, rows_of(py, &found.field_t))
        }
        None => {
            let found = film.run(py, |film| film.with_accuracy(accuracy).decouple())?;
            let field_t = found.film.volume_field_t().map_err(of_film)?;
            let parameters: Vec<DVec3> = found.decoupling.parameters.iter().map(vector).collect();
            (dictionary(py, &found)?, parameters, rows_of(py, field_t))
        }
    };
    numbers.set_item("parameters", rows_of(py, &parameters))?;
    numbers.set_item("field_t", field_t)?;
    numbers.set_item("wavenumber_per_mm", film.layout.ideal.map(|ideal| ideal.wavenumber()))?;
    Ok(numbers)
}

/// R_x, R_y, S_z; NaN where they do not exist.
fn vector(parameters: &Option<Parameters>) -> DVec3 {
    parameters.map_or(DVec3::NAN, |p| DVec3::new(p.r_x, p.r_y, p.s_z))
}

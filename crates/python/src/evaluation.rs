//! Numbers of a film: comparison with the ideal film, and decoupling.

use magsplice::decouple::Parameters;
use magsplice::prelude::DVec3;
use magsplice::results::FilmComparison;
use magsplice::{Film as LibraryFilm, FilmError};
use numpy::PyReadonlyArray2;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;

use crate::exceptions::of_film;
use crate::film::Film;
use crate::results::{WithArrays, dictionary, with_arrays};
use crate::scene::{Within, accuracy};
use crate::vectors::{rows_of, vectors};

/// The comparison with the ideal film, at points or on the grid of the volume.
#[pyfunction]
pub(crate) fn compare<'py>(
    py: Python<'py>,
    film: &Film,
    points: Option<PyReadonlyArray2<'py, f64>>,
    within: Within,
) -> PyResult<Bound<'py, PyDict>> {
    let (points, accuracy) = (points.as_ref().map(vectors).transpose()?, accuracy(within)?);
    let found: FilmComparison = film.run(py, |film| {
        let film = film.with_accuracy(accuracy);
        points.map_or_else(|| film.compare(), |points| film.compare_at(points))
    })?;
    dictionary(py, &found)
}

/// The decoupling parameters at points or on the grid of the volume, with B there.
#[pyfunction]
pub(crate) fn decouple<'py>(
    py: Python<'py>,
    film: &Film,
    points: Option<PyReadonlyArray2<'py, f64>>,
    within: Within,
) -> PyResult<WithArrays<'py>> {
    let (points, accuracy) = (points.as_ref().map(vectors).transpose()?, accuracy(within)?);
    let evaluated = |film: LibraryFilm| film.with_accuracy(accuracy);
    match points {
        Some(points) => {
            let found = film.run(py, |film| evaluated(film).decouple_at(points.to_vec()))?;
            let (parameters, reference) = (&found.decoupling.parameters, &found.decoupling.at_reference);
            decoupled(py, film, &found, &found.field_t, parameters, reference)
        }
        None => {
            let found = film.run(py, |film| evaluated(film).decouple())?;
            let (parameters, reference) = (&found.decoupling.parameters, &found.decoupling.at_reference);
            decoupled(py, film, &found, found.film.volume_field_t().map_err(of_film)?, parameters, reference)
        }
    }
}

/// A result with B, the parameters and their displacements; NaN where they do not exist.
fn decoupled<'py, 'a>(
    py: Python<'py>,
    film: &Film,
    found: &impl Serialize,
    field_t: &[DVec3],
    parameters: impl IntoIterator<Item = &'a Option<Parameters>>,
    reference: &Parameters,
) -> PyResult<WithArrays<'py>> {
    let wavenumber = film.layout.ideal.ok_or(FilmError::Missing("ideal")).map_err(of_film)?.wavenumber();
    let vectors = |p: &Parameters| (DVec3::new(p.r_x, p.r_y, p.s_z), p.displacement_from(reference, wavenumber));
    let found_at = |of: &Option<Parameters>| of.as_ref().map_or((DVec3::NAN, DVec3::NAN), vectors);
    let (values, displacement_mm): (Vec<DVec3>, Vec<DVec3>) = parameters.into_iter().map(found_at).unzip();
    let more = [
        ("field_t", rows_of(py, field_t).into_any()),
        ("parameters", rows_of(py, &values).into_any()),
        ("displacement_mm", rows_of(py, &displacement_mm).into_any()),
        ("wavenumber_per_mm", wavenumber.into_bound_py_any(py)?),
    ];
    with_arrays(py, found, more)
}

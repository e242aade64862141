//! Expectations of a film.

use std::path::PathBuf;
use std::time::Duration;

use magsplice::expect::Baseline;
use magsplice::results::CheckedExpectation;
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pythonize::pythonize;

use crate::film::Film;
use crate::vectors::vectors;

/// File of the baseline that the layout names, relative to the layout.
#[pyfunction]
pub(crate) fn baseline_file(film: &Film) -> Option<PathBuf> {
    film.layout.expectations.field.as_ref().map(|field| field.file.clone())
}

/// The outcomes of all expectations of the layout. The baseline has points and B in tesla.
#[pyfunction]
#[pyo3(signature = (film, baseline=None))]
pub(crate) fn check<'py>(
    py: Python<'py>,
    film: &Film,
    baseline: Option<(PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f64>)>,
) -> PyResult<Bound<'py, PyAny>> {
    let held = baseline.as_ref().map(|(points, field_t)| {
        Ok::<_, PyErr>(Baseline { points: vectors(points)?.to_vec(), field_t: vectors(field_t)?.to_vec() })
    });
    let held = held.transpose()?;
    let outcomes = film.run(py, |film| Ok(film.outcomes(held.as_ref())))?;
    let checked = outcomes.into_iter().map(|(expectation, outcome)| {
        let outcome = outcome.map_err(|error| error.to_string());
        CheckedExpectation::new(expectation, outcome, &film.layout, Duration::ZERO)
    });
    Ok(pythonize(py, &checked.collect::<Vec<_>>())?)
}

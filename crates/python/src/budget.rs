//! The displacement error of films as made, split into its causes.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::film::{Film, run};
use crate::results::dictionary;

/// The budget of the errors of the layout or of a preset.
#[pyfunction]
pub(crate) fn budget<'py>(
    py: Python<'py>,
    film: &Film,
    preset: Option<&str>,
    seed: u64,
    samples: u64,
) -> PyResult<Bound<'py, PyDict>> {
    let film = film.with_tables(py, film.layout_with_errors(preset)?)?;
    dictionary(py, &run(py, film, |film| film.budget(seed, samples))?)
}

//! Results of the library as dictionaries.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::pythonize;
use serde::Serialize;

/// A result as a dictionary, with the keys of JSON.
pub(crate) fn dictionary<'py>(py: Python<'py>, result: &impl Serialize) -> PyResult<Bound<'py, PyDict>> {
    Ok(pythonize(py, result)?.cast_into::<PyDict>()?)
}

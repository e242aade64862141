//! Results of the library as dictionaries.

use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};
use pythonize::pythonize;
use serde::Serialize;

/// A result, and by name the values that are not in its JSON: arrays, and values of other results.
pub(crate) type WithArrays<'py> = (Bound<'py, PyDict>, Bound<'py, PyDict>);

/// A result as a dictionary, with the keys of JSON.
pub(crate) fn dictionary<'py>(py: Python<'py>, result: &impl Serialize) -> PyResult<Bound<'py, PyDict>> {
    Ok(pythonize(py, result)?.cast_into::<PyDict>()?)
}

/// A result as a dictionary, with additional values.
pub(crate) fn with_arrays<'py, const N: usize>(
    py: Python<'py>,
    result: &impl Serialize,
    more: [(&str, Bound<'py, PyAny>); N],
) -> PyResult<WithArrays<'py>> {
    Ok((dictionary(py, result)?, more.into_py_dict(py)?))
}

//! Results of the library as dictionaries.

use magsplice::results::{ColumnQuantity, Table};
use numpy::{IntoPyArray, PyArrayMethods};
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

/// The quantities of a table by name: the names of their columns, and an array with one row for
/// each row of the table.
pub(crate) fn quantities<'py>(py: Python<'py>, table: &Table) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    for ColumnQuantity { name, components, values, .. } in table.quantities() {
        let rows = values.clone().into_pyarray(py).reshape([values.len() / components.len(), components.len()])?;
        found.set_item(name, (components.to_vec(), rows))?;
    }
    Ok(found)
}

/// A result as a dictionary, with additional values.
pub(crate) fn with_arrays<'py, const N: usize>(
    py: Python<'py>,
    result: &impl Serialize,
    more: [(&str, Bound<'py, PyAny>); N],
) -> PyResult<WithArrays<'py>> {
    Ok((dictionary(py, result)?, more.into_py_dict(py)?))
}

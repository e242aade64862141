//! The film for the workshop.

use magsplice::results::{BillOfMaterials, MAX_KERF_MM};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::exceptions::bad_value;
use crate::film::Film;
use crate::results::dictionary;

/// The bill of materials, with the material if the kerf is given.
#[pyfunction]
pub(crate) fn parts<'py>(py: Python<'py>, film: &Film, kerf_mm: Option<f64>) -> PyResult<Bound<'py, PyDict>> {
    if let Some(kerf_mm) = kerf_mm.filter(|kerf_mm| !(0.0..=MAX_KERF_MM).contains(kerf_mm)) {
        return Err(bad_value(format_args!("kerf_mm = {kerf_mm}, must be a number of mm from 0 to {MAX_KERF_MM}")));
    }
    dictionary(py, &BillOfMaterials::new(&film.layout, kerf_mm))
}

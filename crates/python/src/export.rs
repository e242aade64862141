//! The film for the workshop and for firmware.

use magsplice::results::{BillOfMaterials, MAX_KERF_MM, SensorPolynomial};
use magsplice_export::c_header::displacement;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::exceptions::{bad_value, failed};
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

/// A header of C with the displacement of a sensor from its reading.
#[pyfunction]
pub(crate) fn c_header(py: Python<'_>, film: &Film, error_mm: f64) -> PyResult<String> {
    let found: SensorPolynomial = film.run(py, |film| film.displacement_polynomial(error_mm))?;
    let mut text = Vec::new();
    displacement(&film.layout, &found, env!("CARGO_PKG_VERSION"), &mut text).map_err(failed)?;
    String::from_utf8(text).map_err(failed)
}

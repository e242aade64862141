//! Films whose tiles are moved, turned, selected, or joined with those of another film, as TOML.

use glam::DVec3;
use magsplice::layout::{Layout, Rotation};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::depythonize;

use crate::exceptions::{bad_value, failed};
use crate::film::Film;

/// The film with its tiles moved by a vector in millimetres.
#[pyfunction]
pub(crate) fn moved(film: &Film, shift_mm: [f64; 3]) -> PyResult<String> {
    Ok(Layout::clone(&film.layout).moved(shift_mm.into()).map_err(failed)?.to_toml())
}

/// The film with its tiles turned about a point in millimetres. `rotation` has the keys of a layout
/// file.
#[pyfunction]
pub(crate) fn rotated(film: &Film, rotation: &Bound<'_, PyDict>, about_mm: [f64; 3]) -> PyResult<String> {
    let rotation: Rotation = depythonize(rotation).map_err(bad_value)?;
    Ok(Layout::clone(&film.layout).rotated(rotation, DVec3::from(about_mm)).map_err(failed)?.to_toml())
}

/// The film with the tiles of these indices.
#[pyfunction]
pub(crate) fn selected(film: &Film, indices: Vec<usize>) -> String {
    Layout::clone(&film.layout).with_selected_tiles(&indices).to_toml()
}

/// The film with the tiles of another film in addition.
#[pyfunction]
pub(crate) fn joined(film: &Film, other: &Film) -> String {
    Layout::clone(&film.layout).joined(&other.layout).to_toml()
}

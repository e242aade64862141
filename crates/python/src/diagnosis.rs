//! Which tiles of a film that was made are faulty.

use magsplice::magnet::{PerTileError, TileError};
use magsplice::scan::FreeParameters;
use magsplice::sensor::Noise;
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::film::{Film, run};
use crate::results::dictionary;
use crate::vectors::vectors;

/// The errors of tiles that a scan tells. `free` says whether strength, offset, rotation and start
/// are fitted.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python passes them by name")]
pub(crate) fn diagnose<'py>(
    py: Python<'py>,
    film: &Film,
    points: PyReadonlyArray2<'py, f64>,
    readings_t: PyReadonlyArray2<'py, f64>,
    noise_t: Option<[f64; 3]>,
    preset: Option<&str>,
    as_ordered: bool,
    free: [bool; 4],
    false_alarm: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let (points, readings_t) = (vectors(&points)?.to_vec(), vectors(&readings_t)?);
    let mut layout = film.layout_with_errors(preset)?;
    if as_ordered {
        layout.tolerance = None;
    }
    let [strength, offset, rotation, start] = free;
    let free = FreeParameters { strength, offset, rotation, start };
    let noise = noise_t.map(|deviation_t| Noise { deviation_t: deviation_t.into() });
    let film = film.with_tables(py, layout)?;
    let found = run(py, film, |film| film.diagnose(points, readings_t, noise, free, false_alarm))?;
    let tiles = &found.diagnosis.errors;
    let errors = PyArray2::zeros(py, [tiles.len(), TileError::ALL.len()], false);
    let values = tiles.iter().flat_map(PerTileError::values);
    errors.readwrite().as_slice_mut()?.iter_mut().zip(values).for_each(|(place, value)| *place = *value);
    let numbers = dictionary(py, &found)?;
    // Errors of each tile, in mm, radians, or as a fraction.
    numbers.set_item("errors", errors)?;
    Ok(numbers)
}

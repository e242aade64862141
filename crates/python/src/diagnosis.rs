//! Faulty tiles of a film as made.

use magsplice::magnet::TileError;
use magsplice::sensor::Noise;
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;

use crate::film::{Film, run};
use crate::results::{WithArrays, with_arrays};
use crate::scan::free_parameters;
use crate::vectors::{numbers, vectors};

/// The diagnosis of a scan, with the errors of each tile by their keys. `fit` lists the parameters
/// of the scan to fit.
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
    fit: Vec<String>,
    false_alarm: f64,
) -> PyResult<(WithArrays<'py>, Vec<String>)> {
    let (points, readings_t) = (vectors(&points)?.to_vec(), vectors(&readings_t)?);
    let mut layout = film.layout_with_errors(preset)?;
    if as_ordered {
        layout.tolerance = None;
    }
    let free = free_parameters(&fit);
    let noise = noise_t.map(|deviation_t| Noise { deviation_t: deviation_t.into() });
    let film = film.with_tables(py, layout)?;
    let indices: Vec<u64> = (0..points.len() as u64).collect();
    let found = run(py, film, |film| film.diagnose(&points, readings_t, &indices, noise, free, false_alarm))?;
    let tiles = &found.diagnosis.errors;
    let errors = TileError::ALL.map(|error| {
        let of_tiles = tiles.iter().map(|of_tile| error.shown(of_tile[error])).collect();
        (error.key(), numbers(py, of_tiles).into_any())
    });
    Ok((with_arrays(py, &found, errors)?, found.remarks()))
}

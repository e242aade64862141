//! Measured scans, fitted, and computed scans of films as made.

use magsplice::scan::FreeParameters;
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::exceptions::bad_value;
use crate::film::{Film, run};
use crate::results::{WithArrays, quantities, with_arrays};
use crate::vectors::{rows_of, vectors};

/// The name of the program in the history of a film as made.
const PROGRAM: &str = concat!("magsplice ", env!("CARGO_PKG_VERSION"), " tolerance sample");

/// A fitted scan with its positions, columns and remarks.
type Scan<'py> = (WithArrays<'py>, Bound<'py, PyDict>, Vec<String>);

/// The parameters that words name.
pub(crate) fn free_parameters(fit: &[String]) -> FreeParameters {
    let is_free = |name: &str| fit.iter().any(|word| word == name);
    FreeParameters {
        strength: is_free("strength"),
        offset: is_free("offset"),
        rotation: is_free("rotation"),
        start: is_free("start"),
    }
}

/// The fit of a scan. `fit` lists the parameters to fit; `None` for those that it determines.
#[pyfunction]
pub(crate) fn scan<'py>(
    py: Python<'py>,
    film: &Film,
    points: PyReadonlyArray2<'py, f64>,
    readings_t: PyReadonlyArray2<'py, f64>,
    fit: Option<Vec<String>>,
) -> PyResult<Scan<'py>> {
    let (points, readings_t) = (vectors(&points)?, vectors(&readings_t)?);
    let indices: Vec<u64> = (0..points.len() as u64).collect();
    let free = fit.as_deref().map(free_parameters);
    let found = film.run(py, |film| film.scan(points, readings_t, &indices, free))?;
    let arrays = with_arrays(py, &found, [("places_mm", rows_of(py, &found.places_mm).into_any())])?;
    let remarks = [found.exchanged_axes(), found.remarks()].concat();
    Ok((arrays, quantities(py, &found.table())?, remarks))
}

/// A sample of a film as made with its scan, and the layout of this film.
#[pyfunction]
pub(crate) fn sample<'py>(
    py: Python<'py>,
    film: &Film,
    preset: Option<&str>,
    seed: u64,
    index: u64,
    points: PyReadonlyArray2<'py, f64>,
) -> PyResult<(WithArrays<'py>, String)> {
    let points = vectors(&points)?.to_vec();
    let made = film.with_tables(py, film.layout_with_errors(preset)?)?;
    if made.layout().tolerance.is_none() {
        return Err(bad_value(
            "preset is missing and the layout has no [tolerance]: give one of them; for noise alone, noise_ut in [tolerance.sensor]",
        ));
    }
    let found = run(py, made, |made| made.sampled_scan(points, seed, index))?;
    let text = found.made_layout(&film.layout, PROGRAM).to_toml();
    let arrays = [("points_mm", &found.points_mm), ("readings_t", &found.readings_t)]
        .map(|(name, of)| (name, rows_of(py, of).into_any()));
    Ok((with_arrays(py, &found, arrays)?, text))
}

//! Forces of tiles on each other, and orders of laying.

use magsplice::results::OrderChoice;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::film::Film;
use crate::results::dictionary;

/// The forces of the tiles on each other, and while they are laid: in an order of indices, or with
/// a seed in the order with the least holding that is found.
#[pyfunction]
#[pyo3(signature = (film, turned_error, order=None, seed=None))]
pub(crate) fn forces<'py>(
    py: Python<'py>,
    film: &Film,
    turned_error: f64,
    order: Option<Vec<usize>>,
    seed: Option<u64>,
) -> PyResult<Bound<'py, PyDict>> {
    let order = match (order, seed) {
        (Some(tiles), _) => Some(OrderChoice::Stated { source: "stated".to_owned(), tiles }),
        (None, Some(seed)) => Some(OrderChoice::Least { seed }),
        (None, None) => None,
    };
    dictionary(py, &film.run(py, |film| film.forces(turned_error, order))?)
}

//! Forces of tiles on each other, and placement orders.

use magsplice::results::OrderChoice;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::film::Film;
use crate::results::dictionary;

/// A placement order.
#[derive(FromPyObject)]
pub(crate) enum Order {
    /// `given`, or `least`.
    Named(String),
    /// The tile of each step.
    Tiles(Vec<usize>),
}

/// The forces of the tiles on each other, and during their placement in an order. `seed` is the
/// seed of the search for the order with the smallest holding force.
#[pyfunction]
pub(crate) fn forces<'py>(
    py: Python<'py>,
    film: &Film,
    turned_error: f64,
    order: Option<Order>,
    seed: u64,
) -> PyResult<Bound<'py, PyDict>> {
    let order = order.map(|order| match order {
        Order::Named(name) if name == "least" => OrderChoice::Least { seed },
        Order::Named(_) => OrderChoice::Given,
        Order::Tiles(tiles) => OrderChoice::Stated { source: "stated".to_owned(), tiles },
    });
    dictionary(py, &film.run(py, |film| film.forces(turned_error, order))?)
}

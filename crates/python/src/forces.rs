//! Forces of tiles on each other, and orders of laying.

use glam::DVec3;
use magsplice::force::{FilmForces, LayingOrder, LeastHolding, Load, OrderSettings};
use magsplice::{ForceChange, SolvedForces};
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::exceptions::{bad_value, of_film};
use crate::film::Film;
use crate::interruption::Interruption;
use crate::vectors::rows_of;

/// From T^2 mm^2 / mu0 to N, and from T^2 mm^3 / mu0 to N mm.
const PER_MM2: f64 = 1e-6;

/// Forces in newton and torques in newton millimetres.
type Loads<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

/// The forces of all pairs of tiles.
#[pyclass(frozen, module = "magsplice._magsplice")]
pub(crate) struct Forces {
    pairs: FilmForces,
    recoil: Option<ForceChange>,
}

/// An order of laying, with the fields of the Python class.
#[derive(IntoPyObject)]
pub(crate) struct OrderNumbers<'py> {
    tiles: Vec<usize>,
    loads: Loads<'py>,
    holding_n: f64,
    given_holding_n: f64,
    bound_n: Option<f64>,
    greedy_holding_n: Option<f64>,
}

#[pymethods]
impl Forces {
    #[new]
    fn new(py: Python<'_>, film: &Film, turned_error: f64) -> PyResult<Forces> {
        let interruption = Interruption::default();
        let progress = |_| interruption.poll();
        let film = film.evaluated(py)?.telling(&progress);
        let SolvedForces { loads: pairs, recoil } =
            interruption.run(py, || film.forces(turned_error))?.map_err(of_film)?;
        Ok(Forces { pairs, recoil })
    }

    /// What recoil changes in the force on a tile at most, and the estimate of the error, in
    /// newtons.
    #[getter]
    fn recoil(&self) -> Option<(f64, f64)> {
        self.recoil.map(|found| (PER_MM2 * found.change, PER_MM2 * found.error))
    }

    /// The load on each tile by all others.
    fn by_all<'py>(&self, py: Python<'py>) -> Loads<'py> {
        loads(py, &self.pairs.by_all())
    }

    /// The loads while tiles are laid in an order, as indices.
    fn order<'py>(&self, py: Python<'py>, tiles: Vec<usize>) -> PyResult<OrderNumbers<'py>> {
        Ok(self.numbers(py, &LayingOrder::new(&self.pairs, tiles).map_err(bad_value)?, None))
    }

    /// The order with the least holding that is found.
    fn least_order<'py>(&self, py: Python<'py>, seed: u64) -> PyResult<OrderNumbers<'py>> {
        let settings = OrderSettings { seed, ..OrderSettings::default() };
        let interruption = Interruption::default();
        let search = || LeastHolding::search(&self.pairs, &settings, || interruption.poll());
        let found = interruption.run(py, search)?;
        Ok(self.numbers(py, &found.order, Some(&found)))
    }
}

impl Forces {
    fn numbers<'py>(&self, py: Python<'py>, order: &LayingOrder, least: Option<&LeastHolding>) -> OrderNumbers<'py> {
        let given = LayingOrder::new(&self.pairs, (0..self.pairs.tile_count()).collect()).expect("each tile once");
        OrderNumbers {
            tiles: order.tiles().to_vec(),
            loads: loads(py, order.loads()),
            holding_n: PER_MM2 * order.holding(),
            given_holding_n: PER_MM2 * given.holding(),
            bound_n: least.map(|found| PER_MM2 * found.bound),
            greedy_holding_n: least.map(|found| PER_MM2 * found.greedy),
        }
    }
}

fn loads<'py>(py: Python<'py>, loads: &[Load]) -> Loads<'py> {
    let rows =
        |of: &dyn Fn(&Load) -> DVec3| rows_of(py, &loads.iter().map(|load| PER_MM2 * of(load)).collect::<Vec<DVec3>>());
    (rows(&|load| load.force), rows(&|load| load.torque))
}

//! Tiles prepared for evaluation.

use std::sync::{Arc, Mutex, PoisonError};

use glam::{DMat3, DQuat, DVec3};
use magsplice::field::Scene as Tiles;
use magsplice::layout::{relative_tolerance, tolerance_of_text};
use magsplice::magnet::{Accuracy, Grid, PointError, PointErrors, Quantity, Tile, Tolerance};
use numpy::{PyArray1, PyArray2, PyArray3, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::exceptions::{bad_value, of_points};
use crate::interruption::Interruption;
use crate::threads::detached;
use crate::vectors::{Triple, in_mm, numbers, points_in_mm, vectors, written_gradients, written_rows};

/// Number of pairs of tile and point between two polls for signals: about a tenth of a second.
const STRETCH_PAIRS: usize = 1 << 24;
/// Smallest and largest number of points between two polls. The smallest number gives every thread
/// points to sort into batches of neighbours.
const STRETCH_POINTS: [usize; 2] = [1 << 12, 1 << 16];
/// Number of points between two polls where the field has a tolerance. The model is chosen for a
/// stretch as a whole, so short stretches would be slow.
const STRETCH_POINTS_WITHIN: usize = 1 << 20;

/// A tolerance from Python.
#[derive(FromPyObject)]
pub(crate) enum Requested {
    /// A fraction of |B|.
    Fraction(f64),
    /// A text, such as `10nT`.
    Text(String),
    /// An error in tesla.
    Tesla((f64,)),
}

/// A tolerance from Python; `None` for the exact field.
pub(crate) type Within = Option<Requested>;

/// Points without a field: an exception that is not raised.
pub(crate) type Faults = Option<PyErr>;

/// Tiles prepared for evaluation, in millimetres.
#[pyclass(frozen, module = "magsplice._magsplice")]
pub(crate) struct Scene {
    exact: Tiles,
    /// Whether the points of calls are in metres.
    is_in_metres: bool,
    /// The scene of the last tolerance, with its tree.
    within: Mutex<Option<Arc<Tiles>>>,
}

impl From<Tiles> for Scene {
    fn from(exact: Tiles) -> Scene {
        Scene { exact, is_in_metres: false, within: Mutex::new(None) }
    }
}

#[pymethods]
impl Scene {
    /// Tiles from arrays of shape (n, 3), and quaternions (x, y, z, w) of shape (n, 4). Positions,
    /// sizes, and the points of calls are in metres. They are evaluated in millimetres, because in
    /// metres few lengths of tiles are exact: 0.57 is not 0.56 + 0.01.
    #[new]
    fn new(
        position: PyReadonlyArray2<'_, f64>,
        size: PyReadonlyArray2<'_, f64>,
        polarization_t: PyReadonlyArray2<'_, f64>,
        rotation: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Scene> {
        let (position, size, polarization_t) = (vectors(&position)?, vectors(&size)?, vectors(&polarization_t)?);
        let (rotation, _) = rotation.as_slice()?.as_chunks::<4>();
        let count = position.len();
        if [size.len(), polarization_t.len(), rotation.len()] != [count; 3] {
            return Err(PyValueError::new_err("the arrays of tiles must have the same length"));
        }
        let tile = |index: usize| {
            let turn = DQuat::from_array(rotation[index]);
            let [position, size] = [position, size].map(|of| in_mm(of[index]));
            let tile = Tile::new(position, size, polarization_t[index])
                .and_then(|tile| if turn == DQuat::IDENTITY { Ok(tile) } else { tile.rotated(turn) });
            tile.map_err(|faults| bad_value(format_args!("tile {index}: {faults}")))
        };
        let tiles: Vec<Tile> = (0..count).map(tile).collect::<PyResult<_>>()?;
        Ok(Scene { is_in_metres: true, ..Scene::from(Tiles::new(&tiles)) })
    }

    /// Number of tiles.
    fn __len__(&self) -> usize {
        self.exact.tile_count()
    }

    /// The field at points: an array of shape (n, 3), NaN where there is no field, and the
    /// exception that lists these points, or None.
    #[pyo3(signature = (quantity, points, within=None))]
    fn field<'py>(
        &self,
        py: Python<'py>,
        quantity: &str,
        points: PyReadonlyArray2<'py, f64>,
        within: Within,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Faults)> {
        let (quantity, points) = (quantity_named(quantity)?, vectors(&points)?);
        let scene = self.within(within)?;
        written_rows(py, points.len(), |field| field_into(py, &scene, quantity, points, self.is_in_metres, field))
    }

    /// The field on a grid, z fastest, in the form of `field`.
    #[pyo3(signature = (quantity, lower, upper, counts, within=None))]
    fn field_on_grid<'py>(
        &self,
        py: Python<'py>,
        quantity: &str,
        lower: [f64; 3],
        upper: [f64; 3],
        counts: [usize; 3],
        within: Within,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Faults)> {
        let quantity = quantity_named(quantity)?;
        let grid = Grid::new(lower.into(), upper.into(), counts).map_err(bad_value)?;
        let scene = self.within(within)?;
        written_rows(py, grid.len(), |field| match scene.accuracy() {
            Accuracy::Exact => {
                let points: Vec<DVec3> = py.detach(|| grid.points().collect());
                field_into(py, &scene, quantity, &points, false, field)
            }
            // The models are chosen for the grid as a whole.
            Accuracy::Within(_) => {
                let interruption = Interruption::default();
                let evaluate = || scene.field_on_grid_with_progress(quantity, &grid, field, &|_| interruption.poll());
                Ok(interruption.run(py, evaluate)?.err().map(|errors| of_points(&errors)))
            }
        })
    }

    /// The gradient at points: an array of shape (n, 3, 3), and the exception that lists points
    /// without a gradient, or None. Gradients are symmetric, so columns in memory may count as
    /// rows.
    fn gradient<'py>(
        &self,
        py: Python<'py>,
        quantity: &str,
        points: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<(Bound<'py, PyArray3<f64>>, Faults)> {
        let (quantity, points) = (quantity_named(quantity)?, vectors(&points)?);
        written_gradients(py, points.len(), |gradients: &mut [DMat3]| {
            in_stretches(py, points, gradients, self.exact_stretch(), |points, gradients| {
                self.exact.gradient_into(quantity, points, gradients)
            })
        })
    }

    /// Upper bound of the error of the exact B at points, in tesla.
    fn error_bounds_t<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let points = vectors(&points)?;
        Ok(numbers(py, detached(py, || self.exact.error_bounds_t(points))?))
    }
}

impl Scene {
    /// The tiles with this tolerance of their fields.
    pub(crate) fn within(&self, within: Within) -> PyResult<Arc<Tiles>> {
        let accuracy = accuracy(within)?;
        // After a panic of another thread the value is a scene or none.
        let mut kept = self.within.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(scene) = kept.as_ref().filter(|scene| scene.accuracy() == accuracy) {
            return Ok(Arc::clone(scene));
        }
        let scene = Arc::new(self.exact.clone().with_accuracy(accuracy));
        *kept = Some(Arc::clone(&scene));
        Ok(scene)
    }

    fn exact_stretch(&self) -> usize {
        exact_stretch(&self.exact)
    }
}

/// The coordinates of a grid along x, y and z.
#[pyfunction]
pub(crate) fn grid_axes<'py>(
    py: Python<'py>,
    lower: [f64; 3],
    upper: [f64; 3],
    counts: [usize; 3],
) -> PyResult<Triple<Bound<'py, PyArray1<f64>>>> {
    let grid = Grid::new(lower.into(), upper.into(), counts).map_err(bad_value)?;
    let [x, y, z] = [0, 1, 2].map(|axis| (0..counts[axis]).map(|i| grid.coordinate(axis, i)).collect());
    Ok((numbers(py, x), numbers(py, y), numbers(py, z)))
}

/// The accuracy requested by Python.
pub(crate) fn accuracy(within: Within) -> PyResult<Accuracy> {
    let tolerance = match within {
        None => return Ok(Accuracy::Exact),
        Some(Requested::Fraction(fraction)) => relative_tolerance(fraction).map_err(|rule| ("within", rule)),
        Some(Requested::Text(text)) => tolerance_of_text(&text).map_err(|rule| ("within", format!("{text:?} {rule}"))),
        Some(Requested::Tesla((error_t,))) => {
            Tolerance::absolute_t(error_t).map_err(|rule| ("within_t", rule.to_string()))
        }
    };
    tolerance.map(Accuracy::Within).map_err(|(name, rule)| bad_value(format_args!("{name}: {rule}")))
}

/// The field at points, in stretches with polls for signals between them. `in_metres` is
/// whether the points are in metres.
pub(crate) fn field_into(
    py: Python<'_>,
    scene: &Tiles,
    quantity: Quantity,
    points: &[DVec3],
    in_metres: bool,
    field: &mut [DVec3],
) -> PyResult<Faults> {
    let stretch = match scene.accuracy() {
        Accuracy::Exact => exact_stretch(scene),
        Accuracy::Within(_) => STRETCH_POINTS_WITHIN,
    };
    in_stretches(py, points, field, stretch, |points, field| {
        if !in_metres {
            return scene.field_into(quantity, points, field);
        }
        let as_called = |error: PointError| PointError { point: points[error.index], ..error };
        scene
            .field_into(quantity, &points_in_mm(points), field)
            .map_err(|errors| PointErrors(errors.0.into_iter().map(as_called).collect()))
    })
}

fn exact_stretch(scene: &Tiles) -> usize {
    (STRETCH_PAIRS / scene.tile_count().max(1)).clamp(STRETCH_POINTS[0], STRETCH_POINTS[1])
}

/// Calls `evaluate` for stretches of points without the interpreter.
fn in_stretches<T: Send>(
    py: Python<'_>,
    points: &[DVec3],
    values: &mut [T],
    stretch: usize,
    evaluate: impl Fn(&[DVec3], &mut [T]) -> Result<(), PointErrors> + Sync,
) -> PyResult<Faults> {
    let mut faults = Vec::new();
    let mut begin = 0;
    for (points, values) in points.chunks(stretch).zip(values.chunks_mut(stretch)) {
        if let Err(errors) = detached(py, || evaluate(points, values))? {
            faults.extend(errors.0.into_iter().map(|error| PointError { index: begin + error.index, ..error }));
        }
        begin += points.len();
        py.check_signals()?;
    }
    Ok((!faults.is_empty()).then(|| of_points(&PointErrors(faults))))
}

fn quantity_named(name: &str) -> PyResult<Quantity> {
    match name {
        "b" => Ok(Quantity::FluxDensity),
        "h" => Ok(Quantity::FieldStrength),
        "j" => Ok(Quantity::Polarization),
        _ => Err(PyValueError::new_err(format!("quantity = {name:?}, must be \"b\", \"h\" or \"j\""))),
    }
}

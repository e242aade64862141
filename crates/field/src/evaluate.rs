//! Many points at once, into buffers of the caller.

use std::fmt;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::grid::Grid;
use crate::quantity::{MU_0, Quantity};
use crate::scene::{Cause, Scene};
use crate::tolerances::{BATCHES_PER_THREAD, EXACT_BOUND, POINTS_PER_BATCH, REGROUPED_POINTS};
use crate::within::accuracy::{Accuracy, Tolerance};
use crate::within::at_points::at_points;
use crate::within::magnitude::most_field_t;
use crate::within::on_grid::on_grid;

/// Points at which there is no field to give, in the order of the points.
#[derive(Clone, Debug, PartialEq)]
pub struct PointErrors(pub Vec<PointError>);

/// One point at which there is no field to give.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointError {
    /// Index into the points that were asked for.
    pub index: usize,
    /// The point.
    pub point: DVec3,
    /// Why.
    pub cause: Cause,
}

impl Scene {
    /// The field at every point of `points`, written to `field` in the same order, in parallel over points, to the scene's
    /// [`Accuracy`].
    ///
    /// Points are taken in batches, but no digit of an exact field depends on the other points: the result is bit-identical for any number of threads and
    /// any division of the points into calls. Memory does not grow with tiles times points.
    ///
    /// # Errors
    /// All points without a field at once; their entries of `field` are then NaN and all others are valid.
    ///
    /// # Panics
    /// If the two slices differ in length.
    pub fn field_into(&self, quantity: Quantity, points: &[DVec3], field: &mut [DVec3]) -> Result<(), PointErrors> {
        match (self.accuracy(), quantity) {
            (Accuracy::Within(tolerance), Quantity::FluxDensity | Quantity::FieldStrength) => {
                assert_eq!(points.len(), field.len(), "one value per point");
                none_or(at_points(self, tolerance, quantity, points, field))
            }
            _ => self.exact_field_into(quantity, points, field),
        }
    }

    /// The field at every point of a grid, z fastest, as [`Scene::field_into`] gives it. To a tolerance it is much faster than the same points one by
    /// one: away from the tiles it is a Chebyshev expansion (docs/physics.md, section 5). The result is bit-identical for any number of threads.
    ///
    /// # Errors
    /// All points without a field at once; their entries of `field` are then NaN and all others are valid.
    ///
    /// # Panics
    /// If `field` has not one entry for each point.
    pub fn field_on_grid(&self, quantity: Quantity, grid: &Grid, field: &mut [DVec3]) -> Result<(), PointErrors> {
        assert_eq!(grid.len(), field.len(), "one value per point");
        match (self.accuracy(), quantity) {
            (Accuracy::Within(tolerance), Quantity::FluxDensity | Quantity::FieldStrength) => {
                none_or(on_grid(self, tolerance, quantity, grid, field))
            }
            _ => {
                let points: Vec<DVec3> = grid.points().collect();
                self.exact_field_into(quantity, &points, field)
            }
        }
    }

    /// See [`Scene::field_into`].
    pub(crate) fn exact_field_into(
        &self,
        quantity: Quantity,
        points: &[DVec3],
        field: &mut [DVec3],
    ) -> Result<(), PointErrors> {
        for_each_batch(points, field, self.batches(), |points, field, failed| {
            self.field_of_batch(quantity, None, points, field, failed);
        })
    }

    /// The exact field at the points with these indices, where it keeps the tolerance.
    pub(crate) fn exact_at(
        &self,
        tolerance: Tolerance,
        quantity: Quantity,
        points: &[DVec3],
        indices: &[usize],
        field: &mut [DVec3],
    ) -> Vec<PointError> {
        let chosen: Vec<DVec3> = indices.iter().map(|&index| points[index]).collect();
        let mut values = vec![DVec3::ZERO; chosen.len()];
        let errors = self.checked_exact_into(tolerance, quantity, &chosen, &mut values);
        for (&index, value) in indices.iter().zip(values) {
            field[index] = value;
        }
        errors.into_iter().map(|error| PointError { index: indices[error.index], ..error }).collect()
    }

    /// The exact field, where it keeps the tolerance.
    fn checked_exact_into(
        &self,
        tolerance: Tolerance,
        quantity: Quantity,
        points: &[DVec3],
        field: &mut [DVec3],
    ) -> Vec<PointError> {
        let mut errors = self.exact_field_into(quantity, points, field).err().map_or(Vec::new(), |errors| errors.0);
        let in_tesla = if quantity == Quantity::FieldStrength { MU_0 } else { 1.0 };
        let most_t: f64 = self.tiles().iter().map(|tile| most_field_t(tile, 0.0)).sum();
        let checked = points.par_iter().zip(field).enumerate().filter_map(|(index, (&point, value))| {
            // Sums that are surely too large spare nearly all points the right one.
            let is_kept = |magnitude_t: f64| tolerance.is_kept(*value * in_tesla, EXACT_BOUND * magnitude_t);
            if value.is_nan() || is_kept(most_t) || is_kept(self.most_magnitude_t(point)) {
                return None;
            }
            let magnitude_t = self.magnitude_t(point);
            if is_kept(magnitude_t) {
                return None;
            }
            *value = DVec3::NAN;
            Some(PointError { index, point, cause: Cause::TooExact { bound_t: EXACT_BOUND * magnitude_t } })
        });
        errors.extend(checked.collect::<Vec<PointError>>());
        errors.sort_by_key(|error| error.index);
        errors
    }

    /// The gradient of B at every point of `points`, written to `gradient` in the same order, as [`Scene::field_into`] does.
    ///
    /// # Errors
    /// All points without a gradient at once; their entries are then NaN and all others are valid.
    ///
    /// # Panics
    /// If the two slices differ in length.
    pub fn flux_density_gradient_into(&self, points: &[DVec3], gradient: &mut [DMat3]) -> Result<(), PointErrors> {
        let batches = Batches { most: POINTS_PER_BATCH[1], regroup: false };
        for_each_batch(points, gradient, batches, |points, gradient, failed| {
            for (index, (&point, gradient)) in points.iter().zip(gradient).enumerate() {
                *gradient = self.flux_density_gradient(point).unwrap_or_else(|cause| {
                    failed(index, cause);
                    DMat3::NAN
                });
            }
        })
    }
}

/// How points are divided.
#[derive(Clone, Copy)]
pub(crate) struct Batches {
    /// Points of one, at most.
    pub(crate) most: usize,
    /// Whether each is of neighbours, not of points that follow each other.
    pub(crate) regroup: bool,
}

/// Has `evaluate` fill in the values of batch after batch and name the points of the batch that have none.
fn for_each_batch<T: Send + Copy + Default>(
    points: &[DVec3],
    values: &mut [T],
    batches: Batches,
    evaluate: impl Fn(&[DVec3], &mut [T], &mut dyn FnMut(usize, Cause)) + Sync + Send,
) -> Result<(), PointErrors> {
    assert_eq!(points.len(), values.len(), "one value per point");
    let threads = rayon::current_num_threads();
    let count = if threads > 1 { BATCHES_PER_THREAD * threads } else { 1 };
    let size = (points.len() / count).clamp(POINTS_PER_BATCH[0], batches.most);
    let mut errors = Vec::new();
    if batches.regroup && points.len() > size {
        let stretches = points.chunks(REGROUPED_POINTS).zip(values.chunks_mut(REGROUPED_POINTS));
        for (stretch, (points, values)) in stretches.enumerate() {
            let order = neighbours_together(points, 0..points.len() as u32, &[size]);
            let regrouped: Vec<DVec3> = order.iter().map(|&index| points[index as usize]).collect();
            let mut results = vec![T::default(); points.len()];
            let start = stretch * REGROUPED_POINTS;
            let index = |position: usize| start + order[position] as usize;
            errors.extend(
                in_batches(&regrouped, &mut results, size, &evaluate)
                    .into_iter()
                    .map(|error| PointError { index: index(error.index), ..error }),
            );
            for (&index, result) in order.iter().zip(results) {
                values[index as usize] = result;
            }
        }
    } else {
        errors = in_batches(points, values, size, &evaluate);
    }
    errors.sort_by_key(|e| e.index);
    none_or(errors)
}

fn none_or(errors: Vec<PointError>) -> Result<(), PointErrors> {
    if errors.is_empty() { Ok(()) } else { Err(PointErrors(errors)) }
}

/// Batches of `size` points, in parallel.
fn in_batches<T: Send>(
    points: &[DVec3],
    values: &mut [T],
    size: usize,
    evaluate: &(impl Fn(&[DVec3], &mut [T], &mut dyn FnMut(usize, Cause)) + Sync + Send),
) -> Vec<PointError> {
    points
        .par_chunks(size)
        .zip(values.par_chunks_mut(size))
        .enumerate()
        .flat_map_iter(|(batch, (points, values))| {
            let mut errors = Vec::new();
            evaluate(points, values, &mut |index, cause| {
                errors.push(PointError { index: batch * size + index, point: points[index], cause });
            });
            errors
        })
        .collect()
}

/// Indices of points in an order in which each so many of them, from the first on, are neighbours: of the points that the first of `sizes` puts together each so many as the
/// next says, and so on.
pub(crate) fn neighbours_together(points: &[DVec3], order: impl IntoIterator<Item = u32>, sizes: &[usize]) -> Vec<u32> {
    // Side by side in memory, where they are compared again and again.
    let mut placed: Vec<Placed> =
        order.into_iter().map(|index| Placed { point: points[index as usize].to_array(), index }).collect();
    divide(&mut placed, sizes);
    placed.into_iter().map(|placed| placed.index).collect()
}

/// A point and its index.
#[derive(Clone, Copy)]
struct Placed {
    point: [f64; 3],
    index: u32,
}

/// Divides along the axis along which the points reach farthest.
fn divide(placed: &mut [Placed], sizes: &[usize]) {
    let Some((&size, smaller)) = sizes.split_first() else { return };
    if placed.len() <= size {
        return divide(placed, smaller);
    }
    let at = |placed: &Placed| DVec3::from_array(placed.point);
    let least = placed.iter().map(at).fold(DVec3::INFINITY, DVec3::min);
    let most = placed.iter().map(at).fold(DVec3::NEG_INFINITY, DVec3::max);
    let axis = (most - least).max_position();
    let middle = placed.len().div_ceil(size) / 2 * size;
    placed.select_nth_unstable_by(middle, |a, b| a.point[axis].total_cmp(&b.point[axis]));
    let (low, high) = placed.split_at_mut(middle);
    divide(low, sizes);
    divide(high, sizes);
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Cause::Unbounded { tile } => write!(f, "the field is unbounded on an exposed edge of tile {tile}"),
            Cause::Unresolved { tile } => {
                write!(f, "the gradient cannot be resolved on an edge that tile {tile} shares with others")
            }
            Cause::OutOfRange => write!(
                f,
                "the coordinates must be finite numbers of at most 2^1000 in magnitude, and the result in the range of numbers"
            ),
            Cause::TooExact { bound_t } => write!(
                f,
                "the tolerance cannot be kept: even the exact field is only certain to {bound_t:.1e} T there; take a larger tolerance, or one in tesla"
            ),
        }
    }
}

impl std::error::Error for Cause {}

impl fmt::Display for PointErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, error) in self.0.iter().enumerate() {
            let separator = if i == 0 { "" } else { "; " };
            let PointError { index, point, cause } = error;
            write!(f, "{separator}point {index} at ({}, {}, {}): {cause}", point.x, point.y, point.z)?;
        }
        Ok(())
    }
}

impl std::error::Error for PointErrors {}

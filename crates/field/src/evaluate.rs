//! Many points at once, into buffers of the caller.

use std::fmt;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::quantity::Quantity;
use crate::scene::{Cause, Scene};
use crate::tolerances::{BATCHES_PER_THREAD, POINTS_PER_BATCH};

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
    /// The field at every point of `points`, written to `field` in the same order, in parallel over points.
    ///
    /// Points are taken in batches, but no digit of a field depends on the other points: the result is bit-identical for any number of threads and
    /// any division of the points into calls. Memory does not grow with tiles times points.
    ///
    /// # Errors
    /// All points without a field at once; their entries of `field` are then NaN and all others are valid.
    ///
    /// # Panics
    /// If the two slices differ in length.
    pub fn field_into(&self, quantity: Quantity, points: &[DVec3], field: &mut [DVec3]) -> Result<(), PointErrors> {
        for_each_batch(points, field, |points, field, failed| {
            self.field_of_batch(quantity, points, field, failed);
        })
    }

    /// The gradient of B at every point of `points`, written to `gradient` in the same order, as [`Scene::field_into`] does.
    ///
    /// # Errors
    /// All points without a gradient at once; their entries are then NaN and all others are valid.
    ///
    /// # Panics
    /// If the two slices differ in length.
    pub fn flux_density_gradient_into(&self, points: &[DVec3], gradient: &mut [DMat3]) -> Result<(), PointErrors> {
        for_each_batch(points, gradient, |points, gradient, failed| {
            for (index, (&point, gradient)) in points.iter().zip(gradient).enumerate() {
                *gradient = self.flux_density_gradient(point).unwrap_or_else(|cause| {
                    failed(index, cause);
                    DMat3::NAN
                });
            }
        })
    }
}

/// Has `evaluate` fill in the values of batch after batch and name the points of the batch that have none.
fn for_each_batch<T: Send>(
    points: &[DVec3],
    values: &mut [T],
    evaluate: impl Fn(&[DVec3], &mut [T], &mut dyn FnMut(usize, Cause)) + Sync + Send,
) -> Result<(), PointErrors> {
    assert_eq!(points.len(), values.len(), "one value per point");
    let threads = rayon::current_num_threads();
    let batches = if threads > 1 { BATCHES_PER_THREAD * threads } else { 1 };
    let [least, most] = POINTS_PER_BATCH;
    let size = (points.len() / batches).clamp(least, most);
    let mut errors: Vec<PointError> = points
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
        .collect();
    if errors.is_empty() {
        return Ok(());
    }
    errors.sort_by_key(|e| e.index);
    Err(PointErrors(errors))
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

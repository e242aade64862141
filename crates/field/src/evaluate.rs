//! Many points at once, into buffers of the caller.

use std::fmt;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::quantity::Quantity;
use crate::scene::{Cause, Scene};
use crate::tolerances::POINTS_PER_TASK;

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
    /// Each point is computed alone, so the result is bit-identical for any number of threads and any division of the points
    /// into calls. Memory does not grow with tiles times points.
    ///
    /// # Errors
    /// All points without a field at once; their entries of `field` are then NaN and all others are valid.
    ///
    /// # Panics
    /// If the two slices differ in length.
    pub fn field_into(&self, quantity: Quantity, points: &[DVec3], field: &mut [DVec3]) -> Result<(), PointErrors> {
        for_each_point(points, field, DVec3::NAN, |point| self.field(quantity, point))
    }

    /// The gradient of B at every point of `points`, written to `gradient` in the same order, as [`Scene::field_into`] does.
    ///
    /// # Errors
    /// All points without a gradient at once; their entries are then NaN and all others are valid.
    ///
    /// # Panics
    /// If the two slices differ in length.
    pub fn flux_density_gradient_into(&self, points: &[DVec3], gradient: &mut [DMat3]) -> Result<(), PointErrors> {
        for_each_point(points, gradient, DMat3::NAN, |point| self.flux_density_gradient(point))
    }
}

fn for_each_point<T: Copy + Send + Sync>(
    points: &[DVec3],
    values: &mut [T],
    none: T,
    at: impl Fn(DVec3) -> Result<T, Cause> + Sync,
) -> Result<(), PointErrors> {
    assert_eq!(points.len(), values.len(), "one value per point");
    let mut errors: Vec<PointError> = points
        .par_chunks(POINTS_PER_TASK)
        .zip(values.par_chunks_mut(POINTS_PER_TASK))
        .enumerate()
        .flat_map_iter(|(task, (points, values))| {
            let mut errors = Vec::new();
            for (offset, (&point, value)) in points.iter().zip(values).enumerate() {
                *value = at(point).unwrap_or_else(|cause| {
                    errors.push(PointError { index: task * POINTS_PER_TASK + offset, point, cause });
                    none
                });
            }
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

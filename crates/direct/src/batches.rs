//! Batches of points, evaluated in parallel with results in the order of the points.

use glam::DVec3;
use magsplice_magnet::{PointError, PointErrorCause, PointErrors};
use rayon::prelude::*;

use crate::tolerances::{BATCHES_PER_THREAD, POINTS_PER_BATCH, REGROUPED_POINTS};

/// A callback that receives, from any thread, the number of points that begin.
pub type PointProgress<'a> = &'a (dyn Fn(usize) + Sync);

/// The division of points into batches.
#[derive(Clone, Copy)]
pub struct Batches {
    /// Largest number of points in a batch.
    pub most: usize,
    /// Whether a batch holds neighbours instead of consecutive points.
    pub regroup: bool,
}

/// Calls `evaluate` for every batch, in parallel. `evaluate` writes the values of the batch and
/// returns the points without a value.
pub fn for_each_batch<T: Send + Copy + Default>(
    points: &[DVec3],
    values: &mut [T],
    batches: Batches,
    progress: PointProgress,
    evaluate: impl Fn(&[DVec3], &mut [T], &mut dyn FnMut(usize, PointErrorCause)) + Sync + Send,
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
            let failed = in_batches(&regrouped, &mut results, size, progress, &evaluate);
            let error = |(position, cause): (usize, PointErrorCause)| {
                let index = start + order[position] as usize;
                PointError { index, point: regrouped[position], cause }
            };
            errors.extend(failed.into_iter().flatten().map(error));
            for (&index, result) in order.iter().zip(results) {
                values[index as usize] = result;
            }
        }
    } else {
        let failed = in_batches(points, values, size, progress, &evaluate);
        errors.reserve_exact(failed.iter().map(Vec::len).sum());
        let error = |(index, cause)| PointError { index, point: points[index], cause };
        errors.extend(failed.into_iter().flatten().map(error));
    }
    // Stable, because that takes little time for a few sorted lists one after the other.
    errors.sort_by_key(|error| error.index);
    none_or(errors)
}

/// An error if `errors` is not empty.
pub fn none_or(errors: Vec<PointError>) -> Result<(), PointErrors> {
    if errors.is_empty() { Ok(()) } else { Err(PointErrors(errors)) }
}

/// Evaluates batches of `size` points in parallel. Returns the points of each without a value.
fn in_batches<T: Send>(
    points: &[DVec3],
    values: &mut [T],
    size: usize,
    progress: PointProgress,
    evaluate: &(impl Fn(&[DVec3], &mut [T], &mut dyn FnMut(usize, PointErrorCause)) + Sync + Send),
) -> Vec<Vec<(usize, PointErrorCause)>> {
    let batches = points.par_chunks(size).zip(values.par_chunks_mut(size)).enumerate();
    batches
        .map(|(batch, (points, values))| {
            progress(points.len());
            let mut failures = Vec::new();
            evaluate(points, values, &mut |index, cause| {
                if failures.is_empty() {
                    // Refused points usually come in large numbers.
                    failures.reserve_exact(points.len());
                }
                failures.push((batch * size + index, cause));
            });
            failures.shrink_to_fit();
            failures
        })
        .collect()
}

/// Indices of points in an order in which consecutive points are neighbours: groups of the first of
/// `sizes`, each divided into groups of the next size, and so on.
pub fn neighbours_together(points: &[DVec3], order: impl IntoIterator<Item = u32>, sizes: &[usize]) -> Vec<u32> {
    // Contiguous in memory, because points are compared many times.
    let mut placed: Vec<IndexedPoint> =
        order.into_iter().map(|index| IndexedPoint { point: points[index as usize].to_array(), index }).collect();
    divide(&mut placed, sizes);
    placed.into_iter().map(|placed| placed.index).collect()
}

/// A point and its index.
#[derive(Clone, Copy)]
struct IndexedPoint {
    point: [f64; 3],
    index: u32,
}

/// Splits points along the axis of their largest extent, until groups have the given sizes.
fn divide(placed: &mut [IndexedPoint], sizes: &[usize]) {
    let Some((&size, smaller)) = sizes.split_first() else { return };
    if placed.len() <= size {
        return divide(placed, smaller);
    }
    let at = |placed: &IndexedPoint| DVec3::from_array(placed.point);
    let least = placed.iter().map(at).fold(DVec3::INFINITY, DVec3::min);
    let most = placed.iter().map(at).fold(DVec3::NEG_INFINITY, DVec3::max);
    let axis = (most - least).max_position();
    let middle = placed.len().div_ceil(size) / 2 * size;
    placed.select_nth_unstable_by(middle, |a, b| a.point[axis].total_cmp(&b.point[axis]));
    let (low, high) = placed.split_at_mut(middle);
    divide(low, sizes);
    divide(high, sizes);
}

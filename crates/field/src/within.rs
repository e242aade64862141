//! B and H within a tolerance: the choice between interpolation, the tree and direct summation for
//! each point.
//!
//! | model | points | where |
//! |---|---|---|
//! | Chebyshev interpolation of a box without tiles | grids | [`crate::interpolation`] |
//! | harmonic polynomials of the cells of a box | long lists of points in a box without tiles | [`crate::interpolation`] |
//! | expansions of the nodes of a tree | other points | [`crate::tree`] |
//! | direct summation | points where no other model keeps the tolerance | [`crate::direct`] |

use glam::DVec3;
use magsplice_direct::tolerances::STRETCHED_BOUND;
use magsplice_magnet::{BoundingBox, Grid, MU_0, PointError, Quantity, Tolerance, is_in_range};
use rayon::prelude::*;

use crate::interpolation::fitted_field::FittedField;
use crate::interpolation::on_grid::GridFits;
use crate::interpolation::outlook::is_promising;
use crate::tolerances::{
    LOOK_UP_POINTS_PER_NODE, MAX_SORTED_POINTS, MIN_LOOK_UP_POINTS, MIN_LOOK_UP_TILES, MIN_TREE_POINTS, MIN_TREE_TILES,
    POINTS_PER_EXPECTED_NODE, ROUNDING_POINTS,
};
use crate::tree::lazy_tree::LazyTree;
use crate::tree::rounds::sum_over_tree;
use magsplice_direct::batches::PointProgress;
use magsplice_direct::direct_sum::DirectSum;

/// Writes B or H at all points. Returns the points without a field, where `field` is NaN.
pub(crate) fn at_points(
    direct: &DirectSum,
    tree: &LazyTree,
    tolerance: Tolerance,
    quantity: Quantity,
    points: &[DVec3],
    field: &mut [DVec3],
    progress: PointProgress,
) -> Vec<PointError> {
    let chunks = points.chunks(MAX_SORTED_POINTS).zip(field.chunks_mut(MAX_SORTED_POINTS)).enumerate();
    let errors = chunks.map(|(number, (points, field))| {
        let mut errors = at_some_points(direct, tree, tolerance, quantity, points, field, progress);
        errors.iter_mut().for_each(|error| error.index += number * MAX_SORTED_POINTS);
        errors
    });
    // The first list is not copied, because it is usually the only one.
    errors
        .reduce(|mut all, errors| {
            all.extend(errors);
            all
        })
        .unwrap_or_default()
}

fn at_some_points(
    direct: &DirectSum,
    tree: &LazyTree,
    tolerance: Tolerance,
    quantity: Quantity,
    points: &[DVec3],
    field: &mut [DVec3],
    progress: PointProgress,
) -> Vec<PointError> {
    let usable: Vec<u32> = match fitted(direct, tolerance, points) {
        Some(fitted) => {
            // All points are in the box. Errors are points where |B| is too small.
            let weak = fitted.flux_density_into(points, field).err().map_or(Vec::new(), |errors| errors.0);
            if quantity == Quantity::FieldStrength {
                field.par_iter_mut().for_each(|h| *h /= MU_0);
            }
            let weak: Vec<usize> = weak.into_iter().map(|error| error.index).collect();
            progress(points.len());
            return exact_at(direct, tolerance, quantity, points, &weak, field, &|_| progress(0));
        }
        None if direct.tiles().len() < MIN_TREE_TILES => {
            return direct.field_within_into(tolerance, quantity, points, field, progress);
        }
        None => (0..points.len() as u32).filter(|&index| is_in_range(points[index as usize])).collect(),
    };
    if !tree_pays(direct, tolerance, points, &usable) {
        return direct.field_within_into(tolerance, quantity, points, field, progress);
    }
    let outside: Vec<usize> = (0..points.len()).filter(|&index| !is_in_range(points[index])).collect();
    progress(outside.len());
    let tiles = (direct, tree.get(direct));
    let (mut errors, mut exact) = sum_over_tree(tiles, tolerance, quantity, points, usable, field, progress);
    exact.extend(outside);
    // All points have begun.
    errors.extend(exact_at(direct, tolerance, quantity, points, &exact, field, &|_| progress(0)));
    errors.sort_by_key(|error| error.index);
    errors
}

/// Whether the tree can be faster than direct summation, judged by the numbers of tiles and points
/// and by the rounding of its sums at some of the `usable` points.
pub(crate) fn tree_pays(direct: &DirectSum, tolerance: Tolerance, points: &[DVec3], usable: &[u32]) -> bool {
    if direct.tiles().len() < MIN_TREE_TILES || usable.len() < MIN_TREE_POINTS {
        return false;
    }
    let step = usable.len() / ROUNDING_POINTS;
    let some: Vec<DVec3> = usable.iter().step_by(step).map(|&index| points[index as usize]).collect();
    let mut field = vec![DVec3::ZERO; some.len()];
    // The field of refused points is NaN, which keeps no tolerance.
    let _ = direct.exact_field_into(Quantity::FluxDensity, &some, &mut field);
    let magnitudes_t = direct.magnitudes_t(&some);
    // The other half of the tolerance is for truncation.
    let rounding = 2.0 * STRETCHED_BOUND;
    let kept = field.iter().zip(magnitudes_t).filter(|(b, t)| tolerance.is_kept(**b, rounding * t)).count();
    2 * kept > some.len()
}

/// Writes the exact field at the points with these indices, where it keeps the tolerance; returns
/// the other points, where `field` is NaN.
fn exact_at(
    direct: &DirectSum,
    tolerance: Tolerance,
    quantity: Quantity,
    points: &[DVec3],
    indices: &[usize],
    field: &mut [DVec3],
    progress: PointProgress,
) -> Vec<PointError> {
    let chosen: Vec<DVec3> = indices.iter().map(|&index| points[index]).collect();
    let mut values = vec![DVec3::ZERO; chosen.len()];
    let errors = direct.field_within_into(tolerance, quantity, &chosen, &mut values, progress);
    for (&index, value) in indices.iter().zip(values) {
        field[index] = value;
    }
    errors.into_iter().map(|error| PointError { index: indices[error.index], ..error }).collect()
}

/// The interpolation of the bounding box of points. `None` if the tree is faster, because there are
/// too few points or tiles, or if tiles are too near.
pub(crate) fn fitted(direct: &DirectSum, tolerance: Tolerance, points: &[DVec3]) -> Option<FittedField> {
    let pays = points.len() >= MIN_LOOK_UP_POINTS && direct.tiles().len() >= MIN_LOOK_UP_TILES;
    if !pays || !points.iter().all(|point| is_in_range(*point)) {
        return None;
    }
    let region = BoundingBox::from_points(points);
    if !is_promising(direct, &region, tolerance, points.len() / POINTS_PER_EXPECTED_NODE) {
        return None;
    }
    let BoundingBox { lower, upper } = region;
    FittedField::from_samples(direct, lower, upper, tolerance, points.len() / LOOK_UP_POINTS_PER_NODE).ok()
}

/// Writes B or H at all points of a grid, z fastest. Returns the points without a field, where
/// `field` is NaN.
pub(crate) fn on_grid(
    direct: &DirectSum,
    tree: &LazyTree,
    tolerance: Tolerance,
    quantity: Quantity,
    grid: &Grid,
    field: &mut [DVec3],
    progress: PointProgress,
) -> Vec<PointError> {
    let fits = GridFits::new(direct, tolerance, grid, progress);
    if fits.fitted.is_empty() {
        let points: Vec<DVec3> = grid.points().collect();
        return at_points(direct, tree, tolerance, quantity, &points, field, progress);
    }
    let rest = fits.evaluate(direct.level(), tolerance, grid, field);
    progress(grid.len() - rest.len());
    if quantity == Quantity::FieldStrength {
        // No interpolated point is in a tile, so H is B / mu0.
        field.par_iter_mut().for_each(|h| *h /= MU_0);
    }
    let points: Vec<DVec3> = rest.iter().map(|&index| grid.point(index)).collect();
    let mut values = vec![DVec3::ZERO; points.len()];
    let errors = at_points(direct, tree, tolerance, quantity, &points, &mut values, progress);
    for (&index, value) in rest.iter().zip(values) {
        field[index] = value;
    }
    let errors = errors.into_iter().map(|error| PointError { index: rest[error.index], ..error });
    let mut errors: Vec<PointError> = errors.collect();
    errors.sort_by_key(|error| error.index);
    errors
}

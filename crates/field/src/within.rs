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
    LARGEST_LIST_COST, LOOK_UP_POINTS_PER_NODE, MAX_SORTED_POINTS, MIN_FIT_POINTS, MIN_LOOK_UP_COST,
    MIN_LOOK_UP_POINTS, MIN_TREE_COST, MIN_TREE_POINTS, NEIGHBOURHOOD_SAMPLES, POINTS_PER_EXPECTED_NODE,
    POINTS_PER_LIST, TREE_SAMPLES,
};
use crate::tree::lazy_tree::LazyTree;
use crate::tree::rounds::{TilesAndTree, expected_list_cost, sum_over_tree, tolerance_t};
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
    let exact = |field: &mut [DVec3]| direct.field_within_into(tolerance, quantity, points, field, progress);
    // No model is built for so few points, whatever their cost, which takes time to count.
    const { assert!(MIN_TREE_POINTS <= MIN_LOOK_UP_POINTS) };
    if points.len() < MIN_TREE_POINTS {
        return exact(field);
    }
    let exact_cost = direct.cost(points.len(), |number| points[number]);
    if exact_cost < MIN_LOOK_UP_COST.min(MIN_TREE_COST) {
        return exact(field);
    }
    let usable: Vec<u32> = match fitted(direct, exact_cost, tolerance, points) {
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
        None => (0..points.len() as u32).filter(|&index| is_in_range(points[index as usize])).collect(),
    };
    if !tree_pays(direct, tree, exact_cost, tolerance, points, &usable) {
        return exact(field);
    }
    let outside: Vec<usize> = (0..points.len()).filter(|&index| !is_in_range(points[index])).collect();
    progress(outside.len());
    let tiles = TilesAndTree { direct, tree: tree.get(direct), exact_cost };
    let (mut errors, mut exact) = sum_over_tree(tiles, tolerance, quantity, points, usable, field, progress);
    exact.extend(outside);
    // All points have begun.
    errors.extend(exact_at(direct, tolerance, quantity, points, &exact, field, &|_| progress(0)));
    errors.sort_by_key(|error| error.index);
    errors
}

/// Whether the tree is expected to be faster than direct summation, which costs `exact_cost` at a
/// point. It is judged at some of the `usable` points by the interaction lists of their
/// neighbourhoods and by the rounding of the tree's sums.
pub(crate) fn tree_pays(
    direct: &DirectSum,
    tree: &LazyTree,
    exact_cost: f64,
    tolerance: Tolerance,
    points: &[DVec3],
    usable: &[u32],
) -> bool {
    if usable.len() < MIN_TREE_POINTS || exact_cost < MIN_TREE_COST {
        return false;
    }
    let some = |count: usize| -> Vec<DVec3> {
        let chosen = usable.iter().step_by(usable.len().div_ceil(count));
        chosen.map(|&index| points[index as usize]).collect()
    };
    let (some, others) = (some(TREE_SAMPLES), some(NEIGHBOURHOOD_SAMPLES));
    let around: Vec<BoundingBox> = some.iter().map(|at| neighbourhood(*at, &others, usable.len())).collect();
    let tiles = TilesAndTree { direct, tree: tree.get(direct), exact_cost };
    let pays = |tolerances_t: &[f64]| {
        let lists = some.iter().zip(&around).zip(tolerances_t);
        let cost = lists.map(|((at, around), own_t)| expected_list_cost(tiles, *at, around, *own_t)).sum::<f64>();
        cost <= LARGEST_LIST_COST * exact_cost * some.len() as f64
    };
    // The largest field is below J nearly everywhere. This test needs no field.
    if !pays(&vec![tolerance_t(tolerance, tiles.tree.largest_j_t()); some.len()]) {
        return false;
    }
    let mut field = vec![DVec3::ZERO; some.len()];
    // The field of refused points is NaN, which keeps no tolerance.
    let _ = direct.exact_field_into(Quantity::FluxDensity, &some, &mut field);
    let magnitudes_t = direct.magnitudes_t(&some);
    // The other half of the tolerance is for truncation.
    let rounding = 2.0 * STRETCHED_BOUND;
    let kept = field.iter().zip(magnitudes_t).filter(|(b, t)| tolerance.is_kept(**b, rounding * t)).count();
    let own_t = |b: &DVec3| if b.is_nan() { 0.0 } else { tolerance_t(tolerance, b.length()) };
    let own_t: Vec<f64> = field.iter().map(own_t).collect();
    2 * kept > some.len() && pays(&own_t)
}

/// About the box of the points that share an interaction list with `point`. `others` are evenly
/// chosen from all `count` points.
fn neighbourhood(point: DVec3, others: &[DVec3], count: usize) -> BoundingBox {
    let mut distances: Vec<f64> = others.iter().map(|other| (*other - point).abs().max_element()).collect();
    // A box of neighbours has its centre anywhere near one of them.
    let share = POINTS_PER_LIST as f64 / count as f64 * others.len() as f64;
    let number = (share as usize).clamp(1, others.len() - 1);
    let distance = *distances.select_nth_unstable_by(number, f64::total_cmp).1;
    let half = distance * (share / number as f64).cbrt().min(1.0);
    BoundingBox { lower: point - half, upper: point + half }
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

/// The interpolation of the bounding box of points. `None` if the exact field, which costs
/// `exact_cost` at a point, or the tree is faster, or if tiles are too near.
pub(crate) fn fitted(
    direct: &DirectSum,
    exact_cost: f64,
    tolerance: Tolerance,
    points: &[DVec3],
) -> Option<FittedField> {
    let pays = points.len() >= MIN_LOOK_UP_POINTS && exact_cost >= MIN_LOOK_UP_COST;
    if !pays || !points.iter().all(|point| is_in_range(*point)) {
        return None;
    }
    let region = BoundingBox::from_points(points);
    let max_nodes = (points.len() / POINTS_PER_EXPECTED_NODE) as f64;
    if !is_promising(direct, &region, tolerance, |outlook| outlook.nodes.element_product() <= max_nodes) {
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
    let fits = (grid.len() >= MIN_FIT_POINTS).then(|| GridFits::new(direct, tolerance, grid, progress));
    let Some(fits) = fits.filter(|fits| !fits.fitted.is_empty()) else {
        let points = grid.points_in(0..grid.len());
        return at_points(direct, tree, tolerance, quantity, &points, field, progress);
    };
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

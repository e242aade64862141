//! The field on the points of a regular grid, to a tolerance.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec3;
use rayon::prelude::*;

use super::accuracy::Tolerance;
use super::at_points::at_points;
use super::chebyshev::polynomials;
use super::combine::{padded, weighted_sum};
use super::fit::{Fit, NoFit};
use super::magnitude::Box3;
use crate::evaluate::PointError;
use crate::grid::Grid;
use crate::quantity::{MU_0, Quantity};
use crate::scene::Scene;
use crate::tolerances::{FITTED_POINTS, POINTS_PER_NODE};

/// A part of a grid: indices from and to, that excluded, along x, y, z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    start: [usize; 3],
    end: [usize; 3],
}

/// B or H at all points of the grid, z fastest; points that have none, with NaN there.
pub(crate) fn on_grid(
    scene: &Scene,
    tolerance: Tolerance,
    quantity: Quantity,
    grid: &Grid,
    field: &mut [DVec3],
) -> Vec<PointError> {
    let (fitted, rest) = divided(scene, tolerance, grid);
    let mut exact: Vec<usize> = rest.iter().flat_map(|part| part.indices(grid)).collect();
    for (part, fit) in &fitted {
        evaluate(scene.level(), fit, tolerance, grid, *part, field, &mut exact);
    }
    if quantity == Quantity::FieldStrength {
        // No fitted point is in a tile.
        field.par_iter_mut().for_each(|h| *h /= MU_0);
    }
    exact.sort_unstable();
    let points: Vec<DVec3> = exact.iter().map(|&index| grid.point(index)).collect();
    let mut values = vec![DVec3::ZERO; points.len()];
    let errors = at_points(scene, tolerance, quantity, &points, &mut values);
    for (&index, value) in exact.iter().zip(values) {
        field[index] = value;
    }
    errors.into_iter().map(|error| PointError { index: exact[error.index], ..error }).collect()
}

/// The grid in parts: those that an expansion serves, and those that none does.
pub(super) fn divided(scene: &Scene, tolerance: Tolerance, grid: &Grid) -> (Vec<(Part, Fit)>, Vec<Part>) {
    let (mut fitted, mut rest) = (Vec::new(), Vec::new());
    if !grid.is_empty() {
        divide(scene, tolerance, grid, Part { start: [0; 3], end: grid.counts }, &mut fitted, &mut rest);
    }
    (fitted, rest)
}

fn divide(
    scene: &Scene,
    tolerance: Tolerance,
    grid: &Grid,
    part: Part,
    fitted: &mut Vec<(Part, Fit)>,
    rest: &mut Vec<Part>,
) {
    let points = part.len();
    let fit = if points < FITTED_POINTS {
        Err(NoFit::TooNear)
    } else {
        Fit::of(scene, part.region(grid), tolerance, points / POINTS_PER_NODE)
    };
    match fit {
        Ok(fit) => fitted.push((part, fit)),
        Err(NoFit::TooNear) if points >= 2 * FITTED_POINTS => {
            let axis = part.longest_axis(grid);
            let middle = usize::midpoint(part.start[axis], part.end[axis]);
            let (mut low, mut high) = (part, part);
            low.end[axis] = middle;
            high.start[axis] = middle;
            divide(scene, tolerance, grid, low, fitted, rest);
            divide(scene, tolerance, grid, high, fitted, rest);
        }
        Err(_) => rest.push(part),
    }
}

impl Part {
    pub(super) fn len(&self) -> usize {
        self.counts().iter().product()
    }

    pub(super) fn counts(&self) -> [usize; 3] {
        [0, 1, 2].map(|axis: usize| self.end[axis] - self.start[axis])
    }

    fn region(&self, grid: &Grid) -> Box3 {
        let corner = |at: fn(&Part, usize) -> usize| DVec3::from([0, 1, 2].map(|a| grid.coordinate(a, at(self, a))));
        let (first, last) = (corner(|part, a| part.start[a]), corner(|part, a| part.end[a] - 1));
        Box3 { lower: first.min(last), upper: first.max(last) }
    }

    fn longest_axis(&self, grid: &Grid) -> usize {
        let size = self.region(grid).half_size();
        let divisible = (0..3).filter(|&axis| self.end[axis] - self.start[axis] > 1);
        divisible.max_by(|&a, &b| size[a].total_cmp(&size[b])).expect("several points")
    }

    pub(super) fn indices(self, grid: &Grid) -> impl Iterator<Item = usize> {
        let [_, ny, nz] = grid.counts;
        let Part { start, end } = self;
        (start[0]..end[0]).flat_map(move |i| {
            (start[1]..end[1]).flat_map(move |j| (start[2]..end[2]).map(move |k| (i * ny + j) * nz + k))
        })
    }
}

/// The polynomials of a fit at the grid's coordinates along its axes.
struct Tables {
    /// For each coordinate along x and along y the values of all polynomials.
    along_x: Vec<Vec<f64>>,
    along_y: Vec<Vec<f64>>,
    /// For each polynomial along z the values at all coordinates.
    along_z: Vec<f64>,
}

impl Tables {
    fn of(fit: &Fit, grid: &Grid, part: Part) -> Tables {
        let (centre, half) = (fit.region.centre(), fit.region.half_size());
        let values = |axis: usize, index: usize| {
            let mut values = vec![0.0; fit.counts[axis]];
            let offset = grid.coordinate(axis, index) - centre[axis];
            polynomials(if half[axis] > 0.0 { offset / half[axis] } else { 0.0 }, &mut values);
            values
        };
        let along = |axis: usize| (part.start[axis]..part.end[axis]).map(|i| values(axis, i)).collect::<Vec<_>>();
        let room = padded(part.counts()[2]);
        let mut along_z = vec![0.0; fit.counts[2] * room];
        for (k, values) in along(2).into_iter().enumerate() {
            for (c, value) in values.into_iter().enumerate() {
                along_z[c * room + k] = value;
            }
        }
        Tables { along_x: along(0), along_y: along(1), along_z }
    }
}

/// The expansion at the points of a part; those at which it does not keep the tolerance are named.
fn evaluate(
    level: Level,
    fit: &Fit,
    tolerance: Tolerance,
    grid: &Grid,
    part: Part,
    field: &mut [DVec3],
    exact: &mut Vec<usize>,
) {
    let tables = Tables::of(fit, grid, part);
    let [_, ny, nz] = grid.counts;
    let planes = field.par_chunks_mut(ny * nz).enumerate().skip(part.start[0]).take(part.counts()[0]);
    let missed: Vec<usize> = planes
        .flat_map_iter(|(i, field)| {
            let weights = &tables.along_x[i - part.start[0]];
            let weakest_t = dispatch!(level, simd => plane(simd, fit, &tables, weights, part, nz, field));
            let mut missed = Vec::new();
            if !tolerance.is_kept(DVec3::X * weakest_t, fit.error_t) {
                let in_plane =
                    Part { start: [i, part.start[1], part.start[2]], end: [i + 1, part.end[1], part.end[2]] };
                let kept = |index: &usize| tolerance.is_kept(field[index - i * ny * nz], fit.error_t);
                missed.extend(in_plane.indices(grid).filter(|index| !kept(index)));
            }
            missed
        })
        .collect();
    exact.extend(missed);
}

/// One plane of constant x: first over the polynomials along x, then along y, then along z. Returns the least |B| in it.
#[inline(always)]
fn plane<S: Simd>(
    simd: S,
    fit: &Fit,
    tables: &Tables,
    weights: &[f64],
    part: Part,
    stride: usize,
    field: &mut [DVec3],
) -> f64 {
    let (slab, degrees, room) = (Fit::slab(fit.counts), fit.counts[2], padded(part.counts()[2]));
    let mut in_plane = [0, 1, 2].map(|_| vec![0.0; slab]);
    for (sum, coefficients) in in_plane.iter_mut().zip(&fit.coefficients) {
        weighted_sum(simd, weights, coefficients, sum);
    }
    let mut on_line = vec![0.0; padded(degrees)];
    let mut values = [0, 1, 2].map(|_| vec![0.0; room]);
    let mut least_square = f64::INFINITY;
    for (j, weights) in (part.start[1]..).zip(&tables.along_y) {
        for (values, coefficients) in values.iter_mut().zip(&in_plane) {
            weighted_sum(simd, weights, coefficients, &mut on_line);
            weighted_sum(simd, &on_line[..degrees], &tables.along_z, values);
        }
        let [x, y, z] = &values;
        let line = &mut field[j * stride + part.start[2]..j * stride + part.end[2]];
        for (field, ((x, y), z)) in line.iter_mut().zip(x.iter().zip(y).zip(z)) {
            *field = DVec3::new(*x, *y, *z);
            least_square = least_square.min(field.length_squared());
        }
    }
    least_square.sqrt()
}

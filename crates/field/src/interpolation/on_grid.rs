//! Interpolation on a grid: its division into boxes with a Chebyshev fit, and their evaluation.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec3;
use magsplice_cuboid::tolerances::CLOSED_FORM_COST;
use magsplice_magnet::{BoundingBox, Grid, Tolerance};
use magsplice_simd::lanes::{Lanes, Number};
use rayon::prelude::*;

use super::chebyshev::{polynomials, rows_of_polynomials};
use super::fit::{ChebyshevFit, Degrees, FitFailure};
use super::outlook::{Outlook, is_promising};
use super::weighted_sums::{PADDING, padded, weighted_sum};
use crate::tolerances::{
    FIELD_RANGE_POINTS, LARGEST_FIT_COST, LARGEST_TRIAL_COST, LINE_COST, MAX_FIT_NODES, MIN_FIT_POINTS,
    NODE_TRANSFORM_COST, PLANE_COST, SOURCE_COST,
};
use magsplice_direct::batches::PointProgress;
use magsplice_direct::direct_sum::DirectSum;

/// A part of a grid: first indices along x, y, z, and the indices after the last.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GridPart {
    start: [usize; 3],
    end: [usize; 3],
}

/// A grid divided into parts with and without a Chebyshev fit.
pub(crate) struct GridFits {
    pub(crate) fitted: Vec<(GridPart, ChebyshevFit)>,
    pub(crate) rest: Vec<GridPart>,
    /// Time left for fits that may fail, in exact fields of one tile.
    left: f64,
}

impl GridFits {
    /// Divides a grid. Parts too near to tiles for a fit are halved, down to a smallest number of
    /// points. `progress` receives 0 when a part begins.
    pub(crate) fn new(direct: &DirectSum, tolerance: Tolerance, grid: &Grid, progress: PointProgress) -> GridFits {
        let whole = GridPart { start: [0; 3], end: grid.counts() };
        let left = LARGEST_TRIAL_COST * whole.exact_cost(direct, grid);
        let mut fits = GridFits { fitted: Vec::new(), rest: Vec::new(), left };
        divide(direct, tolerance, grid, whole, &mut fits, progress);
        fits
    }

    /// Writes B in tesla at the points where a fit keeps the tolerance. Returns the indices of all
    /// other points.
    pub(crate) fn evaluate(&self, level: Level, tolerance: Tolerance, grid: &Grid, field: &mut [DVec3]) -> Vec<usize> {
        let mut rest: Vec<usize> = self.rest.iter().flat_map(|part| part.indices(grid)).collect();
        for (part, fit) in &self.fitted {
            evaluate(level, fit, tolerance, grid, *part, field, &mut rest);
        }
        rest
    }
}

fn divide(
    direct: &DirectSum,
    tolerance: Tolerance,
    grid: &Grid,
    part: GridPart,
    fits: &mut GridFits,
    progress: PointProgress,
) {
    progress(0);
    let (exact_cost, points) = (part.exact_cost(direct, grid), part.len() as f64);
    // A node takes an exact field and the transform of its values.
    let pays = |nodes: [f64; 3], exact_values: f64| {
        let node_cost = exact_values * (exact_cost / points + NODE_TRANSFORM_COST);
        node_cost + part.cost_of_sums(nodes) <= LARGEST_FIT_COST * exact_cost
    };
    let mut trial_cost = 0.0;
    let is_affordable = |outlook: &Outlook| {
        trial_cost = SOURCE_COST * outlook.sources + FIELD_RANGE_POINTS * exact_cost / points;
        trial_cost <= fits.left && pays(outlook.nodes.to_array(), outlook.nodes.element_product())
    };
    let region = part.region(grid);
    let fit = if part.len() < MIN_FIT_POINTS || !is_promising(direct, &region, tolerance, is_affordable) {
        Err(FitFailure::TooNear)
    } else {
        fits.left -= trial_cost;
        ChebyshevFit::new(direct, region, tolerance, pays)
    };
    match fit {
        Ok(fit) => {
            fits.left += trial_cost;
            fits.fitted.push((part, fit));
        }
        // Near a single tile, attempts to fit parts of a grid take more time than fits save.
        Err(FitFailure::TooNear) if part.len() >= 2 * MIN_FIT_POINTS && direct.tiles().len() > 1 => {
            let axis = part.longest_axis(grid);
            let middle = usize::midpoint(part.start[axis], part.end[axis]);
            let (mut low, mut high) = (part, part);
            low.end[axis] = middle;
            high.start[axis] = middle;
            divide(direct, tolerance, grid, low, fits, progress);
            divide(direct, tolerance, grid, high, fits, progress);
        }
        Err(_) => fits.rest.push(part),
    }
}

impl GridPart {
    /// Number of points.
    pub(crate) fn len(&self) -> usize {
        self.counts().iter().product()
    }

    /// Numbers of points along x, y, z.
    pub(crate) fn counts(&self) -> [usize; 3] {
        [0, 1, 2].map(|axis: usize| self.end[axis] - self.start[axis])
    }

    /// Time of the exact field at all points, in exact fields of one tile.
    fn exact_cost(self, direct: &DirectSum, grid: &Grid) -> f64 {
        let [_, ny, nz] = self.counts();
        let point = |n: usize| {
            let [i, j, k] = [n / (ny * nz), n / nz % ny, n % nz];
            let index = |axis: usize, own: usize| grid.coordinate(axis, self.start[axis] + own);
            DVec3::new(index(0, i), index(1, j), index(2, k))
        };
        self.len() as f64 * direct.cost(self.len(), point)
    }

    /// Time of the sums over polynomials with these numbers of nodes, in exact fields of one tile:
    /// three components, along x for each plane, along y for each line, and along z for each point.
    pub(crate) fn cost_of_sums(self, [x, y, z]: [f64; 3]) -> f64 {
        let [planes, lines, points] = self.counts().map(|count| count as f64);
        let (lines, row) = (planes * lines, (z / PADDING as f64).ceil() * PADDING as f64);
        let points = lines * (points / PADDING as f64).ceil() * PADDING as f64;
        let sums = 3.0 * (planes * x * y * row + lines * y * row + points * z);
        sums / CLOSED_FORM_COST + PLANE_COST * planes + LINE_COST * lines
    }

    fn region(&self, grid: &Grid) -> BoundingBox {
        let corner =
            |index: fn(&GridPart, usize) -> usize| DVec3::from([0, 1, 2].map(|a| grid.coordinate(a, index(self, a))));
        let (first, last) = (corner(|part, a| part.start[a]), corner(|part, a| part.end[a] - 1));
        BoundingBox { lower: first.min(last), upper: first.max(last) }
    }

    fn longest_axis(&self, grid: &Grid) -> usize {
        let size = self.region(grid).half_size();
        let divisible = (0..3).filter(|&axis| self.end[axis] - self.start[axis] > 1);
        divisible.max_by(|&a, &b| size[a].total_cmp(&size[b])).expect("several points")
    }

    /// Indices of the points in the grid, z fastest.
    pub(crate) fn indices(self, grid: &Grid) -> impl Iterator<Item = usize> {
        let [_, ny, nz] = grid.counts();
        let GridPart { start, end } = self;
        (start[0]..end[0]).flat_map(move |i| {
            (start[1]..end[1]).flat_map(move |j| (start[2]..end[2]).map(move |k| (i * ny + j) * nz + k))
        })
    }
}

/// The polynomials of a fit at the grid's coordinates along each axis.
struct PolynomialTables {
    /// For each coordinate along x and along y, the values of all polynomials.
    along: [Vec<f64>; 2],
    /// For each polynomial along z, the values at all coordinates.
    along_z: Vec<f64>,
}

impl PolynomialTables {
    fn new(fit: &ChebyshevFit, grid: &Grid, part: GridPart) -> PolynomialTables {
        let (centre, half) = (fit.region.centre(), fit.region.half_size());
        let place = |axis: usize, index: usize| {
            let offset = grid.coordinate(axis, index) - centre[axis];
            if half[axis] > 0.0 { offset / half[axis] } else { 0.0 }
        };
        let places = |axis: usize| (part.start[axis]..part.end[axis]).map(move |index| place(axis, index));
        let along = |axis: usize| {
            let mut table = vec![0.0; part.counts()[axis] * fit.counts[axis]];
            table.chunks_exact_mut(fit.counts[axis]).zip(places(axis)).for_each(|(row, at)| polynomials(at, row));
            table
        };
        let heights: Vec<f64> = places(2).collect();
        PolynomialTables { along: [along(0), along(1)], along_z: rows_of_polynomials(&heights, fit.counts[2]) }
    }

    /// Calls `work` with the values of the polynomials of these degrees at a coordinate along an
    /// axis.
    #[inline(always)]
    fn with_weights(&self, axis: usize, count: usize, index: usize, degrees: Degrees, work: impl FnOnce(&[f64])) {
        let values = &self.along[axis][index * count..(index + 1) * count];
        if degrees == Degrees::All {
            return work(values);
        }
        let mut chosen = [0.0; MAX_FIT_NODES];
        let mut number = 0;
        for degree in degrees.below(count) {
            chosen[number] = values[degree];
            number += 1;
        }
        work(&chosen[..number]);
    }
}

/// Coefficients of the three components in a plane of constant x, and on a line of constant x and
/// y.
struct PartialSums {
    in_plane: [Vec<f64>; 3],
    on_line: [Vec<f64>; 3],
}

/// Writes the interpolated field at the points of a part. Points where the field does not keep the
/// tolerance are added to `rest`.
fn evaluate(
    level: Level,
    fit: &ChebyshevFit,
    tolerance: Tolerance,
    grid: &Grid,
    part: GridPart,
    field: &mut [DVec3],
    rest: &mut Vec<usize>,
) {
    let tables = PolynomialTables::new(fit, grid, part);
    let [_, ny, nz] = grid.counts();
    let planes = field.par_chunks_mut(ny * nz).enumerate().skip(part.start[0]).take(part.counts()[0]);
    let sums = || PartialSums {
        in_plane: [0, 1, 2].map(|component| vec![0.0; fit.slab_len(component)]),
        on_line: [0, 1, 2].map(|_| vec![0.0; padded(fit.counts[2])]),
    };
    let missed = planes.map_init(sums, |sums, (i, field)| {
        let plane = i - part.start[0];
        let weakest_t = dispatch!(level, simd => evaluate_plane(simd, fit, &tables, plane, part, nz, sums, field));
        if tolerance.is_kept(DVec3::X * weakest_t, fit.error_t) {
            return Vec::new();
        }
        let in_plane = GridPart { start: [i, part.start[1], part.start[2]], end: [i + 1, part.end[1], part.end[2]] };
        let kept = |index: &usize| tolerance.is_kept(field[index - i * ny * nz], fit.error_t);
        in_plane.indices(grid).filter(|index| !kept(index)).collect()
    });
    let missed: Vec<Vec<usize>> = missed.collect();
    rest.extend(missed.into_iter().flatten());
}

/// Writes the field in one plane of constant x, summing over the polynomials along x first, then
/// along y, then along z. Returns the smallest |B| in the plane.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "a closure would not be inlined")]
fn evaluate_plane<S: Simd>(
    simd: S,
    fit: &ChebyshevFit,
    tables: &PolynomialTables,
    plane: usize,
    part: GridPart,
    stride: usize,
    PartialSums { in_plane, on_line }: &mut PartialSums,
    field: &mut [DVec3],
) -> f64 {
    for (component, sum) in in_plane.iter_mut().enumerate() {
        tables.with_weights(
            0,
            fit.counts[0],
            plane,
            fit.degrees[component][0],
            #[inline(always)]
            |weights| weighted_sum(simd, weights, &fit.coefficients[component], sum),
        );
    }
    let mut least_square = f64::INFINITY;
    for j in 0..part.counts()[1] {
        for (component, (sum, coefficients)) in on_line.iter_mut().zip(&*in_plane).enumerate() {
            tables.with_weights(
                1,
                fit.counts[1],
                j,
                fit.degrees[component][1],
                #[inline(always)]
                |weights| weighted_sum(simd, weights, coefficients, sum),
            );
        }
        let start = (part.start[1] + j) * stride;
        let line = &mut field[start + part.start[2]..start + part.end[2]];
        least_square = least_square.min(evaluate_line(simd, on_line, fit.counts[2], &tables.along_z, line));
    }
    least_square.sqrt()
}

/// Writes the field on a line along z. `on_line` holds the coefficients of the three components.
/// Returns the smallest |B|^2.
///
/// All components of two vectors of points are summed in registers.
#[inline(always)]
fn evaluate_line<S: Simd>(
    simd: S,
    on_line: &[Vec<f64>; 3],
    degrees: usize,
    along_z: &[f64],
    line: &mut [DVec3],
) -> f64 {
    let length = Lanes::<S>::LEN;
    let zero = Lanes::<S>::splat(simd, 0.0);
    let stride = padded(line.len());
    let [x, y, z] = on_line;
    let (x, y, z) = (&x[..degrees], &y[..degrees], &z[..degrees]);
    let mut least = Lanes::<S>::splat(simd, f64::INFINITY);
    let mut values = [[0.0; PADDING]; 3];
    for (start, points) in (0..).step_by(2 * length).zip(line.chunks_mut(2 * length)) {
        let mut sums = [[zero; 3]; 2];
        for (((row, &x), &y), &z) in along_z.chunks_exact(stride).zip(x).zip(y).zip(z) {
            let row = &row[start..start + 2 * length];
            for (half, sums) in sums.iter_mut().enumerate() {
                let polynomial = Lanes::<S>::load(simd, &row[half * length..(half + 1) * length]);
                sums[0] = polynomial.scale_add(x, sums[0]);
                sums[1] = polynomial.scale_add(y, sums[1]);
                sums[2] = polynomial.scale_add(z, sums[2]);
            }
        }
        for (half, sums) in sums.iter().enumerate() {
            for (value, values) in sums.iter().zip(&mut values) {
                value.store(&mut values[half * length..(half + 1) * length]);
            }
        }
        if points.len() == 2 * length {
            for sums in sums {
                let [x, y, z] = sums;
                least = least.min(z.mul_add(z, y.mul_add(y, x * x)));
            }
        } else {
            let square = |n: usize| values[0][n].powi(2) + values[1][n].powi(2) + values[2][n].powi(2);
            let smallest = (0..points.len()).map(square).fold(f64::INFINITY, f64::min);
            least = least.min(Lanes::<S>::splat(simd, smallest));
        }
        let [x, y, z] = &values;
        for (((point, x), y), z) in points.iter_mut().zip(x).zip(y).zip(z) {
            *point = DVec3::new(*x, *y, *z);
        }
    }
    (0..length).map(|lane| least.lane(lane)).fold(f64::INFINITY, f64::min)
}

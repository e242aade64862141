//! Interpolation on a grid: its division into boxes with a Chebyshev fit, and their evaluation.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec3;
use magsplice_magnet::{BoundingBox, Grid, Tolerance};
use magsplice_simd::lanes::{Lanes, Number};
use rayon::prelude::*;

use super::chebyshev::polynomials;
use super::fit::{ChebyshevFit, FitFailure};
use super::outlook::is_promising;
use super::weighted_sums::{PADDING, padded, weighted_sum};
use crate::tolerances::{
    GRID_POINTS_PER_NODE, MIN_FIT_PAIRS, MIN_FIT_POINTS, MIN_LOOK_UP_TILES, NODE_TRANSFORM_TILES,
    POINTS_PER_EXPECTED_NODE,
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
}

impl GridFits {
    /// Divides a grid. Parts too near to tiles for a fit are halved, down to a smallest number of
    /// points. `progress` receives 0 when a part begins.
    pub(crate) fn new(direct: &DirectSum, tolerance: Tolerance, grid: &Grid, progress: PointProgress) -> GridFits {
        let mut fits = GridFits { fitted: Vec::new(), rest: Vec::new() };
        let whole = GridPart { start: [0; 3], end: grid.counts() };
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
    let points = part.len();
    let tiles = direct.tiles().len();
    let few_tiles = tiles < MIN_LOOK_UP_TILES;
    let min_points = MIN_FIT_POINTS.max(MIN_FIT_PAIRS / tiles.max(1));
    let points_per_node = GRID_POINTS_PER_NODE + NODE_TRANSFORM_TILES / tiles.max(1);
    let expected = points / if few_tiles { POINTS_PER_EXPECTED_NODE } else { GRID_POINTS_PER_NODE };
    let fit = if points < min_points || !is_promising(direct, &part.region(grid), tolerance, expected) {
        Err(FitFailure::TooNear)
    } else {
        ChebyshevFit::new(direct, part.region(grid), tolerance, points / points_per_node)
    };
    match fit {
        Ok(fit) => fits.fitted.push((part, fit)),
        // Near a single tile, attempts to fit parts of a grid take more time than fits save.
        Err(FitFailure::TooNear) if points >= 2 * min_points && tiles > 1 => {
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
    /// For each component and each coordinate along x and along y, the values of its polynomials.
    along_x: [Vec<Vec<f64>>; 3],
    along_y: [Vec<Vec<f64>>; 3],
    /// For each polynomial along z, the values at all coordinates.
    along_z: Vec<f64>,
}

impl PolynomialTables {
    fn new(fit: &ChebyshevFit, grid: &Grid, part: GridPart) -> PolynomialTables {
        let (centre, half) = (fit.region.centre(), fit.region.half_size());
        let values = |axis: usize, index: usize| {
            let mut values = vec![0.0; fit.counts[axis]];
            let offset = grid.coordinate(axis, index) - centre[axis];
            polynomials(if half[axis] > 0.0 { offset / half[axis] } else { 0.0 }, &mut values);
            values
        };
        let along = |axis: usize| (part.start[axis]..part.end[axis]).map(|i| values(axis, i)).collect::<Vec<_>>();
        let of_components = |axis: usize| {
            let all = along(axis);
            fit.degrees.map(|degrees| {
                let own = |values: &Vec<f64>| degrees[axis].below(values.len()).map(|degree| values[degree]).collect();
                all.iter().map(own).collect()
            })
        };
        let stride = padded(part.counts()[2]);
        let mut along_z = vec![0.0; fit.counts[2] * stride];
        for (k, values) in along(2).into_iter().enumerate() {
            for (c, value) in values.into_iter().enumerate() {
                along_z[c * stride + k] = value;
            }
        }
        PolynomialTables { along_x: of_components(0), along_y: of_components(1), along_z }
    }
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
    let missed: Vec<usize> = planes
        .flat_map_iter(|(i, field)| {
            let plane = i - part.start[0];
            let weakest_t = dispatch!(level, simd => evaluate_plane(simd, fit, &tables, plane, part, nz, field));
            let mut missed = Vec::new();
            if !tolerance.is_kept(DVec3::X * weakest_t, fit.error_t) {
                let in_plane =
                    GridPart { start: [i, part.start[1], part.start[2]], end: [i + 1, part.end[1], part.end[2]] };
                let kept = |index: &usize| tolerance.is_kept(field[index - i * ny * nz], fit.error_t);
                missed.extend(in_plane.indices(grid).filter(|index| !kept(index)));
            }
            missed
        })
        .collect();
    rest.extend(missed);
}

/// Writes the field in one plane of constant x, summing over the polynomials along x first, then
/// along y, then along z. Returns the smallest |B| in the plane.
#[inline(always)]
fn evaluate_plane<S: Simd>(
    simd: S,
    fit: &ChebyshevFit,
    tables: &PolynomialTables,
    plane: usize,
    part: GridPart,
    stride: usize,
    field: &mut [DVec3],
) -> f64 {
    let mut in_plane = [0, 1, 2].map(|component| vec![0.0; fit.slab_len(component)]);
    for (component, sum) in in_plane.iter_mut().enumerate() {
        weighted_sum(simd, &tables.along_x[component][plane], &fit.coefficients[component], sum);
    }
    let mut on_line = [0, 1, 2].map(|_| vec![0.0; padded(fit.counts[2])]);
    let mut least_square = f64::INFINITY;
    for j in 0..part.counts()[1] {
        for (component, (sum, coefficients)) in on_line.iter_mut().zip(&in_plane).enumerate() {
            weighted_sum(simd, &tables.along_y[component][j], coefficients, sum);
        }
        let start = (part.start[1] + j) * stride;
        let line = &mut field[start + part.start[2]..start + part.end[2]];
        least_square = least_square.min(evaluate_line(simd, &on_line, fit.counts[2], &tables.along_z, line));
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

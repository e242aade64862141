//! A box prepared for repeated look-ups.

use std::fmt;

use fearless_simd::{Level, dispatch};
use glam::{DMat3, DVec3};
use magsplice_magnet::{BoundingBox, Tolerance};
use rayon::prelude::*;

use super::cells::Cells;
use super::fit::{Fit, FitFailure};
use super::harmonic_potential::{CELL, field as harmonic_field, gradient};
use crate::direct::direct_sum::DirectSum;
use crate::tolerances::{CELL_DEGREE, CELL_FALL, CELL_ROUNDS, LOOKED_UP_TOGETHER, MOST_CELLS, MOST_FITTED_NODES};

/// B in a box without tiles, prepared for repeated look-ups: the box is divided into cells, and in each the field is the gradient of one harmonic
/// polynomial of degree 10, without divergence or curl.
///
/// # Cost
/// Making it takes some thousand exact values. A look-up among many, which are sorted by cell, takes 500 operations of vectors for as many points
/// as a vector has lanes, whatever the number of tiles; a single one 300 for itself.
///
/// # Memory
/// 2.7 kB for each cell; their number grows with the inverse tolerance, to 400 cells for a fraction of 1e-9 in the published working
/// volume. See [`FittedField::memory_bytes`].
///
/// # Accuracy
/// [`FittedField::error_t`] at most at each point of the box: the estimate for the expansion of the whole box, which is checked against the exact field at
/// points of it, from the last coefficients, doubled for what appears as lower ones; and what its cells leave out of that expansion, the sum of the coefficients of the
/// difference (docs/physics.md, section 5). For a relative tolerance it is small beside |B| wherever |B| is at least a hundredth of
/// its most in the box; [`FittedField::flux_density_into`] names the points where the tolerance does not hold.
#[derive(Clone, Debug)]
pub struct FittedField {
    pub(super) region: BoundingBox,
    tolerance: Tolerance,
    pub(super) cells: [usize; 3],
    exact_values: usize,
    cell_size: DVec3,
    /// One over it, and finite.
    pub(super) per_cell: DVec3,
    /// One over half the longest side of a cell.
    pub(super) scale: f64,
    /// [`CELL`] for each cell.
    pub(super) numbers: Vec<f64>,
    error_t: f64,
    gradient_error_t: f64,
    pub(super) level: Level,
}

/// Why a box cannot be prepared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FittedFieldError {
    /// The corners are not finite numbers, or lower is not below upper along every axis.
    NoBox,
    /// Tiles are in the box, or so close that an expansion would take more than its share of memory.
    TooNear,
    /// The tolerance is below what rounding leaves of exact values.
    TooExact,
}

/// A point that cannot be looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookUpError {
    /// Index into the points that were asked for.
    pub index: usize,
    /// The point.
    pub point: DVec3,
    /// Whether it is outside the box; otherwise |B| is too small there for the tolerance.
    pub outside: bool,
}

impl FittedField {
    /// Prepares the box between two corners.
    ///
    /// # Errors
    /// See [`FittedFieldError`].
    pub(crate) fn new(
        direct: &DirectSum,
        lower: DVec3,
        upper: DVec3,
        tolerance: Tolerance,
    ) -> Result<FittedField, FittedFieldError> {
        FittedField::from_samples(direct, lower, upper, tolerance, MOST_FITTED_NODES)
    }

    /// By at most `most_nodes` exact values.
    pub(crate) fn from_samples(
        direct: &DirectSum,
        lower: DVec3,
        upper: DVec3,
        tolerance: Tolerance,
        most_nodes: usize,
    ) -> Result<FittedField, FittedFieldError> {
        if !(lower.is_finite() && upper.is_finite() && lower.cmplt(upper).all()) {
            return Err(FittedFieldError::NoBox);
        }
        let region = BoundingBox { lower, upper };
        // Half of the error for the expansion of the whole box, half for the cells.
        let half = tolerance.scaled(0.5).map_err(|_| FittedFieldError::TooExact)?;
        let fit = Fit::new(direct, region, half, most_nodes).map_err(|why| match why {
            FitFailure::TooNear => FittedFieldError::TooNear,
            FitFailure::TooExact => FittedFieldError::TooExact,
        })?;
        let size = upper - lower;
        let mut cells = [1_usize; 3];
        for _ in 0..CELL_ROUNDS {
            if cells.iter().product::<usize>() > MOST_CELLS {
                return Err(FittedFieldError::TooNear);
            }
            let cell_size = size / DVec3::from(cells.map(|count| count as f64));
            // The half of a cell's longest side becomes one.
            let scale = 2.0 / cell_size.max_element();
            let Cells { numbers, left_out_t } = Cells::new(direct.level(), &fit, cells, scale);
            let error_t = fit.error_t + left_out_t;
            if left_out_t <= fit.wanted_t {
                let per_length = |axis: usize| {
                    let (whole, cell) = (fit.counts[axis] as f64, (CELL_DEGREE + 1) as f64);
                    2.0 * (whole.powi(2) / size[axis]).max(cell.powi(2) / cell_size[axis])
                };
                // A polynomial's slope is at most degree^2 times its values in the half length, and so the slope of what is left out, twice for
                // higher degrees.
                let gradient_error_t = 2.0 * error_t * [0, 1, 2].map(per_length).into_iter().fold(0.0, f64::max);
                return Ok(FittedField {
                    region,
                    tolerance,
                    cells,
                    exact_values: fit.counts.iter().product(),
                    cell_size,
                    per_cell: cell_size.recip().min(DVec3::MAX),
                    scale,
                    numbers,
                    error_t,
                    gradient_error_t,
                    level: direct.level(),
                });
            }
            // Cells are as nearly cubes as may be.
            let finer = (left_out_t / fit.wanted_t).powf(1.0 / CELL_FALL);
            let side = cell_size.max_element() / finer;
            let before = cells;
            cells = [0, 1, 2].map(|axis: usize| before[axis].max((size[axis] / side).ceil() as usize));
            if cells == before {
                cells = before.map(|count| count + 1);
            }
        }
        Err(FittedFieldError::TooNear)
    }

    /// The most the field may be off in the box, in tesla.
    pub fn error_t(&self) -> f64 {
        self.error_t
    }

    /// The most a component of the gradient may be off in the box, in tesla per unit of length: estimated from [`FittedField::error_t`], and
    /// usually many times too large.
    pub fn gradient_error_t(&self) -> f64 {
        self.gradient_error_t
    }

    /// How many cells there are along x, y, z.
    pub fn cells(&self) -> [usize; 3] {
        self.cells
    }

    /// How many exact values it was made from.
    pub fn exact_values(&self) -> usize {
        self.exact_values
    }

    /// What it occupies.
    pub fn memory_bytes(&self) -> usize {
        self.numbers.len() * size_of::<f64>()
    }

    /// B at a point, in tesla, off by at most [`FittedField::error_t`] whatever |B| is there; `None` outside the box.
    pub fn flux_density(&self, point: DVec3) -> Option<DVec3> {
        if !self.is_inside(point) {
            return None;
        }
        let (numbers, centre) = self.numbers_and_centre(self.cell(point));
        let place = (point - DVec3::from(centre)) * self.scale;
        Some(dispatch!(self.level, simd => harmonic_field(simd, numbers, place)))
    }

    /// The gradient of B at a point: column j is dB/dx_j, in tesla per unit of length, off by at most
    /// [`FittedField::gradient_error_t`]; `None` outside the box. Like that of the field itself it has no trace and is symmetric.
    pub fn flux_density_gradient(&self, point: DVec3) -> Option<DMat3> {
        if !self.is_inside(point) {
            return None;
        }
        let (numbers, centre) = self.numbers_and_centre(self.cell(point));
        Some(gradient(numbers, (point - DVec3::from(centre)) * self.scale) * self.scale)
    }

    /// B at many points, in parallel.
    ///
    /// # Errors
    /// All points outside the box, and those where |B| is too small for a relative tolerance; their entries of `field` are then NaN and all others are
    /// valid.
    ///
    /// # Panics
    /// If the two slices differ in length.
    pub fn flux_density_into(&self, points: &[DVec3], field: &mut [DVec3]) -> Result<(), Vec<LookUpError>> {
        assert_eq!(points.len(), field.len(), "one value per point");
        let [least, most] = LOOKED_UP_TOGETHER;
        let size = points.len().div_ceil(rayon::current_num_threads()).clamp(least, most);
        let errors: Vec<LookUpError> = points
            .par_chunks(size)
            .zip(field.par_chunks_mut(size))
            .enumerate()
            .flat_map_iter(|(number, (points, field))| {
                let weakest_t = self.look_up(points, field);
                let mut errors = Vec::new();
                if self.tolerance.is_kept(DVec3::X * weakest_t, self.error_t) {
                    return errors;
                }
                let start = number * size;
                for (index, (field, &point)) in field.iter_mut().zip(points).enumerate() {
                    let outside = field.is_nan();
                    if outside || !self.tolerance.is_kept(*field, self.error_t) {
                        *field = DVec3::NAN;
                        errors.push(LookUpError { index: start + index, point, outside });
                    }
                }
                errors
            })
            .collect();
        if errors.is_empty() { Ok(()) } else { Err(errors) }
    }

    fn is_inside(&self, point: DVec3) -> bool {
        self.region.lower.cmple(point).all() && point.cmple(self.region.upper).all()
    }

    /// The cell that a point of the box is in, or next to by rounding.
    #[inline(always)]
    fn cell(&self, point: DVec3) -> usize {
        let position = (point - self.region.lower) * self.per_cell;
        let [i, j, k] = [0, 1, 2].map(|axis: usize| (position[axis] as usize).min(self.cells[axis] - 1));
        (i * self.cells[1] + j) * self.cells[2] + k
    }

    pub(super) fn numbers_and_centre(&self, cell: usize) -> (&[f64], [f64; 3]) {
        let [_, ny, nz] = self.cells;
        let index = DVec3::new((cell / (ny * nz)) as f64, (cell / nz % ny) as f64, (cell % nz) as f64);
        let centre = self.region.lower + (index + 0.5) * self.cell_size;
        (&self.numbers[cell * CELL..(cell + 1) * CELL], centre.to_array())
    }
}

impl fmt::Display for FittedFieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            FittedFieldError::NoBox => "the corners of the box must be finite, lower below upper along every axis",
            FittedFieldError::TooNear => {
                "tiles are in the box or too close to it for its size: make it smaller or divide it"
            }
            FittedFieldError::TooExact => "the tolerance is below what rounding leaves: make it larger",
        })
    }
}

impl std::error::Error for FittedFieldError {}

impl fmt::Display for LookUpError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let LookUpError { index, point: DVec3 { x, y, z }, outside } = self;
        let why = if *outside { "outside the box" } else { "the field is too small there for the tolerance" };
        write!(f, "point {index} at ({x}, {y}, {z}): {why}")
    }
}

impl std::error::Error for LookUpError {}

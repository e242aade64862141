//! A box prepared for repeated look-ups.

use std::fmt;

use fearless_simd::{Level, dispatch};
use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::accuracy::Tolerance;
use super::cells::{CELL, divided, in_cell, sum_of_products, tails_t};
use super::chebyshev::polynomials;
use super::fit::{Fit, NoFit};
use super::magnitude::Box3;
use crate::scene::Scene;
use crate::tolerances::{CELL_NODES, CELL_ROUNDS, LOOKED_UP_TOGETHER, MOST_CELLS, MOST_FITTED_NODES};

/// B in a box without tiles, prepared for repeated look-ups: the box is divided into cells, each with a Chebyshev expansion of 8 x 8 x 8 terms.
///
/// # Cost
/// Making it takes some thousand exact values. A look-up among many, which are sorted by cell, takes 1800 multiply-adds of vectors for as many points
/// as a vector has lanes, whatever the number of tiles; a single one as many for itself.
///
/// # Memory
/// 12 kB for each cell; their number grows with the inverse tolerance, to some hundred cells for a fraction of 1e-9 in the published working
/// volume. See [`FittedField::memory_bytes`].
///
/// # Accuracy
/// [`FittedField::error_t`] at most at each point of the box: the estimate for the expansion of the whole box, which is checked against the exact field at
/// points of it, and that for its cells; both from the last coefficients, doubled for what appears as lower ones (docs/physics.md, section 5). For a relative tolerance it is small beside |B| wherever |B| is at least a hundredth of
/// its most in the box; [`FittedField::flux_density_into`] names the points where the tolerance does not hold.
#[derive(Clone, Debug)]
pub struct FittedField {
    region: Box3,
    tolerance: Tolerance,
    cells: [usize; 3],
    exact_values: usize,
    cells_per_length: DVec3,
    /// Cell by cell, then component, then degrees along x, y, z, those along z filled up with zeros.
    coefficients: Vec<f64>,
    error_t: f64,
    gradient_error_t: f64,
    level: Level,
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
    pub fn new(
        scene: &Scene,
        lower: DVec3,
        upper: DVec3,
        tolerance: Tolerance,
    ) -> Result<FittedField, FittedFieldError> {
        FittedField::of(scene, lower, upper, tolerance, MOST_FITTED_NODES)
    }

    /// By at most `most_nodes` exact values.
    pub(super) fn of(
        scene: &Scene,
        lower: DVec3,
        upper: DVec3,
        tolerance: Tolerance,
        most_nodes: usize,
    ) -> Result<FittedField, FittedFieldError> {
        if !(lower.is_finite() && upper.is_finite() && lower.cmplt(upper).all()) {
            return Err(FittedFieldError::NoBox);
        }
        let region = Box3 { lower, upper };
        // Half of the error for the expansion of the whole box, half for the cells.
        let half_of = |share: f64| match tolerance {
            Tolerance::Relative(fraction) => Tolerance::Relative(share * fraction),
            Tolerance::AbsoluteT(error_t) => Tolerance::AbsoluteT(share * error_t),
        };
        let fit = Fit::of(scene, region, half_of(0.5), most_nodes).map_err(|why| match why {
            NoFit::TooNear => FittedFieldError::TooNear,
            NoFit::TooExact => FittedFieldError::TooExact,
        })?;
        let mut cells = [1; 3];
        for _ in 0..CELL_ROUNDS {
            if cells.iter().product::<usize>() > MOST_CELLS {
                return Err(FittedFieldError::TooNear);
            }
            let coefficients = divided(scene.level(), &fit, cells);
            let tails = tails_t(&coefficients);
            let error_t = fit.error_t + tails.element_sum();
            if tails.element_sum() <= fit.wanted_t {
                let half = region.half_size();
                let per_length = |axis: usize| {
                    let (whole, cell) = (fit.counts[axis] as f64, CELL_NODES as f64);
                    whole.powi(2).max(cell.powi(2) * cells[axis] as f64) / half[axis]
                };
                // A polynomial's slope is at most degree^2 times its values in the half length, and so the slope of what is left out, twice for
                // higher degrees.
                let gradient_error_t = 2.0 * error_t * [0, 1, 2].map(per_length).into_iter().fold(0.0, f64::max);
                let level = scene.level();
                let cells_per_length = DVec3::from(cells.map(|count| count as f64)) / (2.0 * half);
                return Ok(FittedField {
                    region,
                    tolerance,
                    cells,
                    exact_values: fit.counts.iter().product(),
                    cells_per_length,
                    coefficients,
                    error_t,
                    gradient_error_t,
                    level,
                });
            }
            for axis in 0..3 {
                let excess = tails[axis] / (fit.wanted_t / 3.0);
                if excess > 1.0 {
                    // Coefficients of the next degree fall with the cell's size to that power.
                    let finer = excess.powf(1.0 / CELL_NODES as f64).min(3.0);
                    cells[axis] = (cells[axis] as f64 * finer).ceil().max(cells[axis] as f64 + 1.0) as usize;
                }
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
        self.coefficients.len() * size_of::<f64>()
    }

    /// B at a point, in tesla, off by at most [`FittedField::error_t`] whatever |B| is there; `None` outside the box.
    pub fn flux_density(&self, point: DVec3) -> Option<DVec3> {
        let (cell, place) = self.cell_and_place(point)?;
        let along = place.to_array().map(|t| {
            let mut values = [0.0; CELL_NODES];
            polynomials(t, &mut values);
            values
        });
        Some(self.sum(cell, &along))
    }

    /// The gradient of B at a point: column j is dB/dx_j, in tesla per unit of length, off by at most
    /// [`FittedField::gradient_error_t`]; `None` outside the box.
    pub fn flux_density_gradient(&self, point: DVec3) -> Option<DMat3> {
        let (cell, place) = self.cell_and_place(point)?;
        let half = self.region.half_size();
        let values = place.to_array().map(|t| {
            let mut values = [0.0; CELL_NODES];
            polynomials(t, &mut values);
            values
        });
        let mut columns = [DVec3::ZERO; 3];
        for (axis, column) in columns.iter_mut().enumerate() {
            let mut along = values;
            // T_k' = 2 k T_(k-1) + k / (k-2) T_(k-2)'
            let mut slopes = [0.0; CELL_NODES];
            (slopes[1], slopes[2]) = (1.0, 4.0 * values[axis][1]);
            for k in 3..CELL_NODES {
                let k_ = k as f64;
                slopes[k] = 2.0 * k_ * values[axis][k - 1] + k_ / (k_ - 2.0) * slopes[k - 2];
            }
            along[axis] = slopes;
            *column = self.sum(cell, &along) * (self.cells[axis] as f64 / half[axis]);
        }
        Some(DMat3::from_cols_array_2d(&columns.map(|c| c.to_array())))
    }

    fn sum(&self, cell: usize, along: &[[f64; CELL_NODES]; 3]) -> DVec3 {
        let coefficients = &self.coefficients[cell * CELL..(cell + 1) * CELL];
        dispatch!(self.level, simd => sum_of_products(simd, coefficients, along))
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
                self.look_up(points, field);
                let start = number * size;
                let mut errors = Vec::new();
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

    /// The cell a point is in, and where in it, from -1 to 1.
    #[inline(always)]
    fn cell_and_place(&self, point: DVec3) -> Option<(usize, DVec3)> {
        if !(self.region.lower.cmple(point).all() && point.cmple(self.region.upper).all()) {
            return None;
        }
        let position = (point - self.region.lower) * self.cells_per_length;
        let index = |axis: usize| (position[axis] as u32).min(self.cells[axis] as u32 - 1);
        let index = [index(0), index(1), index(2)];
        let [i, j, k] = index.map(|i| i as usize);
        let place = 2.0 * (position - DVec3::from(index.map(f64::from))) - 1.0;
        Some(((i * self.cells[1] + j) * self.cells[2] + k, place))
    }

    /// The points sorted by cell, so that those of one fill vectors; not a number outside the box.
    fn look_up(&self, points: &[DVec3], field: &mut [DVec3]) {
        let outside = self.cells.iter().product::<usize>();
        let mut starts = vec![0_u32; outside + 2];
        let mut places = Vec::with_capacity(points.len());
        for &point in points {
            let (cell, place) = self.cell_and_place(point).unwrap_or((outside, DVec3::NAN));
            starts[cell + 1] += 1;
            places.push((cell as u32, place));
        }
        for cell in 0..=outside {
            starts[cell + 1] += starts[cell];
        }
        let mut order = vec![0_u32; points.len()];
        let mut next = starts.clone();
        for (index, (cell, _)) in (0..).zip(&places) {
            let next = &mut next[*cell as usize];
            order[*next as usize] = index;
            *next += 1;
        }
        for cell in 0..outside {
            let order = &order[starts[cell] as usize..starts[cell + 1] as usize];
            if !order.is_empty() {
                let coefficients = &self.coefficients[cell * CELL..(cell + 1) * CELL];
                dispatch!(self.level, simd => in_cell(simd, coefficients, order, &places, field));
            }
        }
        for &index in &order[starts[outside] as usize..] {
            field[index as usize] = DVec3::NAN;
        }
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

//! A box prepared for repeated look-ups.

use std::fmt;

use fearless_simd::{Level, dispatch};
use glam::{DMat3, DVec3};
use magsplice_magnet::{BoundingBox, Tolerance};
use rayon::prelude::*;

use super::cells::HarmonicCells;
use super::fit::{ChebyshevFit, FitFailure};
use super::harmonic_potential::{CELL_COEFFICIENTS, field as harmonic_field, gradient};
use crate::tolerances::{
    CELL_DEGREE, CELL_ERROR_EXPONENT, MAX_CELL_ROUNDS, MAX_CELLS, MAX_FITTED_FIELD_NODES, POINTS_PER_LOOK_UP,
};
use magsplice_direct::direct_sum::DirectSum;

/// B in a box without tiles, prepared for repeated look-ups within a tolerance.
///
/// The box is divided into cells. In each cell the field is the gradient of one harmonic polynomial
/// of degree 10, so its divergence and curl vanish.
/// [`Scene::fitted_field`](crate::Scene::fitted_field) prepares it.
///
/// # Units
/// B in tesla; points in the unit of length of the tiles.
///
/// # Cost
/// Preparation takes some thousand exact fields. Many look-ups are sorted by cell and take 500
/// vector operations per vector of points, independent of the number of tiles. A single look-up
/// takes 300.
///
/// # Memory
/// 2.7 kB for each cell. The number of cells grows with the inverse tolerance, to 400 cells for a
/// fraction of 1e-9 in the published working volume. See [`FittedField::memory_bytes`].
///
/// # Accuracy
/// The error is at most [`FittedField::error_t`] at each point of the box (docs/physics.md, section
/// 5). It is the sum of two proved bounds. The error of the Chebyshev interpolation of the whole
/// box follows from the charges of the tiles and their distances. The error of the cells is at most
/// the sum of the coefficients of their difference from that interpolation.
///
/// A relative tolerance holds wherever |B| is at least a hundredth of the largest |B| in the box.
/// [`FittedField::flux_density_into`] lists the points where it does not hold.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use magsplice_field::{Scene, Tile, Tolerance};
///
/// let cube = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::new(0.0, 0.0, 1.2))?;
/// let (lower, upper) = (DVec3::new(-0.5, -0.5, 2.0), DVec3::new(0.5, 0.5, 3.0));
/// let fitted = Scene::new(&[cube]).fitted_field(lower, upper, Tolerance::relative(1e-6)?)?;
/// let b_t = fitted.flux_density(DVec3::new(0.1, 0.2, 2.5)).expect("a point of the box");
/// assert!(b_t.z > 0.0);
/// // Outside the box there is no field.
/// assert!(fitted.flux_density(DVec3::new(0.1, 0.2, 4.0)).is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FittedField {
    pub(super) region: BoundingBox,
    tolerance: Tolerance,
    pub(super) cells: [usize; 3],
    exact_values: usize,
    cell_size: DVec3,
    /// The inverse of the cell size, clamped to finite values.
    pub(super) per_cell: DVec3,
    /// The inverse of half the longest side of a cell.
    pub(super) scale: f64,
    /// [`CELL_COEFFICIENTS`] numbers for each cell.
    pub(super) coefficients: Vec<f64>,
    error_t: f64,
    gradient_error_t: f64,
    pub(super) level: Level,
}

/// The reason why a box has no [`FittedField`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FittedFieldError {
    /// A corner is not finite, or lower is not below upper along every axis.
    NoBox,
    /// Tiles are in the box, or so close that the interpolation would need too many nodes or cells.
    TooNear,
    /// The tolerance is below the rounding error of the exact field.
    TooExact,
    /// A part of the box is in iron.
    InIron,
}

/// A point without a value in a look-up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookUpError {
    /// Index into the points of the call.
    pub index: usize,
    /// The point.
    pub point: DVec3,
    /// Whether the point is outside the box. Otherwise |B| is too small for the tolerance.
    pub outside: bool,
}

/// All points without a value in a look-up, in the order of the points.
#[derive(Clone, Debug, PartialEq)]
pub struct LookUpErrors(pub Vec<LookUpError>);

/// Number of points that a message of [`LookUpErrors`] lists.
const NAMED_POINTS: usize = 10;

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
        FittedField::from_samples(direct, lower, upper, tolerance, MAX_FITTED_FIELD_NODES)
    }

    /// Prepares the box between two corners from at most `max_nodes` exact fields.
    pub(crate) fn from_samples(
        direct: &DirectSum,
        lower: DVec3,
        upper: DVec3,
        tolerance: Tolerance,
        max_nodes: usize,
    ) -> Result<FittedField, FittedFieldError> {
        if !(lower.is_finite() && upper.is_finite() && lower.cmplt(upper).all()) {
            return Err(FittedFieldError::NoBox);
        }
        let region = BoundingBox { lower, upper };
        // Half of the tolerance is for the fit of the whole box, half for the cells.
        let half = tolerance.scaled(0.5).map_err(|_| FittedFieldError::TooExact)?;
        let fit =
            ChebyshevFit::new(direct, region, half, |_, exact| exact <= max_nodes as f64).map_err(|why| match why {
                FitFailure::TooNear => FittedFieldError::TooNear,
                FitFailure::TooExact => FittedFieldError::TooExact,
            })?;
        let size = upper - lower;
        let mut cells = [1_usize; 3];
        for _ in 0..MAX_CELL_ROUNDS {
            if cells.iter().product::<usize>() > MAX_CELLS {
                return Err(FittedFieldError::TooNear);
            }
            let cell_size = size / DVec3::from(cells.map(|count| count as f64));
            // Half of a cell's longest side becomes one.
            let scale = 2.0 / cell_size.max_element();
            let HarmonicCells { coefficients, error_t: cell_error_t } =
                HarmonicCells::new(direct.level(), &fit, cells, scale);
            let error_t = fit.error_t + cell_error_t;
            if cell_error_t <= fit.allowed_error_t {
                // The difference between the fit and a cell is a polynomial. Its derivative is at
                // most degree^2 times its largest value per half length (Markov).
                let degrees = DVec3::from(fit.counts.map(|count| (count - 1).max(CELL_DEGREE) as f64));
                let of_cells_t = 2.0 * cell_error_t * degrees * degrees / cell_size;
                let gradient_error_t = (fit.gradient_error_t(direct) + of_cells_t).max_element();
                return Ok(FittedField {
                    region,
                    tolerance,
                    cells,
                    exact_values: fit.exact_values,
                    cell_size,
                    per_cell: cell_size.recip().min(DVec3::MAX),
                    scale,
                    coefficients,
                    error_t,
                    gradient_error_t,
                    level: direct.level(),
                });
            }
            // Cells are kept as close to cubes as possible.
            let finer = (cell_error_t / fit.allowed_error_t).powf(1.0 / CELL_ERROR_EXPONENT);
            let side = cell_size.max_element() / finer;
            let before = cells;
            cells = [0, 1, 2].map(|axis: usize| before[axis].max((size[axis] / side).ceil() as usize));
            if cells == before {
                cells = before.map(|count| count + 1);
            }
        }
        Err(FittedFieldError::TooNear)
    }

    /// Upper bound of the error of B in the box, in tesla.
    pub fn error_t(&self) -> f64 {
        self.error_t
    }

    /// Upper bound of the error of a component of the gradient in the box, in tesla per unit of
    /// length. The bound is proved, and usually many times too large.
    pub fn gradient_error_t(&self) -> f64 {
        self.gradient_error_t
    }

    /// Numbers of cells along x, y, z.
    pub fn cells(&self) -> [usize; 3] {
        self.cells
    }

    /// Number of exact fields from which the box was prepared.
    pub fn exact_values(&self) -> usize {
        self.exact_values
    }

    /// Memory of the cells in bytes.
    pub fn memory_bytes(&self) -> usize {
        self.coefficients.len() * size_of::<f64>()
    }

    /// B at a point, in tesla; `None` outside the box.
    ///
    /// The error is at most [`FittedField::error_t`], for any |B|.
    pub fn flux_density(&self, point: DVec3) -> Option<DVec3> {
        if !self.is_inside(point) {
            return None;
        }
        let (coefficients, centre) = self.cell_coefficients_and_centre(self.cell(point));
        let place = (point - DVec3::from(centre)) * self.scale;
        Some(dispatch!(self.level, simd => harmonic_field(simd, coefficients, place)))
    }

    /// The gradient of B at a point, in tesla per unit of length; `None` outside the box.
    ///
    /// Column j is dB/dx_j. The gradient is symmetric without trace, like the gradient of the exact
    /// field. The error of a component is at most [`FittedField::gradient_error_t`].
    pub fn flux_density_gradient(&self, point: DVec3) -> Option<DMat3> {
        if !self.is_inside(point) {
            return None;
        }
        let (coefficients, centre) = self.cell_coefficients_and_centre(self.cell(point));
        Some(gradient(coefficients, (point - DVec3::from(centre)) * self.scale) * self.scale)
    }

    /// B at many points, in tesla; [`FittedField::flux_density_into`] with a new vector.
    ///
    /// # Errors
    /// As [`FittedField::flux_density_into`].
    pub fn flux_density_at(&self, points: &[DVec3]) -> Result<Vec<DVec3>, LookUpErrors> {
        let mut field = vec![DVec3::ZERO; points.len()];
        self.flux_density_into(points, &mut field).map(|()| field)
    }

    /// Writes B in tesla at many points, in the order of the points, in parallel over points.
    ///
    /// The error is at most [`FittedField::error_t`], and within the tolerance.
    ///
    /// # Errors
    /// All points outside the box, and all points where |B| is too small for a relative tolerance.
    /// Their entries of `field` are NaN; all others are valid.
    ///
    /// # Panics
    /// If the two slices differ in length.
    pub fn flux_density_into(&self, points: &[DVec3], field: &mut [DVec3]) -> Result<(), LookUpErrors> {
        assert_eq!(points.len(), field.len(), "one value per point");
        let [min, max] = POINTS_PER_LOOK_UP;
        let size = points.len().div_ceil(rayon::current_num_threads()).clamp(min, max);
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
        if errors.is_empty() { Ok(()) } else { Err(LookUpErrors(errors)) }
    }

    fn is_inside(&self, point: DVec3) -> bool {
        self.region.lower.cmple(point).all() && point.cmple(self.region.upper).all()
    }

    /// Index of the cell of a point in the box, or of a neighbouring cell because of rounding.
    #[inline(always)]
    fn cell(&self, point: DVec3) -> usize {
        let position = (point - self.region.lower) * self.per_cell;
        let [i, j, k] = [0, 1, 2].map(|axis: usize| (position[axis] as usize).min(self.cells[axis] - 1));
        (i * self.cells[1] + j) * self.cells[2] + k
    }

    pub(super) fn cell_coefficients_and_centre(&self, cell: usize) -> (&[f64], [f64; 3]) {
        let [_, ny, nz] = self.cells;
        let index = DVec3::new((cell / (ny * nz)) as f64, (cell / nz % ny) as f64, (cell % nz) as f64);
        let centre = self.region.lower + (index + 0.5) * self.cell_size;
        (&self.coefficients[cell * CELL_COEFFICIENTS..(cell + 1) * CELL_COEFFICIENTS], centre.to_array())
    }
}

impl fmt::Display for FittedFieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            FittedFieldError::NoBox => "the corners of the box must be finite, lower below upper along every axis",
            FittedFieldError::TooNear => {
                "tiles are in the box or too close for its size; use a smaller box or divide it"
            }
            FittedFieldError::TooExact => {
                "the tolerance is below the rounding error of the field; use a larger tolerance"
            }
            FittedFieldError::InIron => {
                "a part of the box is on or behind a plane of iron; use a box before all planes"
            }
        })
    }
}

impl std::error::Error for FittedFieldError {}

impl fmt::Display for LookUpError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let LookUpError { index, point: DVec3 { x, y, z }, outside } = self;
        let why = if *outside { "outside the box" } else { "the field is too weak for the tolerance" };
        write!(f, "point {index} at ({x}, {y}, {z}): {why}")
    }
}

impl std::error::Error for LookUpError {}

impl fmt::Display for LookUpErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let LookUpErrors(errors) = self;
        for (number, error) in errors.iter().take(NAMED_POINTS).enumerate() {
            let separator = if number == 0 { "" } else { "; " };
            write!(f, "{separator}{error}")?;
        }
        match errors.len().saturating_sub(NAMED_POINTS) {
            0 => Ok(()),
            more => write!(f, "; and {more} more"),
        }
    }
}

impl std::error::Error for LookUpErrors {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.0.first().map(|error| error as _)
    }
}

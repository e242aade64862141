//! The position of a sensor as a polynomial of the decoupling parameters, for computers with little
//! memory.

use glam::DVec3;
use magsplice_decouple::{Branch, Parameters};
use magsplice_magnet::{Grid, PointErrors};
use nalgebra::DMatrix;
use thiserror::Error;

use crate::sensed_field::SensedField;

/// Candidate degrees in ascending order. The error of a film falls by a factor of three to five
/// with each.
const DEGREES: [usize; 5] = [4, 6, 8, 10, 12];

/// Nodes of the fit along x, y, z: more than the highest degree.
const NODES: [usize; 3] = [21, 21, 15];

/// Points along x, y, z at which the error is measured: the extrema of a Chebyshev polynomial of
/// degree 56, four times the highest degree that errors have in practice.
const CHECKS: [usize; 3] = [57; 3];

/// Largest second derivative of errors between the points, over the largest second difference of
/// the points. Waves of degree 14 have eight points. The point nearest to a crest, at most a
/// sixteenth of a wave away, has at least 0.924 of its second derivative, and the second difference
/// there is 0.949 of the derivative.
const MARGIN: f64 = 1.0 / (0.924 * 0.949);

/// Rounding of the parameters and of the recurrence of Chebyshev polynomials in single precision:
/// roundings for each term and each square of its degrees.
const ROUNDINGS: f64 = 4.0;

/// The displacement of a sensor from the reference point as a polynomial of R_x, R_y and S_z: a sum
/// of products of Chebyshev polynomials.
///
/// For an ideal film the displacement is a multiple of each parameter (Dai 2024, Eq. 14). The
/// polynomial also contains the effects of the splicing pattern and of the end of the film.
#[derive(Clone, Debug, PartialEq)]
pub struct DisplacementPolynomial {
    /// Highest sum of degrees along the three parameters.
    pub degree: usize,
    /// The sign of B_z on the axis, which is the branch of R_x and R_y.
    pub branch_sign: f64,
    /// Smallest R_x, R_y, S_z in the volume.
    pub lower: [f64; 3],
    /// Largest R_x, R_y, S_z in the volume.
    pub upper: [f64; 3],
    /// Displacements along x, y, z of each term, in the order of [`DisplacementPolynomial::terms`].
    pub coefficients: Vec<[f64; 3]>,
    /// Bound of the error in the whole volume, as a length: the Euclidean norm of the difference of
    /// the vectors.
    pub largest_error: f64,
    /// Number of measured points.
    pub checked: usize,
}

/// The reason why there is no polynomial.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum PolynomialError {
    /// No degree reaches the requested error.
    #[error("no polynomial reaches the requested error; the smallest error found is {least:.2e}")]
    NotReached {
        /// The smallest error.
        least: f64,
    },
    /// The volume has no extent along an axis, 0 for x, 1 for y, 2 for z: the displacement does not
    /// vary along it.
    #[error("the volume has no extent along {}, and a displacement in three directions needs one", ["x", "y", "z"][*.0])]
    NoExtent(usize),
    /// A point of the volume has no parameters, because B_z is 0 there.
    #[error("B_z is 0 at ({}, {}, {}), where the parameters of Eq. 15 do not exist", .0.x, .0.y, .0.z)]
    Singular(DVec3),
    /// Points without a field.
    #[error("points of the volume have no field: {0}")]
    Points(PointErrors),
}

impl DisplacementPolynomial {
    /// The polynomial of the lowest degree whose error is at most `error`, as a length, in the
    /// whole volume of `volume`, evaluated in single precision. Displacements count from
    /// `reference`.
    ///
    /// The error is measured at 57 x 57 x 57 points, at x = cos(t) with uniform t. Between points,
    /// linear interpolation in t is at most as long as at the points, and differs from the error by
    /// at most an eighth of the second difference along each axis. The largest second differences
    /// at the points, with a margin for those between, and the rounding of single precision are
    /// added to the largest error at the points.
    ///
    /// # Errors
    /// See [`PolynomialError`].
    pub fn fit<'a>(
        field: impl Into<SensedField<'a>>,
        volume: &Grid,
        reference: DVec3,
        error: f64,
    ) -> Result<DisplacementPolynomial, PolynomialError> {
        if let Some(axis) = (0..3).find(|axis| volume.upper()[*axis] == volume.lower()[*axis]) {
            return Err(PolynomialError::NoExtent(axis));
        }
        let field = field.into();
        let field_t = |points: &[DVec3]| -> Result<Vec<DVec3>, PolynomialError> {
            let readings_t = field.readings_t(points).map_err(PolynomialError::Points)?;
            Ok(readings_t.into_iter().map(|reading| field.field_of_reading_t(reading)).collect())
        };
        let at_reference_t = field_t(&[reference])?[0];
        let branch = Branch::from_axis_field(at_reference_t).ok_or(PolynomialError::Singular(reference))?;
        let parameters = |points: &[DVec3]| -> Result<Vec<[f64; 3]>, PolynomialError> {
            let of = |(point, field_t): (&DVec3, DVec3)| {
                let Parameters { r_x, r_y, s_z } =
                    Parameters::from_field(field_t, branch).ok_or(PolynomialError::Singular(*point))?;
                Ok([r_x, r_y, s_z])
            };
            points.iter().zip(field_t(points)?).map(of).collect()
        };
        let nodes =
            points(volume, NODES, |index, count| -(std::f64::consts::PI * (index as f64 + 0.5) / count as f64).cos());
        let checks =
            points(volume, CHECKS, |index, count| -(std::f64::consts::PI * index as f64 / (count - 1) as f64).cos());
        let (at_nodes, at_checks) = (parameters(&nodes)?, parameters(&checks)?);
        let range = |axis: usize| {
            let values = at_nodes.iter().chain(&at_checks).map(|all| all[axis]);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
        };
        let ranges = [0, 1, 2].map(range);
        let mut least = f64::INFINITY;
        for degree in DEGREES {
            let mut polynomial = DisplacementPolynomial {
                degree,
                branch_sign: at_reference_t.z.signum(),
                lower: ranges.map(|(low, _)| low),
                upper: ranges.map(|(_, high)| high),
                coefficients: Vec::new(),
                largest_error: f64::INFINITY,
                checked: checks.len(),
            };
            polynomial.solve(&at_nodes, &nodes, reference);
            let error_at =
                |(parameters, point): (&[f64; 3], &DVec3)| polynomial.displacement(*parameters) - (*point - reference);
            let errors: Vec<DVec3> = at_checks.iter().zip(&checks).map(error_at).collect();
            polynomial.largest_error = largest_between(&errors) + polynomial.rounding();
            if polynomial.largest_error <= error {
                return Ok(polynomial);
            }
            least = least.min(polynomial.largest_error);
        }
        Err(PolynomialError::NotReached { least })
    }

    /// The degrees along R_x, R_y, S_z of each term of a polynomial.
    pub fn terms(degree: usize) -> Vec<[usize; 3]> {
        let mut terms = Vec::new();
        for i in 0..=degree {
            for j in 0..=degree - i {
                terms.extend((0..=degree - i - j).map(|k| [i, j, k]));
            }
        }
        terms
    }

    /// The displacement for these values of R_x, R_y, S_z.
    pub fn displacement(&self, parameters: [f64; 3]) -> DVec3 {
        let row = self.row(parameters);
        row.iter().zip(&self.coefficients).map(|(value, coefficient)| *value * DVec3::from(*coefficient)).sum()
    }

    /// Bound of the rounding in single precision.
    fn rounding(&self) -> f64 {
        let term = |([i, j, k], coefficient): ([usize; 3], &[f64; 3])| {
            (1 + i * i + j * j + k * k) as f64 * DVec3::from(*coefficient).length()
        };
        let sum: f64 = DisplacementPolynomial::terms(self.degree).into_iter().zip(&self.coefficients).map(term).sum();
        ROUNDINGS * f64::from(f32::EPSILON) * sum
    }

    /// The value of each term.
    fn row(&self, parameters: [f64; 3]) -> Vec<f64> {
        let values: [Vec<f64>; 3] = std::array::from_fn(|axis| {
            let (low, high) = (self.lower[axis], self.upper[axis]);
            let u = (2.0 * parameters[axis] - low - high) / (high - low);
            let mut values = vec![1.0, u];
            for n in 2..=self.degree {
                values.push(2.0 * u * values[n - 1] - values[n - 2]);
            }
            values
        });
        let term = |[i, j, k]: [usize; 3]| values[0][i] * values[1][j] * values[2][k];
        DisplacementPolynomial::terms(self.degree).into_iter().map(term).collect()
    }

    /// Fits the coefficients by least squares.
    fn solve(&mut self, parameters: &[[f64; 3]], points: &[DVec3], reference: DVec3) {
        let rows: Vec<Vec<f64>> = parameters.iter().map(|at| self.row(*at)).collect();
        let terms = rows[0].len();
        let matrix = DMatrix::from_fn(rows.len(), terms, |row, term| rows[row][term]);
        let mut right = DMatrix::from_fn(rows.len(), 3, |row, axis| (points[row] - reference)[axis]);
        let qr = matrix.qr();
        qr.q_tr_mul(&mut right);
        let upper = qr.r();
        let mut solution = right.rows(0, terms).into_owned();
        // The columns are products of Chebyshev polynomials over their whole range, and
        // independent.
        upper.solve_upper_triangular_mut(&mut solution);
        self.coefficients = (0..terms).map(|term| [0, 1, 2].map(|axis| solution[(term, axis)])).collect();
    }
}

/// Bound of the length of errors in the whole volume, from those at the points of [`CHECKS`].
fn largest_between(errors: &[DVec3]) -> f64 {
    let strides = [CHECKS[1] * CHECKS[2], CHECKS[2], 1];
    let at_points = errors.iter().map(|error| error.length()).fold(0.0, f64::max);
    let between = |axis: usize| {
        let stride = strides[axis];
        let inner = (0..errors.len()).filter(|index| (index / stride) % CHECKS[axis] >= 2);
        let second =
            inner.map(|index| (errors[index] - 2.0 * errors[index - stride] + errors[index - 2 * stride]).length());
        second.fold(0.0, f64::max) / 8.0
    };
    at_points + MARGIN * [0, 1, 2].map(between).iter().sum::<f64>()
}

/// Points of the box of a grid at these fractions, from -1 to 1, along each axis.
fn points(volume: &Grid, counts: [usize; 3], at: impl Fn(usize, usize) -> f64) -> Vec<DVec3> {
    let (lower, upper) = (volume.lower(), volume.upper());
    let coordinate =
        |axis: usize, index: usize| 0.5 * ((lower + upper)[axis] + at(index, counts[axis]) * (upper - lower)[axis]);
    let mut points = Vec::with_capacity(counts.iter().product());
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            points.extend((0..counts[2]).map(|k| DVec3::new(coordinate(0, i), coordinate(1, j), coordinate(2, k))));
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An error c n^2 at the n-th point along one axis has the second difference 2 c along it and
    /// none along the others. The bound exceeds the largest error by an eighth of it, with the
    /// margin.
    #[test]
    fn errors_between_points_are_bounded_by_second_differences_along_each_axis() {
        const C: f64 = 1e-3;
        for axis in 0..3 {
            let mut errors = Vec::new();
            for i in 0..CHECKS[0] {
                for j in 0..CHECKS[1] {
                    errors.extend((0..CHECKS[2]).map(|k| DVec3::Y * (C * ([i, j, k][axis] as f64).powi(2))));
                }
            }
            let at_points = C * ((CHECKS[axis] - 1) as f64).powi(2);
            let expected = at_points + MARGIN * 2.0 * C / 8.0;
            // Round-off of differences of numbers up to `at_points`.
            assert!((largest_between(&errors) - expected).abs() < 1e-15 * 4.0 * at_points, "axis {axis}");
        }
    }
}

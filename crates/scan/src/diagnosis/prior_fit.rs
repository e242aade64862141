//! Least squares with prior deviations, from the products of all pairs of columns.
//!
//! With the columns D, the readings y (whitened) and the prior covariance V, the estimate is x =
//! (V^-1 + D^T D)^-1 D^T y with the covariance (V^-1 + D^T D)^-1. Before x is known, the readings
//! have the covariance C = 1 + D V D^T with the inverse 1 - D (V^-1 + D^T D)^-1 D^T.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Matrix3, SymmetricEigen};

use crate::diagnosis::error::DiagnosisError;
use crate::diagnosis::significance::ln_probability_above;

/// Eigenvalue of the information about the components of an error, over the largest, below which a
/// combination of components does not appear in the readings. Where expected errors hide most of
/// the signal, round-off is 1e-12 of the largest.
const INVISIBLE: f64 = 1e-7;

/// Smallest share of the information about the components of an error that remains beside expected
/// errors and noise.
const LEAST_LEFT: f64 = 1e-9;

/// The fit of unknowns with prior deviations.
pub(crate) struct PriorFit<'a> {
    gram: &'a DMatrix<f64>,
    projected: &'a DVector<f64>,
    /// Unknowns with a deviation.
    active: Vec<usize>,
    inverse: Cholesky<f64, Dyn>,
    /// Values of all unknowns; 0 for unknowns without a deviation.
    pub(crate) estimate: DVector<f64>,
}

/// A test of whether an error differs from its assumed value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Score {
    /// Chi squared: the fall of the fit's chi squared if the error may have any value.
    pub(crate) chi_squared: f64,
    /// The logarithm of the probability of as large a chi squared by chance.
    pub(crate) ln_probability: f64,
}

impl Score {
    /// A test without information.
    pub(crate) const NONE: Score = Score { chi_squared: 0.0, ln_probability: 0.0 };
}

impl<'a> PriorFit<'a> {
    /// The fit of the unknowns whose deviation is not 0.
    pub(crate) fn new(
        gram: &'a DMatrix<f64>,
        projected: &'a DVector<f64>,
        deviations: &[f64],
    ) -> Result<PriorFit<'a>, DiagnosisError> {
        let active: Vec<usize> = (0..deviations.len()).filter(|index| deviations[*index] > 0.0).collect();
        let count = active.len();
        let matrix = DMatrix::from_fn(count, count, |i, j| {
            let prior = if i == j { deviations[active[i]].powi(-2) } else { 0.0 };
            gram[(active[i], active[j])] + prior
        });
        let inverse = Cholesky::new(matrix).ok_or(DiagnosisError::NoSolution)?;
        let solved = inverse.solve(&DVector::from_fn(count, |i, _| projected[active[i]]));
        let mut estimate = DVector::zeros(deviations.len());
        active.iter().zip(solved.iter()).for_each(|(index, value)| estimate[*index] = *value);
        Ok(PriorFit { gram, projected, active, inverse, estimate })
    }

    /// The fall of the sum of squares, including the prior's, from other values to the estimate.
    /// Values of unknowns without a deviation are 0.
    pub(crate) fn gain(&self, values: &DVector<f64>) -> f64 {
        let step = DVector::from_fn(self.active.len(), |i, _| self.estimate[self.active[i]] - values[self.active[i]]);
        // L^T step of the factor L.
        let factor = self.inverse.l_dirty();
        (0..step.len()).map(|j| (j..step.len()).map(|i| factor[(i, j)] * step[i]).sum::<f64>().powi(2)).sum()
    }

    /// Standard deviation of each unknown after the readings; 0 for unknowns without a prior
    /// deviation.
    pub(crate) fn deviations(&self) -> DVector<f64> {
        let mut deviations = DVector::zeros(self.estimate.len());
        let count = self.active.len();
        let root = self
            .inverse
            .l_dirty()
            .lower_triangle()
            .solve_lower_triangular(&DMatrix::identity(count, count))
            .expect("the factor has an inverse");
        for (i, index) in self.active.iter().enumerate() {
            deviations[*index] = root.column(i).norm();
        }
        deviations
    }

    /// The covariance that the fit gives readings, over the noise, from their derivatives by all
    /// unknowns: each reading is three rows of `columns` from `row`.
    pub(crate) fn leverage(&self, columns: &[Vec<f64>], row: usize) -> Matrix3<f64> {
        let rows = DMatrix::from_fn(self.active.len(), 3, |i, axis| columns[self.active[i]][row + axis]);
        let reduced =
            self.inverse.l_dirty().lower_triangle().solve_lower_triangular(&rows).expect("the factor has an inverse");
        Matrix3::from_fn(|i, j| reduced.column(i).dot(&reduced.column(j)))
    }

    /// Tests errors, each given by the indices of its components, against their prior deviations.
    pub(crate) fn scores(&self, errors: &[Vec<usize>]) -> Vec<Score> {
        let wanted: Vec<usize> = errors.iter().flatten().copied().collect();
        let cross = DMatrix::from_fn(self.active.len(), wanted.len(), |i, j| self.gram[(self.active[i], wanted[j])]);
        let reduced =
            self.inverse.l_dirty().lower_triangle().solve_lower_triangular(&cross).expect("the factor has an inverse");
        let explained = |index: usize| -> f64 {
            self.active.iter().map(|active| self.gram[(index, *active)] * self.estimate[*active]).sum()
        };
        let mut first = 0;
        errors
            .iter()
            .map(|components| {
                let count = components.len();
                let whole = DMatrix::from_fn(count, count, |i, j| self.gram[(components[i], components[j])]);
                let own = reduced.columns(first, count);
                first += count;
                let left = &whole - own.transpose() * own;
                let signal = DVector::from_fn(count, |i, _| self.projected[components[i]] - explained(components[i]));
                score(&whole, left, &signal)
            })
            .collect()
    }
}

/// The score test. `left` is the covariance of `signal` in a film without faults.
fn score(whole: &DMatrix<f64>, left: DMatrix<f64>, signal: &DVector<f64>) -> Score {
    let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(left);
    let least = (INVISIBLE * eigenvalues.amax()).max(LEAST_LEFT * whole.amax());
    let (mut chi_squared, mut freedom) = (0.0, 0);
    for (index, eigenvalue) in eigenvalues.iter().enumerate() {
        if *eigenvalue > least {
            chi_squared += eigenvectors.column(index).dot(signal).powi(2) / eigenvalue;
            freedom += 1;
        }
    }
    if freedom == 0 {
        return Score::NONE;
    }
    Score { chi_squared, ln_probability: ln_probability_above(chi_squared, freedom) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The estimate is the minimum of v^T (G + D^-2) v - 2 p v, and the gain of values is their
    /// height above it. The second unknown has no deviation and stays 0.
    #[test]
    fn gain_is_the_height_above_the_minimum() {
        let gram = DMatrix::from_row_slice(3, 3, &[4.0, 1.0, 0.5, 1.0, 9.0, 2.0, 0.5, 2.0, 3.0]);
        let (projected, deviations) = (DVector::from_vec(vec![1.0, -2.0, 3.0]), [0.5, 0.0, 2.0]);
        let fit = PriorFit::new(&gram, &projected, &deviations).unwrap();
        assert_eq!(fit.estimate[1], 0.0);
        let height = |values: &DVector<f64>| {
            let prior = values[0].powi(2) / 0.25 + values[2].powi(2) / 4.0;
            values.dot(&(&gram * values)) + prior - 2.0 * projected.dot(values)
        };
        for values in [[0.3, 0.0, -0.7], [0.0, 0.0, 0.0], [-5.0, 0.0, 2.0]] {
            let values = DVector::from_vec(values.to_vec());
            let expected = height(&values) - height(&fit.estimate);
            assert!((fit.gain(&values) - expected).abs() < 1e-12 * expected, "{values}: {expected}");
        }
        assert_eq!(fit.gain(&fit.estimate), 0.0);
    }
}

//! Second derivatives of the model of a step (Gauss-Newton), as a matrix or by few rows, and their
//! damping.

use magsplice_tolerance::LowRank;

use crate::problem::objective::Residuals;
use crate::tolerances::{SMALLEST_FACTOR, SMALLEST_ROW};

/// Damping of variables that change nothing, as a fraction of the damping of the most effective
/// variable.
const LEAST_CURVATURE: f64 = 1e-3;

/// The upper triangle of J^T J with the Jacobian J of the residuals, plus the curvature of the
/// expected squares, by rows of `all` elements. The elements beyond the first `n` variables are 0.
pub(crate) fn dense(residuals: &Residuals, n: usize, all: usize) -> Vec<f64> {
    let mut curvature = vec![0.0; all * all];
    for row in residuals.derivatives.chunks_exact(n) {
        for i in 0..n {
            for k in i..n {
                curvature[i * all + k] += row[i] * row[k];
            }
        }
    }
    if let Some(expected) = &residuals.expected {
        for (i, row) in expected.curvature.chunks_exact(n).enumerate() {
            (i..n).for_each(|k| curvature[i * all + k] += row[k]);
        }
    }
    curvature
}

/// Rows R with R^T R equal to F^T F up to [`SMALLEST_ROW`], where the columns are measured in
/// `units`. `rows` are the rows of F, one after the other, as long as `units`.
pub(crate) fn reduced(rows: &[f64], units: &[f64]) -> Vec<f64> {
    let n = units.len();
    let column = |(i, unit): (usize, &f64)| rows.iter().skip(i).step_by(n).map(|value| value * unit).collect();
    let found = LowRank::new(units.iter().enumerate().map(column).collect(), SMALLEST_ROW);
    let row = |row: usize| found.coordinates.iter().zip(units).map(move |(column, unit)| column[row] / unit);
    (0..found.rank()).flat_map(row).collect()
}

/// Rows R and a diagonal D so that R^T R + D is near a positive semidefinite matrix: equal on the
/// diagonal, and off it up to [`SMALLEST_FACTOR`] in `units` of the columns.
///
/// This is a Cholesky decomposition with pivoting, whose remainder is left out except for its
/// diagonal.
pub(crate) fn factored(matrix: &[f64], units: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let n = units.len();
    let mut rest: Vec<f64> = (0..n).map(|i| matrix[i * n + i]).collect();
    let mut rows: Vec<f64> = Vec::new();
    let scaled = |rest: &[f64], i: usize| rest[i] * units[i] * units[i];
    let first = (0..n).map(|i| scaled(&rest, i)).fold(0.0, f64::max);
    while rows.len() < n * n {
        let Some(pivot) = (0..n).max_by(|&a, &b| scaled(&rest, a).total_cmp(&scaled(&rest, b))) else { break };
        if !(scaled(&rest, pivot) > SMALLEST_FACTOR * SMALLEST_FACTOR * first) {
            break;
        }
        let root = rest[pivot].sqrt();
        let mut row = matrix[pivot * n..][..n].to_vec();
        rows.chunks_exact(n).for_each(|earlier| add(&mut row, -earlier[pivot], earlier));
        row.iter_mut().for_each(|value| *value /= root);
        rest.iter_mut().zip(&row).for_each(|(rest, value)| *rest = (*rest - value * value).max(0.0));
        rest[pivot] = 0.0;
        rows.extend(row);
    }
    (rows, rest)
}

fn add(into: &mut [f64], factor: f64, row: &[f64]) {
    into.iter_mut().zip(row).for_each(|(sum, value)| *sum += factor * value);
}

/// The damping of each variable with the curvature `own`, for steps of these units.
///
/// Damping is measured in units of the steps, so that it does not depend on the units of the
/// variables. A part of it is the same for all variables and holds variables that change nothing.
pub(crate) fn damped(own: &[f64], units: &[f64], damping: f64) -> Vec<f64> {
    let largest = own.iter().zip(units).map(|(own, unit)| own * unit * unit).fold(0.0, f64::max);
    own.iter().zip(units).map(|(own, unit)| damping * (own + LEAST_CURVATURE * largest / (unit * unit))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::objective::ExpectedSquares;

    #[test]
    fn dense_curvature_is_the_sum_of_both_parts() {
        let expected =
            ExpectedSquares { loss: 0.0, gradient: vec![0.0; 2], curvature: vec![100.0, 200.0, 300.0, 400.0] };
        let mut residuals = Residuals {
            values: vec![0.0; 3],
            derivatives: vec![1.0, 2.0, 3.0, 5.0, -7.0, 11.0],
            amplitudes: Vec::new(),
            expected: None,
        };
        // J^T J of the rows (1, 2), (3, 5), (-7, 11), and nothing below the diagonal.
        assert_eq!(dense(&residuals, 2, 3), [59.0, -60.0, 0.0, 0.0, 150.0, 0.0, 0.0, 0.0, 0.0]);
        residuals.expected = Some(expected);
        assert_eq!(dense(&residuals, 2, 2), [159.0, 140.0, 0.0, 550.0]);
    }

    #[test]
    fn damping_does_not_depend_on_units() {
        // Curvatures 2 * 3^2 = 18 and 5 * 2^2 = 20 in units of the steps.
        let found = damped(&[2.0, 5.0, 0.0], &[3.0, 2.0, 4.0], 0.5);
        let least = 20.0 * LEAST_CURVATURE;
        for (found, expected) in
            found.into_iter().zip([0.5 * (2.0 + least / 9.0), 0.5 * (5.0 + least / 4.0), 0.5 * least / 16.0])
        {
            assert!((found - expected).abs() < 1e-15, "{found}, not {expected}");
        }
    }

    #[test]
    fn few_rows_have_the_same_squares_as_many() {
        // Twelve rows that are combinations of three, in columns of different units.
        let base = |k: usize, i: usize| ((k * k + 2) as f64 * (i as f64 + 0.3)).sin();
        let units: Vec<f64> = (0..5).map(|i| 10_f64.powi(i - 2)).collect();
        let rows: Vec<f64> = (0..12)
            .flat_map(|row| {
                (0..5).map(move |i| (0..3).map(|k| base(k, i) * ((row * (k + 1)) as f64).cos()).sum::<f64>())
            })
            .enumerate()
            .map(|(at, value)| value / units[at % 5])
            .collect();
        let found = reduced(&rows, &units);
        assert_eq!(found.len(), 3 * 5);
        let gram = |rows: &[f64], i: usize, k: usize| rows.chunks_exact(5).map(|row| row[i] * row[k]).sum::<f64>();
        for (i, k) in (0..5).flat_map(|i| (0..5).map(move |k| (i, k))) {
            let (wanted, found) = (gram(&rows, i, k), gram(&found, i, k));
            assert!((wanted - found).abs() * units[i] * units[k] < 1e-12, "{i}, {k}: {wanted}, {found}");
        }
        assert!(reduced(&[0.0; 10], &units).is_empty());
    }

    /// A matrix of rank two with a small diagonal: two rows hold the first part, and the diagonal
    /// the second up to the square of [`SMALLEST_FACTOR`].
    #[test]
    fn a_matrix_is_few_rows_and_a_diagonal() {
        let units: Vec<f64> = (0..6).map(|i| 10_f64.powi(i - 3)).collect();
        let base = |k: usize, i: usize| ((k + 1) as f64 * (i as f64 + 0.3)).sin();
        let small = 0.1 * SMALLEST_FACTOR * SMALLEST_FACTOR;
        let element = |i: usize, k: usize| {
            let product = (0..2).map(|row| base(row, i) * base(row, k)).sum::<f64>();
            (product + if i == k { small } else { 0.0 }) / units[i] / units[k]
        };
        let matrix: Vec<f64> = (0..36).map(|at| element(at / 6, at % 6)).collect();
        let (rows, rest) = factored(&matrix, &units);
        assert_eq!(rows.len(), 2 * 6);
        for (i, k) in (0..6).flat_map(|i| (0..6).map(move |k| (i, k))) {
            let found =
                rows.chunks_exact(6).map(|row| row[i] * row[k]).sum::<f64>() + if i == k { rest[i] } else { 0.0 };
            let error = (found - matrix[i * 6 + k]).abs() * units[i] * units[k];
            assert!(error < 10.0 * small, "{i}, {k}: {error}");
        }
    }
}

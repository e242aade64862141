//! Second derivatives of the model of a step (Gauss-Newton), and their damping.

use crate::problem::objective::Residuals;

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
}

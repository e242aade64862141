//! Quadratic programs: a quadratic function under linear inequalities, minimized by an
//! interior-point solver.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

/// Minimize x^T H x / 2 + g^T x under linear inequalities.
pub(crate) struct QuadraticProgram {
    /// H by rows, symmetric and positive semidefinite. Only its upper triangle is read.
    pub(crate) curvature: Vec<f64>,
    /// g.
    pub(crate) gradient: Vec<f64>,
    /// Linear expressions, as terms of variable and factor, and their lower bounds.
    pub(crate) rules: Vec<(Vec<(usize, f64)>, f64)>,
}

/// Tolerance of the solver, relative to the objective. Steps need no more digits, because films are
/// rounded.
const GAP: f64 = 1e-9;

impl QuadraticProgram {
    /// The minimizer. `None` if the rules contradict each other or the solver fails on the numbers.
    pub(crate) fn solve(&self) -> Option<Vec<f64>> {
        let n = self.gradient.len();
        // The solver also applies its tolerances as absolute ones, so the numbers are scaled.
        let scale =
            (0..n).map(|i| self.curvature[i * n + i]).chain(self.gradient.iter().map(|g| g.abs())).fold(0.0, f64::max);
        if !(scale.is_finite() && scale > 0.0) {
            return None;
        }
        let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
        for column in 0..n {
            for row in 0..=column {
                rows.push(row);
                columns.push(column);
                values.push(self.curvature[row * n + column] / scale);
            }
        }
        let curvature = CscMatrix::new_from_triplets(n, n, rows, columns, values);
        let gradient: Vec<f64> = self.gradient.iter().map(|g| g / scale).collect();
        let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
        for (row, (terms, _)) in self.rules.iter().enumerate() {
            for &(column, factor) in terms {
                rows.push(row);
                columns.push(column);
                values.push(-factor);
            }
        }
        let matrix = CscMatrix::new_from_triplets(self.rules.len(), n, rows, columns, values);
        let limits: Vec<f64> = self.rules.iter().map(|(_, least)| -least).collect();
        let cones = [SupportedConeT::NonnegativeConeT(self.rules.len())];
        let settings = DefaultSettings {
            verbose: false,
            max_threads: 1,
            tol_gap_abs: GAP,
            tol_gap_rel: GAP,
            tol_feas: GAP,
            ..DefaultSettings::default()
        };
        let mut solver = DefaultSolver::new(&curvature, &gradient, &matrix, &limits, &cones, settings).ok()?;
        solver.solve();
        matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved)
            .then(|| std::mem::take(&mut solver.solution.x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_free_and_constrained_minima_and_refuses_contradictions() {
        // (x - 1)^2 + (y - 2)^2.
        let mut program =
            QuadraticProgram { curvature: vec![2.0, 0.0, 0.0, 2.0], gradient: vec![-2.0, -4.0], rules: Vec::new() };
        program.rules.push((vec![(0, 1.0)], -10.0));
        let free = program.solve().unwrap();
        assert!((free[0] - 1.0).abs() < 1e-6 && (free[1] - 2.0).abs() < 1e-6, "{free:?}");
        // x + y <= 1, x >= 0.5: the corner (0.5, 0.5).
        program.rules.push((vec![(0, -1.0), (1, -1.0)], -1.0));
        program.rules.push((vec![(0, 1.0)], 0.5));
        let corner = program.solve().unwrap();
        assert!((corner[0] - 0.5).abs() < 1e-6 && (corner[1] - 0.5).abs() < 1e-6, "{corner:?}");
        program.rules.push((vec![(1, 1.0)], 0.7));
        assert_eq!(program.solve(), None);
    }
}

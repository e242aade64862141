//! Quadratic programs: a quadratic function under linear inequalities, minimized by an
//! interior-point solver.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

use crate::tolerances::FACTORED_FROM;

/// Minimize x^T H x / 2 + g^T x under linear inequalities.
pub(crate) struct QuadraticProgram {
    /// H.
    pub(crate) curvature: Curvature,
    /// g.
    pub(crate) gradient: Vec<f64>,
    /// Linear expressions, as terms of variable and factor, and their lower bounds.
    pub(crate) rules: Vec<(Vec<(usize, f64)>, f64)>,
}

/// A symmetric positive semidefinite matrix.
pub(crate) enum Curvature {
    /// All elements by rows. Only the upper triangle is read.
    Dense(Vec<f64>),
    /// A diagonal matrix plus R^T R with few rows R. The solver gets the product R x as further
    /// variables, so that its matrices stay sparse.
    Factored {
        /// The diagonal.
        diagonal: Vec<f64>,
        /// The rows of R, one after the other.
        rows: Vec<f64>,
    },
}

impl Curvature {
    /// A diagonal matrix.
    pub(crate) fn diagonal(diagonal: Vec<f64>) -> Curvature {
        let n = diagonal.len();
        if n >= FACTORED_FROM {
            return Curvature::Factored { diagonal, rows: Vec::new() };
        }
        let mut all = vec![0.0; n * n];
        diagonal.into_iter().enumerate().for_each(|(i, value)| all[i * n + i] = value);
        Curvature::Dense(all)
    }

    /// Largest element of the diagonal.
    fn largest(&self, n: usize) -> f64 {
        match self {
            Curvature::Dense(all) => (0..n).map(|i| all[i * n + i]).fold(0.0, f64::max),
            Curvature::Factored { diagonal, rows } => {
                let squares = |i: usize| rows.iter().skip(i).step_by(n).map(|r| r * r).sum::<f64>();
                (0..n).map(|i| diagonal[i] + squares(i)).fold(0.0, f64::max)
            }
        }
    }
}

/// Tolerance of the solver, relative to the objective. Steps need no more digits, because films are
/// rounded.
const GAP: f64 = 1e-9;

impl QuadraticProgram {
    /// The minimizer. `None` if the rules contradict each other or the solver fails on the numbers.
    pub(crate) fn solve(&self) -> Option<Vec<f64>> {
        let n = self.gradient.len();
        // The solver also applies its tolerances as absolute ones, so the numbers are scaled.
        let scale = self.gradient.iter().map(|g| g.abs()).fold(self.curvature.largest(n), f64::max);
        if !(scale.is_finite() && scale > 0.0) {
            return None;
        }
        let mut gradient: Vec<f64> = self.gradient.iter().map(|g| g / scale).collect();
        // Entries of matrices, with rows and columns.
        let (mut curvature, mut matrix) = (Vec::new(), Vec::new());
        let (mut limits, mut cones) = (Vec::new(), Vec::new());
        match &self.curvature {
            Curvature::Dense(all) => {
                for column in 0..n {
                    for row in 0..=column {
                        curvature.push((row, column, all[row * n + column] / scale));
                    }
                }
            }
            Curvature::Factored { diagonal, rows } => {
                let factors = rows.len() / n;
                diagonal.iter().enumerate().for_each(|(i, value)| curvature.push((i, i, value / scale)));
                // Further variables, each equal to a row of R times the variables.
                let root = scale.sqrt();
                for (factor, row) in rows.chunks_exact(n).enumerate() {
                    curvature.push((n + factor, n + factor, 1.0));
                    row.iter().enumerate().for_each(|(i, value)| matrix.push((factor, i, value / root)));
                    matrix.push((factor, n + factor, -1.0));
                }
                gradient.resize(n + factors, 0.0);
                limits.resize(factors, 0.0);
                cones.push(SupportedConeT::ZeroConeT(factors));
            }
        }
        let first = limits.len();
        for (rule, (terms, least)) in self.rules.iter().enumerate() {
            terms.iter().for_each(|&(column, factor)| matrix.push((first + rule, column, -factor)));
            limits.push(-least);
        }
        cones.push(SupportedConeT::NonnegativeConeT(self.rules.len()));
        let curvature = matrix_of(gradient.len(), gradient.len(), curvature);
        let matrix = matrix_of(limits.len(), gradient.len(), matrix);
        let settings = DefaultSettings {
            verbose: false,
            // Only factorizations that this crate does not build in have threads. A program that
            // builds them in gets the same films for any number of threads, too.
            max_threads: 1,
            tol_gap_abs: GAP,
            tol_gap_rel: GAP,
            tol_feas: GAP,
            ..DefaultSettings::default()
        };
        let mut solver = DefaultSolver::new(&curvature, &gradient, &matrix, &limits, &cones, settings).ok()?;
        solver.solve();
        let solved = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
        let mut solution = std::mem::take(&mut solver.solution.x);
        solution.truncate(n);
        solved.then_some(solution)
    }
}

/// A sparse matrix from rows, columns and values of its entries.
fn matrix_of(rows: usize, columns: usize, entries: Vec<(usize, usize, f64)>) -> CscMatrix<f64> {
    let (of_rows, of_columns, values) = entries.into_iter().collect();
    CscMatrix::new_from_triplets(rows, columns, of_rows, of_columns, values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_free_and_constrained_minima_and_refuses_contradictions() {
        // (x - 1)^2 + (y - 2)^2.
        let dense = || Curvature::Dense(vec![2.0, 0.0, 0.0, 2.0]);
        let mut program = QuadraticProgram { curvature: dense(), gradient: vec![-2.0, -4.0], rules: Vec::new() };
        program.rules.push((vec![(0, 1.0)], -10.0));
        let free = program.solve().unwrap();
        assert!((free[0] - 1.0).abs() < 1e-6 && (free[1] - 2.0).abs() < 1e-6, "{free:?}");
        // x + y <= 1, x >= 0.5: the corner (0.5, 0.5).
        program.rules.push((vec![(0, -1.0), (1, -1.0)], -1.0));
        program.rules.push((vec![(0, 1.0)], 0.5));
        let corner = program.solve().unwrap();
        assert!((corner[0] - 0.5).abs() < 1e-6 && (corner[1] - 0.5).abs() < 1e-6, "{corner:?}");
        // The same matrix with a factor: 2 = 1.5 + 0.5.
        let half = 0.5_f64.sqrt();
        program.curvature = Curvature::Factored { diagonal: vec![1.5, 1.5], rows: vec![half, 0.0, 0.0, half] };
        let again = program.solve().unwrap();
        assert!(again.len() == 2 && (again[0] - 0.5).abs() < 1e-6 && (again[1] - 0.5).abs() < 1e-6, "{again:?}");
        program.curvature = dense();
        program.rules.push((vec![(1, 1.0)], 0.7));
        assert_eq!(program.solve(), None);
    }

    /// The duality gap bounds what the objective is above its minimum: (x - 2)^2 / 2 + (y - 2)^2 /
    /// 2 for x and y up to 1. The solver divides by the largest element, 2, and compares with the
    /// minimum, -1.5.
    #[test]
    fn objective_is_within_its_tolerance() {
        let curvature = Curvature::Dense(vec![1.0, 0.0, 0.0, 1.0]);
        let rules = (0..2).flat_map(|i| [1.0, -1.0].map(|sign| (vec![(i, sign)], -1.0))).collect();
        let x = QuadraticProgram { curvature, gradient: vec![-2.0, -2.0], rules }.solve().unwrap();
        let above = x.iter().map(|x| (0.5 * x * x - 2.0 * x) + 1.5).sum::<f64>();
        assert!(above <= 2.0 * 1.5 * GAP, "{above}");
    }

    /// Short steps near an optimum are as accurate as long ones. Their objective is so small that
    /// the tolerance of the objective alone would end the solver early: with the solver's own
    /// tolerance of the gradient, 1e-8, the gradient left is 3e-8, and 3e-10 with ours.
    #[test]
    fn short_steps_are_accurate() {
        let (step, limit) = (1e-3, 1e-2);
        let rules = (0..2).flat_map(|i| [1.0, -1.0].map(|sign| (vec![(i, sign)], -limit)));
        for weak in [1e-1, 1e-2, 1e-3] {
            let program = QuadraticProgram {
                curvature: Curvature::Dense(vec![1.0, 0.0, 0.0, weak]),
                gradient: vec![-step, -weak * step],
                rules: rules.clone().collect(),
            };
            let x = program.solve().unwrap();
            let left = (x[0] - step).abs().max(weak * (x[1] - step).abs());
            assert!(left < 2e-9, "{weak}: {left}");
        }
    }

    /// The output of the program is the caller's. The solver prints its iterations unless it is
    /// told not to, which only another process can observe.
    #[test]
    fn solver_prints_nothing() {
        let name = "descent::quadratic::tests::finds_free_and_constrained_minima_and_refuses_contradictions";
        let tests = std::env::current_exe().unwrap();
        let run = std::process::Command::new(tests).args(["--exact", name, "--nocapture"]).output().unwrap();
        let printed = String::from_utf8(run.stdout).unwrap();
        // The lines of the test runner: a blank line, the count, the test, a blank line, the
        // result.
        let lines: Vec<&str> = printed.lines().filter(|line| !line.is_empty()).collect();
        assert_eq!(lines.len(), 3, "{printed}");
        assert!(lines[1].starts_with(&format!("test {name}")), "{printed}");
    }

    /// A diagonal and two rows, whose product is no diagonal: the free minimum solves H x = -g, by
    /// hand with H = (3 + 4, 2; 2, 5 + 1 + 9).
    #[test]
    fn factored_curvature_is_the_diagonal_and_the_product_of_rows() {
        let curvature = Curvature::Factored { diagonal: vec![3.0, 5.0], rows: vec![2.0, 1.0, 0.0, 3.0] };
        assert_eq!(curvature.largest(2), 15.0);
        let x = [0.3, -0.2];
        let gradient = vec![-(7.0 * x[0] + 2.0 * x[1]), -(2.0 * x[0] + 15.0 * x[1])];
        let rules = (0..2).flat_map(|i| [1.0, -1.0].map(|sign| (vec![(i, sign)], -1.0))).collect();
        let mut program = QuadraticProgram { curvature, gradient, rules };
        let found = program.solve().unwrap();
        assert!((found[0] - x[0]).abs() < 1e-6 && (found[1] - x[1]).abs() < 1e-6, "{found:?}");
        program.curvature = Curvature::Dense(vec![7.0, 2.0, f64::NAN, 15.0]);
        assert_eq!(program.curvature.largest(2), 15.0);
        let found = program.solve().unwrap();
        assert!((found[0] - x[0]).abs() < 1e-6 && (found[1] - x[1]).abs() < 1e-6, "{found:?}");
        // Many variables have a diagonal without rows.
        let Curvature::Factored { diagonal, rows } = Curvature::diagonal(vec![2.0; FACTORED_FROM]) else {
            panic!("dense")
        };
        assert!(diagonal == [2.0; FACTORED_FROM] && rows.is_empty());
        let Curvature::Dense(few) = Curvature::diagonal(vec![2.0, 3.0]) else { panic!("factored") };
        assert_eq!(few, [2.0, 0.0, 0.0, 3.0]);
    }
}

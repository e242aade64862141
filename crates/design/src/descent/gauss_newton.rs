//! Local descent: damped Gauss-Newton steps, each a quadratic program that keeps the rules.

use std::ops::ControlFlow;

use magsplice_layout::Goal;

use crate::descent::curvature;
use crate::descent::quadratic::{Curvature, QuadraticProgram};
use crate::problem::least_squares::{Candidate, LeastSquares};
use crate::problem::objective::Residuals;
use crate::problem::pattern::{Pattern, VariableKind};
use crate::problem::rules::LinearRule;
use crate::tolerances::{
    FACTORED_FROM, FIRST_DAMPING, KEPT_MM, LEAST_DAMPING, LEAST_GAIN, LESS_DAMPING, MORE_DAMPING, MOST_DAMPING,
    NOTHING_LEFT, PATIENCE, PRICE_OF_AMPLITUDE,
};

impl LeastSquares {
    /// The nearest film that keeps the rules.
    ///
    /// # Errors
    /// If no film keeps them, the rules that these variables break.
    pub(crate) fn nearest(&self, pattern: &Pattern, variables: &[f64]) -> Result<Vec<f64>, Vec<LinearRule>> {
        let rules = self.rules(pattern, variables);
        let (constant, rules): (Vec<LinearRule>, Vec<LinearRule>) =
            rules.into_iter().partition(|rule| rule.value.terms.is_empty());
        let broken: Vec<LinearRule> = constant.into_iter().filter(|rule| rule.value.constant < -KEPT_MM).collect();
        if !broken.is_empty() {
            return Err(broken);
        }
        if rules.iter().all(|rule| rule.value.eval(variables) >= -KEPT_MM) {
            return Ok(variables.to_vec());
        }
        let n = variables.len();
        let curvature = Curvature::diagonal(self.steps(pattern).into_iter().map(|step| 1.0 / (step * step)).collect());
        let program = QuadraticProgram { curvature, gradient: vec![0.0; n], rules: around(&rules, variables) };
        match program.solve() {
            Some(change) => Ok(moved(variables, &change)),
            None => Err(rules.into_iter().filter(|rule| rule.value.eval(variables) < -KEPT_MM).collect()),
        }
    }

    /// Whether the residuals are linear in the variables, with constant bounds.
    fn is_linear(&self, pattern: &Pattern) -> bool {
        self.objective.goal == Goal::Field && pattern.kinds.iter().all(|kind| *kind == VariableKind::Strength)
    }

    /// Descends from `start`, which keeps the rules, until the gain is small or `observe` breaks
    /// off. `observe` is called after every step, successful or not.
    pub(crate) fn descend(
        &self,
        pattern: &Pattern,
        start: Vec<f64>,
        most_steps: usize,
        observe: &mut dyn FnMut(&Candidate) -> ControlFlow<()>,
    ) -> Option<Candidate> {
        let mut residuals = self.residuals(pattern, &start, true)?;
        let mut candidate = self.candidate(start, &residuals);
        // A single step without length limit solves a linear problem.
        let linear = self.is_linear(pattern);
        let steps = if linear { vec![f64::INFINITY; candidate.variables.len()] } else { self.steps(pattern) };
        let mut damping = if linear { LEAST_DAMPING } else { FIRST_DAMPING };
        let mut merits = vec![candidate.merit()];
        while merits.len() <= most_steps && damping <= MOST_DAMPING && !candidate.variables.is_empty() {
            let rules: Vec<LinearRule> = self
                .rules(pattern, &candidate.variables)
                .into_iter()
                .filter(|rule| !rule.value.terms.is_empty())
                .collect();
            // The price is proportional to the remaining loss. A price far above the true cost of
            // amplitude would forbid every step along the curved bound.
            let price = PRICE_OF_AMPLITUDE * candidate.loss;
            let program = self.model(&residuals, &rules, &candidate.variables, &steps, damping, price);
            let better = program.solve().and_then(|change| {
                let variables = moved(&candidate.variables, &change[..candidate.variables.len()]);
                let next = self.candidate_at(pattern, variables)?;
                (next.loss + price * next.lack < candidate.loss + price * candidate.lack).then_some(next)
            });
            let Some(better) = better else {
                damping *= MORE_DAMPING;
                if observe(&candidate).is_break() {
                    break;
                }
                continue;
            };
            damping = (damping * LESS_DAMPING).max(LEAST_DAMPING);
            candidate = better;
            merits.push(candidate.merit());
            if observe(&candidate).is_break() || linear || self.is_done(&candidate) {
                break;
            }
            let before = merits.len().checked_sub(1 + PATIENCE).map(|index| merits[index]);
            if before.is_some_and(|before| candidate.merit() > (1.0 - LEAST_GAIN) * before) {
                break;
            }
            residuals = self.residuals(pattern, &candidate.variables, true)?;
        }
        Some(candidate)
    }

    /// Whether nothing is left to improve: neither error nor amplitude.
    fn is_done(&self, candidate: &Candidate) -> bool {
        let unit = match self.objective.goal {
            Goal::Displacement => 1.0 / self.objective.ideal.wavenumber(),
            _ => 1.0,
        };
        candidate.lack == 0.0 && candidate.root_mean_square() < NOTHING_LEFT * unit
    }

    /// The quadratic program of one step: residuals and amplitude linearized, within step lengths
    /// and rules. The lacking amplitude is one more variable.
    fn model(
        &self,
        residuals: &Residuals,
        rules: &[LinearRule],
        variables: &[f64],
        steps: &[f64],
        damping: f64,
        price: f64,
    ) -> QuadraticProgram {
        let n = variables.len();
        let all = n + usize::from(self.least_amplitude.is_some());
        let mut gradient = vec![0.0; all];
        residuals.add_gradient(n, &mut gradient);
        let units: Vec<f64> = steps.iter().map(|step| if step.is_finite() { *step } else { 1.0 }).collect();
        let curvature = if n < FACTORED_FROM {
            let mut dense = curvature::dense(residuals, n, all);
            let own: Vec<f64> = (0..n).map(|i| dense[i * all + i]).collect();
            let damping = curvature::damped(&own, &units, damping);
            damping.into_iter().enumerate().for_each(|(i, damping)| dense[i * all + i] += damping);
            Curvature::Dense(dense)
        } else {
            let mut rows = curvature::reduced(&self.distinct_rows(residuals, n), &units);
            let mut rest = vec![0.0; n];
            if let Some(expected) = &residuals.expected {
                let factors;
                (factors, rest) = curvature::factored(&expected.curvature, &units);
                rows.extend(factors);
            }
            let own: Vec<f64> = (0..n)
                .map(|i| rest[i] + rows.iter().skip(i).step_by(n).map(|value| value * value).sum::<f64>())
                .collect();
            let mut diagonal: Vec<f64> = curvature::damped(&own, &units, damping)
                .into_iter()
                .zip(rest)
                .map(|(damping, rest)| damping + rest)
                .collect();
            diagonal.resize(all, 0.0);
            // The lacking amplitude has no curvature.
            let mut with_lack = Vec::with_capacity(rows.len() / n * all);
            for row in rows.chunks_exact(n) {
                with_lack.extend_from_slice(row);
                with_lack.resize(with_lack.len() + all - n, 0.0);
            }
            Curvature::Factored { diagonal, rows: with_lack }
        };
        let mut limits = around(rules, variables);
        for (i, step) in steps.iter().enumerate().filter(|(_, step)| step.is_finite()) {
            limits.push((vec![(i, 1.0)], -step));
            limits.push((vec![(i, -1.0)], -step));
        }
        if let Some(least) = self.least_amplitude {
            gradient[n] = price;
            for (amplitude, derivatives) in &residuals.amplitudes {
                let mut terms: Vec<(usize, f64)> = derivatives.iter().copied().enumerate().collect();
                terms.push((n, 1.0));
                limits.push((terms, least - amplitude));
            }
            limits.push((vec![(n, 1.0)], 0.0));
        }
        QuadraticProgram { curvature, gradient, rules: limits }
    }
}

impl LeastSquares {
    /// The derivatives of the residuals, where one row stands for all rows that are multiples of it
    /// by symmetry: the sum of squares is the same.
    fn distinct_rows(&self, residuals: &Residuals, n: usize) -> Vec<f64> {
        let Some(classes) = self.sampling.classes() else { return residuals.derivatives.clone() };
        let count = classes.iter().max().map_or(0, |last| last + 1);
        // For each class the sum of squares, the largest square, and its row.
        let mut found = vec![(0.0, 0.0, 0); count];
        for (row, (&class, values)) in classes.iter().zip(residuals.derivatives.chunks_exact(n)).enumerate() {
            let square = values.iter().map(|value| value * value).sum::<f64>();
            let of_class = &mut found[class];
            of_class.0 += square;
            if square > of_class.1 {
                (of_class.1, of_class.2) = (square, row);
            }
        }
        let mut rows = Vec::new();
        for (all, largest, row) in found.into_iter().filter(|of_class| of_class.1 > 0.0) {
            let factor = (all / largest).sqrt();
            rows.extend(residuals.derivatives[row * n..][..n].iter().map(|value| factor * value));
        }
        rows
    }
}

/// Rules as inequalities of the change of the variables.
fn around(rules: &[LinearRule], variables: &[f64]) -> Vec<(Vec<(usize, f64)>, f64)> {
    rules.iter().map(|rule| (rule.value.terms.clone(), -rule.value.eval(variables))).collect()
}

fn moved(variables: &[f64], change: &[f64]) -> Vec<f64> {
    variables.iter().zip(change).map(|(value, change)| value + change).collect()
}

#[cfg(test)]
mod tests;

//! From one film to the best near it: Gauss-Newton steps with damping, each a quadratic program that keeps the rules.

use std::ops::ControlFlow;

use magsplice_layout::Goal;

use crate::objective::{Errors, Objective};
use crate::pattern::{Kind, Pattern};
use crate::quadratic::Quadratic;
use crate::rules::{Bounds, Rule};
use crate::sampling::Sampling;
use crate::tolerances::{
    FIRST_DAMPING, LEAST_DAMPING, LEAST_GAIN, LESS_DAMPING, LONGEST_STEP, MORE_DAMPING, MOST_DAMPING, PATIENCE,
    PRICE_OF_AMPLITUDE, STRONGEST_STEP, WIDEST_STEP,
};

/// What a film is designed for, and on which points.
#[derive(Clone, Debug)]
pub(crate) struct Problem {
    pub(crate) sampling: Sampling,
    pub(crate) objective: Objective,
    pub(crate) bounds: Bounds,
    /// The best-fit amplitude must be at least this.
    pub(crate) least_amplitude: Option<f64>,
}

/// Values of the variables of a pattern, and how good that film is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Found {
    pub(crate) at: Vec<f64>,
    /// Half the sum of squared errors.
    pub(crate) loss: f64,
    /// By how much the amplitude is below the least.
    pub(crate) lack: f64,
}

impl Found {
    /// Which of two films is better: the one with less of this.
    pub(crate) fn merit(&self) -> f64 {
        self.loss * (1.0 + PRICE_OF_AMPLITUDE * self.lack)
    }
}

impl Problem {
    /// How good a film is; `None` where it has no field or no parameters.
    pub(crate) fn found_at(&self, pattern: &Pattern, at: Vec<f64>) -> Option<Found> {
        let errors = self.errors(pattern, &at, false)?;
        Some(self.found(at, &errors))
    }

    fn found(&self, at: Vec<f64>, errors: &Errors) -> Found {
        let amplitude = errors.amplitudes.iter().map(|(amplitude, _)| *amplitude).fold(f64::INFINITY, f64::min);
        let lack = self.least_amplitude.map_or(0.0, |least| (least - amplitude).max(0.0));
        Found { at, loss: errors.loss(), lack }
    }

    pub(crate) fn errors(&self, pattern: &Pattern, at: &[f64], with_slopes: bool) -> Option<Errors> {
        self.objective.errors(&self.sampling, &self.sampling.field(pattern, at, with_slopes)?)
    }

    /// The longest step of a variable.
    fn step(&self, kind: Kind) -> f64 {
        match kind {
            Kind::Length => LONGEST_STEP * self.objective.ideal.wavelength(),
            Kind::Angle => WIDEST_STEP,
            Kind::Strength => STRONGEST_STEP * self.bounds.strength_t.map_or(f64::INFINITY, |[_, most]| most),
        }
    }

    /// The longest steps of all variables of a pattern.
    pub(crate) fn steps(&self, pattern: &Pattern) -> Vec<f64> {
        pattern.kinds.iter().map(|kind| self.step(*kind)).collect()
    }

    /// Whether errors are linear in the variables, with constant bounds.
    fn is_linear(&self, pattern: &Pattern) -> bool {
        self.objective.goal == Goal::Field && pattern.kinds.iter().all(|kind| *kind == Kind::Strength)
    }

    pub(crate) fn rules(&self, pattern: &Pattern, at: &[f64]) -> Vec<Rule> {
        let mut rules = self.bounds.of_tiles(pattern);
        // Each of two tiles may move and grow by a step.
        let reach = self.bounds.gap_mm + 4.0 * self.step(Kind::Length);
        rules.extend(self.bounds.of_pairs(pattern, at, reach));
        rules
    }

    /// The film nearest to this one that keeps the rules, or the rules that nothing can keep.
    pub(crate) fn nearest(&self, pattern: &Pattern, at: &[f64]) -> Result<Vec<f64>, Vec<Rule>> {
        let rules = self.rules(pattern, at);
        let (constant, rules): (Vec<Rule>, Vec<Rule>) = rules.into_iter().partition(|rule| rule.value.terms.is_empty());
        let slack = crate::tolerances::KEPT_MM;
        let broken: Vec<Rule> = constant.into_iter().filter(|rule| rule.value.constant < -slack).collect();
        if !broken.is_empty() {
            return Err(broken);
        }
        if rules.iter().all(|rule| rule.value.at(at) >= -slack) {
            return Ok(at.to_vec());
        }
        let n = at.len();
        let mut curvature = vec![0.0; n * n];
        for (i, step) in self.steps(pattern).into_iter().enumerate() {
            curvature[i * n + i] = 1.0 / (step * step);
        }
        let problem = Quadratic { curvature, gradient: vec![0.0; n], rules: around(&rules, at) };
        match problem.solve() {
            Some(change) => Ok(moved(at, &change)),
            None => Err(rules.into_iter().filter(|rule| rule.value.at(at) < -slack).collect()),
        }
    }

    /// Goes down from `at`, which keeps the rules, until nothing is gained any more or `watch` breaks off; it is told of every step, better or not.
    pub(crate) fn descend(
        &self,
        pattern: &Pattern,
        at: Vec<f64>,
        most_steps: usize,
        watch: &mut dyn FnMut(&Found) -> ControlFlow<()>,
    ) -> Option<Found> {
        let mut errors = self.errors(pattern, &at, true)?;
        let mut found = self.found(at, &errors);
        // A linear problem is solved as one: by a single step as long as it may be.
        let linear = self.is_linear(pattern);
        let steps = if linear { vec![f64::INFINITY; found.at.len()] } else { self.steps(pattern) };
        let mut damping = if linear { LEAST_DAMPING } else { FIRST_DAMPING };
        let mut merits = vec![found.merit()];
        while merits.len() <= most_steps && damping <= MOST_DAMPING && !found.at.is_empty() {
            let rules: Vec<Rule> =
                self.rules(pattern, &found.at).into_iter().filter(|rule| !rule.value.terms.is_empty()).collect();
            // In proportion to what is left of the errors: a price far above what amplitude costs would forbid every step along the curved bound.
            let price = PRICE_OF_AMPLITUDE * found.loss;
            let better = self.model(&errors, &rules, &found.at, &steps, damping, price).solve().and_then(|change| {
                let at = moved(&found.at, &change[..found.at.len()]);
                let next = self.found_at(pattern, at)?;
                (next.loss + price * next.lack < found.loss + price * found.lack).then_some(next)
            });
            let Some(better) = better else {
                damping *= MORE_DAMPING;
                if watch(&found).is_break() {
                    break;
                }
                continue;
            };
            damping = (damping * LESS_DAMPING).max(LEAST_DAMPING);
            found = better;
            merits.push(found.merit());
            if watch(&found).is_break() || linear {
                break;
            }
            let before = merits.len().checked_sub(1 + PATIENCE).map(|index| merits[index]);
            if before.is_some_and(|before| found.merit() > (1.0 - LEAST_GAIN) * before) {
                break;
            }
            errors = self.errors(pattern, &found.at, true)?;
        }
        Some(found)
    }

    /// Errors and amplitude as linear functions of the change, within steps and rules. What lacks in amplitude is one more variable.
    fn model(&self, errors: &Errors, rules: &[Rule], at: &[f64], steps: &[f64], damping: f64, price: f64) -> Quadratic {
        let n = at.len();
        let all = n + usize::from(self.least_amplitude.is_some());
        let mut curvature = vec![0.0; all * all];
        let mut gradient = vec![0.0; all];
        for (value, row) in errors.values.iter().zip(errors.slopes.chunks_exact(n)) {
            for i in 0..n {
                gradient[i] += value * row[i];
                for k in i..n {
                    curvature[i * all + k] += row[i] * row[k];
                }
            }
        }
        // In units of the steps, so that damping does not depend on units; a part for every variable alike, for those that change nothing.
        let unit = |i: usize| if steps[i].is_finite() { steps[i] } else { 1.0 };
        let largest = (0..n).map(|i| curvature[i * all + i] * unit(i) * unit(i)).fold(0.0, f64::max);
        for i in 0..n {
            let own = curvature[i * all + i];
            curvature[i * all + i] += damping * (own + LEAST_CURVATURE * largest / (unit(i) * unit(i)));
        }
        let mut limits = around(rules, at);
        for (i, step) in steps.iter().enumerate().filter(|(_, step)| step.is_finite()) {
            limits.push((vec![(i, 1.0)], -step));
            limits.push((vec![(i, -1.0)], -step));
        }
        if let Some(least) = self.least_amplitude {
            gradient[n] = price;
            for (amplitude, slopes) in &errors.amplitudes {
                let mut terms: Vec<(usize, f64)> = slopes.iter().copied().enumerate().collect();
                terms.push((n, 1.0));
                limits.push((terms, least - amplitude));
            }
            limits.push((vec![(n, 1.0)], 0.0));
        }
        Quadratic { curvature, gradient, rules: limits }
    }
}

/// Damping of variables that change nothing, as a fraction of that of the one that changes most.
const LEAST_CURVATURE: f64 = 1e-3;

/// Rules as inequalities of the change.
fn around(rules: &[Rule], at: &[f64]) -> Vec<(Vec<(usize, f64)>, f64)> {
    rules.iter().map(|rule| (rule.value.terms.clone(), -rule.value.at(at))).collect()
}

fn moved(at: &[f64], change: &[f64]) -> Vec<f64> {
    at.iter().zip(change).map(|(value, change)| value + change).collect()
}

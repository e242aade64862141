//! The least-squares problem of a design, and the films that are compared in it.

use crate::problem::error_model::{ErrorModel, RobustFilm};
use crate::problem::objective::{Objective, Residuals};
use crate::problem::pattern::{Pattern, VariableKind};
use crate::problem::rules::{DesignBounds, LinearRule};
use crate::problem::sampling::Sampling;
use crate::tolerances::{LONGEST_STEP, PRICE_OF_AMPLITUDE, STRONGEST_STEP, WIDEST_STEP};

/// The least-squares problem of a design: objective, points and bounds.
#[derive(Clone, Debug)]
pub(crate) struct LeastSquares {
    pub(crate) sampling: Sampling,
    pub(crate) objective: Objective,
    pub(crate) bounds: DesignBounds,
    /// Lower bound of the best-fit amplitude.
    pub(crate) least_amplitude: Option<f64>,
    /// Errors of films as made, if their expected square is minimized too.
    pub(crate) errors: Option<ErrorModel>,
}

/// A film of a pattern: values of its variables, and how good the film is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Candidate {
    pub(crate) variables: Vec<f64>,
    /// Half the sum of squared residuals.
    pub(crate) loss: f64,
    /// Shortfall of the amplitude below its lower bound, at least 0.
    pub(crate) lack: f64,
}

impl Candidate {
    /// The loss, increased by a penalty for lacking amplitude. The better of two films has the
    /// smaller merit.
    pub(crate) fn merit(&self) -> f64 {
        self.loss * (1.0 + PRICE_OF_AMPLITUDE * self.lack)
    }

    /// Root mean square of the residuals, whose weights contain 1 over the number of points.
    pub(crate) fn root_mean_square(&self) -> f64 {
        (2.0 * self.loss).sqrt()
    }
}

impl LeastSquares {
    /// Evaluates a film. `None` where it has no field or no decoupling parameters.
    pub(crate) fn candidate_at(&self, pattern: &Pattern, variables: Vec<f64>) -> Option<Candidate> {
        let residuals = self.residuals(pattern, &variables, false)?;
        Some(self.candidate(variables, &residuals))
    }

    pub(crate) fn candidate(&self, variables: Vec<f64>, residuals: &Residuals) -> Candidate {
        let amplitude = residuals.amplitudes.iter().map(|(amplitude, _)| *amplitude).fold(f64::INFINITY, f64::min);
        let lack = self.least_amplitude.map_or(0.0, |least| (least - amplitude).max(0.0));
        Candidate { variables, loss: residuals.loss(), lack }
    }

    pub(crate) fn residuals(&self, pattern: &Pattern, variables: &[f64], with_derivatives: bool) -> Option<Residuals> {
        let LeastSquares { sampling, objective, errors, .. } = self;
        let field = sampling.field(pattern, variables, with_derivatives)?;
        let mut residuals = objective.residuals(sampling, &field)?;
        if let Some(errors) = errors {
            let film = RobustFilm { sampling, objective, pattern, variables, field: &field };
            residuals.expected = Some(errors.expected_squares(&film)?);
        }
        Some(residuals)
    }

    /// The longest step of a variable.
    fn step(&self, kind: VariableKind) -> f64 {
        match kind {
            VariableKind::Length => LONGEST_STEP * self.objective.ideal.wavelength(),
            VariableKind::Angle => WIDEST_STEP,
            VariableKind::Strength => STRONGEST_STEP * self.bounds.strength_t.map_or(f64::INFINITY, |[_, most]| most),
        }
    }

    /// The longest steps of all variables of a pattern.
    pub(crate) fn steps(&self, pattern: &Pattern) -> Vec<f64> {
        pattern.kinds.iter().map(|kind| self.step(*kind)).collect()
    }

    pub(crate) fn rules(&self, pattern: &Pattern, variables: &[f64]) -> Vec<LinearRule> {
        let mut rules = self.bounds.rules_of_tiles(pattern);
        // Each of two tiles may move and grow by a step.
        let reach = self.bounds.gap.least_mm + 4.0 * self.step(VariableKind::Length);
        rules.extend(self.bounds.rules_of_pairs(pattern, variables, reach));
        rules
    }
}

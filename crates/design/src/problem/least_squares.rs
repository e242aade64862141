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

#[cfg(test)]
mod tests {
    use magsplice_layout::Layout;

    use super::*;
    use crate::problem::design_problem::DesignProblem;

    /// Two tiles of 2 mm, this far apart along x.
    fn layout(apart_mm: f64, design: &str) -> Layout {
        let x = 2.0 + apart_mm;
        let text = format!(
            "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
             [volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 2.0\n[design]\n{design}\n\
             [[tile]]\nposition_mm = [0, 0, 0.5]\nsize_mm = [2, 2, 1]\npolarization_t = [0.1, 0, 0]\n\
             [[tile]]\nposition_mm = [{x}, 0, 0.5]\nsize_mm = [2, 2, 1]\npolarization_t = [-0.1, 0, 0]\n"
        );
        Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn merit_is_the_loss_with_the_price_of_amplitude() {
        let film = Candidate { variables: Vec::new(), loss: 2.0, lack: 0.01 };
        assert_eq!((film.merit(), film.root_mean_square()), (6.0, 2.0));
    }

    /// The least amplitude of all grids counts. A film above the bound lacks nothing.
    #[test]
    fn lack_is_that_of_the_least_amplitude() {
        let layout = layout(0.5, "vary = [\"size\"]\namplitude = { min = 0.5 }");
        let mut squares = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}")).least_squares;
        squares.least_amplitude = Some(0.5);
        let lack = |squares: &LeastSquares, amplitudes: [f64; 2]| {
            let amplitudes = amplitudes.map(|amplitude| (amplitude, Vec::new())).to_vec();
            let residuals = Residuals { values: vec![3.0, 4.0], derivatives: Vec::new(), amplitudes, expected: None };
            let film = squares.candidate(vec![1.0], &residuals);
            assert_eq!((film.loss, film.variables), (12.5, vec![1.0]));
            film.lack
        };
        assert!((lack(&squares, [0.4, 0.7]) - 0.1).abs() < 1e-15 && (lack(&squares, [0.7, 0.4]) - 0.1).abs() < 1e-15);
        assert_eq!(lack(&squares, [0.6, 0.7]), 0.0);
        squares.least_amplitude = None;
        assert_eq!(lack(&squares, [0.1, 0.2]), 0.0);
    }

    /// A twentieth of the wavelength, 0.3 radians, and 0.3 of the largest strength.
    #[test]
    fn longest_steps_have_the_units_of_their_variables() {
        let strengths = "strength_t = { min = 0.0, max = 0.2 }";
        let layout = layout(0.5, &format!("vary = [\"size\", \"direction\", \"strength\"]\n{strengths}"));
        let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
        for (kind, step) in problem.pattern.kinds.iter().zip(problem.least_squares.steps(&problem.pattern)) {
            let known = match kind {
                VariableKind::Length => 0.5,
                VariableKind::Angle => 0.3,
                VariableKind::Strength => 0.06,
            };
            assert!((step - known).abs() < 1e-15, "{kind:?}: {step}");
        }
    }

    /// Tiles that may meet in one step have a rule: each may move and grow by 0.5 mm.
    #[test]
    fn tiles_that_cannot_meet_have_no_rule() {
        for (apart_mm, gap_mm, rules) in [(1.99, 0.0, 1), (2.01, 0.0, 0), (2.01, 0.1, 1), (2.11, 0.1, 0)] {
            let layout = layout(apart_mm, &format!("vary = [\"size\", \"position\"]\ngap_mm = {gap_mm}"));
            let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
            let all = problem.least_squares.rules(&problem.pattern, &problem.pattern.start);
            let pairs: Vec<&LinearRule> = all.iter().filter(|rule| rule.tiles.1.is_some()).collect();
            assert_eq!(pairs.len(), rules, "{apart_mm} {gap_mm}");
            assert!(
                pairs
                    .iter()
                    .all(|rule| { (rule.value.eval(&problem.pattern.start) - (apart_mm - gap_mm)).abs() < 1e-12 })
            );
        }
    }
}

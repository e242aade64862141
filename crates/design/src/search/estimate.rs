//! The time of a search, estimated from its first step.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use crate::error::DesignError;
use crate::problem::design_problem::DesignProblem;
use crate::tolerances::{MOST_STEPS, PARTS_SINGLY, PARTS_TRIED, TRIAL_STEPS, TRIALS_FINISHED};

/// The size of a search, and an estimate of its time.
#[derive(Clone, Copy, Debug)]
pub struct SearchEstimate {
    /// Number of tiles of the film.
    pub tiles: usize,
    /// Number of free parameters.
    pub variables: usize,
    /// Number of starts.
    pub starts: usize,
    /// Measured time of the first step of a descent, its evaluation included.
    pub step: Duration,
    /// Estimated time of the search. Most searches take between half and twice this time.
    pub total: Duration,
}

/// Share of the largest number of steps of a descent that a descent takes.
const SHARE_OF_STEPS: f64 = 0.6;

/// Rounds in which single tiles are moved to other parts.
const ROUNDS_OF_EXCHANGE: usize = 3;

impl DesignProblem<'_> {
    /// Estimates the time of [`DesignProblem::search`] on this number of threads. It takes the
    /// first step of the search and measures it.
    ///
    /// # Errors
    /// If no film keeps the rules, or the film to start from has no decoupling parameters.
    pub fn estimate(&self, threads: usize) -> Result<SearchEstimate, DesignError> {
        let begun = Instant::now();
        let start = self.least_squares.nearest(&self.pattern, &self.pattern.start);
        let start = start.map_err(|rules| self.contradiction(rules))?;
        let once = &mut |_: &_| ControlFlow::Break(());
        self.least_squares.descend(&self.pattern, start, 1, once).ok_or(DesignError::Singular)?;
        let step = begun.elapsed();
        let descent = SHARE_OF_STEPS * MOST_STEPS as f64;
        let rounds = self.brief.starts.div_ceil(threads.max(1));
        let steps = descent * rounds as f64 + self.steps_of_parts(threads.max(1), descent);
        let total = step.mul_f64(steps);
        let (tiles, variables) = (self.tiles.len(), self.variable_count());
        Ok(SearchEstimate { tiles, variables, starts: self.brief.starts, step, total })
    }

    /// Number of steps to merge parts, in steps of all threads together.
    fn steps_of_parts(&self, threads: usize, descent: f64) -> f64 {
        if self.brief.parts.is_none() && self.brief.stock.is_empty() {
            return 0.0;
        }
        let wanted = self.brief.parts.unwrap_or(self.brief.stock.len()).max(1);
        let finished = TRIALS_FINISHED.div_ceil(threads) as f64 * descent;
        let tried = |trials: usize| trials.div_ceil(threads) as f64 * TRIAL_STEPS as f64 + finished;
        let mut left = self.orbit_count();
        let mut steps = descent;
        while left > wanted {
            if left > PARTS_SINGLY {
                left = (left - left / 4).max(PARTS_SINGLY).max(wanted);
                steps += descent;
            } else {
                steps += tried(if left > PARTS_TRIED { TRIALS_FINISHED } else { left * (left - 1) });
                left -= 1;
            }
        }
        if self.orbit_count() <= PARTS_TRIED {
            steps += ROUNDS_OF_EXCHANGE as f64 * tried(2 * self.orbit_count() * wanted);
        }
        steps
    }
}

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
    ///
    /// # Panics
    /// In a WebAssembly module without imports, which has no clock.
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

#[cfg(test)]
mod tests {
    use magsplice_layout::Layout;

    use super::*;

    /// A film of this number of tiles in a row, with this brief.
    fn layout(tiles: usize, design: &str) -> Layout {
        let mut text = format!(
            "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
             [volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 2.0\n\
             [design]\nvary = [\"size\", \"position\"]\nsmallest_cut_mm = 0.5\n{design}\n"
        );
        for tile in 0..tiles {
            let x = 1.5 * (tile as f64 - 0.5 * tiles as f64);
            text += &format!(
                "[[tile]]\nposition_mm = [{x:?}, 0.1, 0.5]\nsize_mm = [1, 3, 1]\npolarization_t = [0.1, 0.05, 0.0]\n"
            );
        }
        Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"))
    }

    fn steps(tiles: usize, design: &str, threads: usize) -> f64 {
        let layout = layout(tiles, design);
        DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}")).steps_of_parts(threads, 90.0)
    }

    /// By hand, for descents of 90 steps, trials of 12 steps and 4 finished ones. Trials and
    /// finished ones are shared by the threads.
    #[test]
    fn steps_of_parts_are_the_trials_of_each_round() {
        assert_eq!(steps(8, "", 2), 0.0);
        // 8, 7 and 6 parts try 56, 42 and 30 pairs. Then 8 tiles go to 5 parts, both ways, thrice.
        let tried = |rounds: f64| rounds * 12.0 + 180.0;
        let known = 90.0 + tried(28.0) + tried(21.0) + tried(15.0) + 3.0 * tried(40.0);
        assert_eq!(steps(8, "parts = 5", 2), known);
        // The parts in stock are the number that is wanted, unless the brief gives one.
        let stock = "stock = [{ size_mm = [1.0, 3.0], direction_deg = 30.0 }]";
        let single = |trials: f64| trials * 12.0 + 360.0;
        let known = 90.0 + single(2.0) + 3.0 * single(4.0);
        assert_eq!(steps(2, stock, 1), known);
        assert_eq!(steps(2, &format!("parts = 2\n{stock}"), 1), 90.0 + 3.0 * single(8.0));
        // A quarter of 40 parts, then of 30, down to 24, is merged at once; then four pairs are
        // tried down to 12 parts, and all pairs of fewer. So many tiles are not moved one by one.
        let known = 90.0 + 2.0 * 90.0 + 12.0 * (4.0 * 12.0 + 360.0) + single(132.0) + single(110.0);
        assert_eq!(steps(40, "parts = 10", 1), known);
        assert_eq!(steps(40, "parts = 28", 1), 90.0 + 2.0 * 90.0);
    }

    /// The starts take 0.6 of their largest number of steps, in rounds of the threads.
    #[test]
    fn estimate_is_the_time_of_all_steps() {
        let layout = layout(3, "starts = 7\nparts = 2");
        let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
        for (threads, rounds) in [(1, 7.0), (3, 3.0), (0, 7.0)] {
            let found = problem.estimate(threads).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!((found.tiles, found.variables, found.starts), (3, 12, 7));
            let steps = rounds * 90.0 + problem.steps_of_parts(threads.max(1), 90.0);
            let ratio = found.total.as_secs_f64() / found.step.as_secs_f64();
            assert!((ratio / steps - 1.0).abs() < 1e-3, "{threads}: {ratio}, not {steps}");
        }
    }
}

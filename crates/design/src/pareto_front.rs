//! Pareto fronts: error against amplitude, and error against the number of distinct parts.

use std::ops::ControlFlow;

use magsplice_layout::{Brief, Goal, Variable};

use crate::error::DesignError;
use crate::parts::merging;
use crate::problem::design_problem::DesignProblem;
use crate::problem::least_squares::Candidate;
use crate::progress::{SearchProgress, SearchStage, Watch};
use crate::search::search_result::SearchResult;
use crate::tolerances::MOST_STEPS;

/// The best films found for a series of demands.
#[derive(Clone, Debug, serde::Serialize)]
pub struct ParetoFront {
    /// The film found for each least amplitude, in ascending order of the amplitude, with any
    /// number of parts.
    pub by_amplitude: Vec<(f64, SearchResult)>,
    /// The films found with fewer and fewer distinct parts, at the least amplitude of the layout.
    /// Empty where sizes and positions are not both free, or tilts are.
    pub by_parts: Vec<SearchResult>,
}

impl ParetoFront {
    /// The front without dominated films. A film that misses a demand stays, and dominates none.
    fn without_dominated(self) -> ParetoFront {
        let ParetoFront { by_amplitude, by_parts } = self;
        let merits = |film: &SearchResult| (film.error, film.after.figures.amplitude, film.parts);
        let all = by_amplitude.iter().map(|(_, film)| film).chain(&by_parts);
        let rivals: Vec<Merits> = all.filter(|film| film.short_of.is_empty()).map(merits).collect();
        let stays = |film: &SearchResult| {
            !film.short_of.is_empty() || !rivals.iter().any(|rival| dominates(*rival, merits(film)))
        };
        ParetoFront {
            by_amplitude: by_amplitude.into_iter().filter(|(_, film)| stays(film)).collect(),
            by_parts: by_parts.into_iter().filter(stays).collect(),
        }
    }
}

/// Error, amplitude and number of parts of a film.
type Merits = (f64, f64, usize);

/// Whether a film is as good as another in everything, and better in something.
fn dominates(one: Merits, other: Merits) -> bool {
    one.0 <= other.0 && one.1 >= other.1 && one.2 <= other.2 && one != other
}

/// Number of starts for each amplitude, besides the film found for the amplitude before.
const STARTS: usize = 3;

impl DesignProblem<'_> {
    /// Searches for the best film for each of these least amplitudes, and for fewer and fewer
    /// parts.
    ///
    /// A film is left out if another film of the front is as good in error, amplitude and number of
    /// parts, and better in one of them. The error is the 95th percentile of films as made where
    /// the brief counts them. With 1000 samples it scatters by 1.3 %, and so does the ratio of two
    /// films: if two films differ by less, either may be left out.
    ///
    /// A film with more amplitude also meets a smaller bound, so errors grow along the front as far
    /// as the search succeeds. If `progress` stops the search, the front has the films found so
    /// far.
    ///
    /// # Errors
    /// As [`DesignProblem::search`].
    pub fn pareto_front(&self, amplitudes: &[f64], progress: SearchProgress) -> Result<ParetoFront, DesignError> {
        let watch = Watch::new(progress);
        let mut by_amplitude: Vec<(f64, SearchResult)> = Vec::new();
        // In descending order, because a film with more amplitude is a good start for less.
        let mut descending = amplitudes.to_vec();
        descending.sort_by(|a, b| b.total_cmp(a));
        let mut before: Option<Candidate> = None;
        for &amplitude in &descending {
            let (parts, stock) = (None, Vec::new());
            let brief = Brief { least_amplitude: Some(amplitude), parts, stock, starts: STARTS, ..self.brief.clone() };
            let mut problem = DesignProblem::from_brief(&self.layout, brief)?;
            problem.hold_recoil(&self.tiles)?;
            let mut starts = problem.best_of_starts(&watch)?;
            // With the field as the goal, each amplitude has its own target, so the film before is
            // no start.
            if let Some(before) = before.filter(|_| self.brief.goal != Goal::Field) {
                let start = problem.least_squares.nearest(&problem.pattern, &before.variables);
                let start = start.unwrap_or(before.variables);
                let go_on = &mut |_: &_| ControlFlow::Continue(());
                let again = problem.least_squares.descend(&problem.pattern, start, MOST_STEPS, go_on);
                if let Some(again) = again.filter(|again| again.merit() < starts.best.merit()) {
                    starts.best = again;
                }
            }
            before = Some(starts.best.clone());
            let (problem, starts) = problem.with_best_spacing(starts, &watch)?;
            by_amplitude.insert(0, (amplitude, problem.finished(starts, &watch)?));
            if watch.is_stopped() {
                break;
            }
        }
        let by_parts = self.front_of_parts(&watch)?;
        Ok(ParetoFront { by_amplitude, by_parts }.without_dominated())
    }

    fn front_of_parts(&self, watch: &Watch) -> Result<Vec<SearchResult>, DesignError> {
        let varies = |variable| self.brief.varies(variable);
        let exchanges = varies(Variable::Size) && varies(Variable::Position) && !varies(Variable::Tilt);
        if !exchanges || watch.is_stopped() {
            return Ok(Vec::new());
        }
        let mut problem = self.clone();
        problem.hold_recoil(&self.tiles)?;
        let starts = problem.best_of_starts(watch)?;
        let (mut problem, starts) = problem.with_best_spacing(starts, watch)?;
        let best = problem.settle_recoil(&self.pattern, starts.best, watch)?;
        problem.leave_room_for_rounding();
        // Down to the parts in stock, or to a single part.
        let least = usize::from(self.brief.stock.is_empty());
        let levels = merging::levels(&problem, &problem.pattern, &best, least, watch);
        let result = |level: merging::FilmOfParts| {
            let stage = SearchStage::Parts(level.part_count());
            let stages = vec![problem.stage_metrics(stage, &level.pattern, &level.candidate)?];
            let brief = Brief { parts: None, ..problem.brief.clone() };
            let rounding = DesignProblem { brief, ..problem.clone() };
            rounding.rounded(&level.pattern, level.candidate, stages, 1, watch)
        };
        levels.into_iter().map(result).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn films_worse_in_everything_are_dominated() {
        let film = (0.02, 0.7, 9);
        for better in [(0.01, 0.75, 8), (0.02, 0.7, 8), (0.02, 0.71, 9), (0.019, 0.7, 9)] {
            assert!(dominates(better, film) && !dominates(film, better), "{better:?}");
        }
        for other in [film, (0.01, 0.65, 8), (0.01, 0.75, 10), (0.03, 0.75, 8)] {
            assert!(!dominates(other, film), "{other:?}");
        }
    }
}

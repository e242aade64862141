//! Fewer distinct parts: pairs of parts are merged, the cheapest pair first.
//!
//! A part is a size with a direction of polarization. A tile is a part in one of the eight
//! orientations of a rectangle, turned over included. The reduction begins with one part per tile.
//! Each round merges the pair of parts that costs least, which is found by designing the film anew.
//! Parts in stock absorb tiles likewise.

use std::ops::ControlFlow;

use glam::DVec3;
use magsplice_layout::{Brief, Layout, Variable};
use magsplice_magnet::Tile;
use rayon::prelude::*;

use crate::parts::assignment::PartAssignment;
use crate::problem::design_problem::DesignProblem;
use crate::problem::least_squares::Candidate;
use crate::problem::pattern::Pattern;
use crate::progress::{ProgressUpdate, SearchStage, Watch};
use crate::tolerances::{MOST_STEPS, PARTS_SINGLY, PARTS_TRIED, TRIAL_STEPS, TRIALS_FINISHED};

/// A film whose tiles share parts.
#[derive(Clone, Debug)]
pub(crate) struct FilmOfParts {
    assignment: PartAssignment,
    pub(crate) pattern: Pattern,
    pub(crate) candidate: Candidate,
}

impl FilmOfParts {
    /// Number of parts its tiles are made of.
    pub(crate) fn part_count(&self) -> usize {
        self.assignment.used().len()
    }

    fn update(&self, done: usize, of: usize) -> ProgressUpdate {
        let best = Some(self.candidate.root_mean_square());
        ProgressUpdate { stage: SearchStage::Parts(self.part_count()), done, of, best }
    }
}

/// Number of distinct parts of these tiles, as the bill of materials counts them.
pub(crate) fn count_distinct(layout: &Layout, tiles: &[Tile]) -> usize {
    let mut layout = layout.clone();
    layout.tiles.iter_mut().zip(tiles).for_each(|(named, tile)| named.tile = *tile);
    layout.tiles.retain(|named| named.tile.polarization_t() != DVec3::ZERO);
    layout.parts().len()
}

/// The best film found with as few parts as the brief wants.
pub(crate) fn fewest(
    problem: &DesignProblem,
    pattern: &Pattern,
    candidate: &Candidate,
    watch: &Watch,
) -> Option<FilmOfParts> {
    let Brief { parts, stock, .. } = &problem.brief;
    levels(problem, pattern, candidate, parts.map_or(0, |parts| parts.saturating_sub(stock.len())), watch).pop()
}

/// The best films found with fewer and fewer parts, until at most `free_parts` of them are not in
/// stock.
pub(crate) fn levels(
    problem: &DesignProblem,
    pattern: &Pattern,
    candidate: &Candidate,
    free_parts: usize,
    watch: &Watch,
) -> Vec<FilmOfParts> {
    let assignment = PartAssignment::new(&problem.brief, pattern, candidate);
    // The film whose parts are not counted yet.
    let best = Some(candidate.root_mean_square());
    let unmerged = ProgressUpdate { stage: SearchStage::Parts(0), done: 0, of: 0, best };
    let Some(mut film) = designed(assignment, problem, pattern, MOST_STEPS, &|| watch.show(unmerged)) else {
        return Vec::new();
    };
    let from = film.assignment.free();
    let mut levels = Vec::new();
    loop {
        let left = film.assignment.free();
        let update = film.update(from - left, from.saturating_sub(free_parts));
        if left <= free_parts {
            if let Some(better) = regrouped(problem, &film, watch) {
                film = better;
            }
            levels.push(film);
            return levels;
        }
        levels.push(film.clone());
        if watch.show(update).is_break() {
            return levels;
        }
        let still = || watch.show(update);
        if left > PARTS_SINGLY {
            let aim = (left - left / 4).max(PARTS_SINGLY).max(free_parts);
            let assignment =
                with_nearest_merged(film.assignment.clone(), aim, problem.brief.varies(Variable::Direction));
            match designed(assignment, problem, &film.pattern, MOST_STEPS, &still) {
                Some(next) if next.assignment.free() < left => film = next,
                _ => return levels,
            }
            continue;
        }
        let mut merged = film.assignment.merged(problem.brief.varies(Variable::Direction));
        if left > PARTS_TRIED {
            merged.sort_by(|a, b| a.distance.total_cmp(&b.distance));
            merged.truncate(TRIALS_FINISHED);
        }
        match best_of(problem, &film.pattern, merged.into_iter().map(|m| m.assignment).collect(), &still) {
            Some(next) => film = next,
            None => return levels,
        }
    }
}

/// The assignment with its nearest parts merged, pair after pair, until `aim` parts are left that
/// are not in stock.
fn with_nearest_merged(mut assignment: PartAssignment, aim: usize, turns: bool) -> PartAssignment {
    while assignment.free() > aim {
        match assignment.nearest_merged(turns) {
            Some(merged) => assignment = merged,
            None => break,
        }
    }
    assignment
}

/// Asked in the course of a descent whether to go on.
type StillWanted<'a> = &'a (dyn Fn() -> ControlFlow<()> + Sync);

/// Moves single tiles to other parts as long as that makes the film better.
fn regrouped(problem: &DesignProblem, film: &FilmOfParts, watch: &Watch) -> Option<FilmOfParts> {
    let mut best: Option<FilmOfParts> = None;
    loop {
        let now = best.as_ref().unwrap_or(film);
        if now.assignment.placed.len() > PARTS_TRIED || watch.show(now.update(0, 0)).is_break() {
            return best;
        }
        let exchanged = now.assignment.with_one_exchanged(problem.brief.varies(Variable::Direction));
        let Some(next) = best_of(problem, &now.pattern, exchanged, &|| watch.show(now.update(0, 0))) else {
            return best;
        };
        if next.candidate.merit() >= 0.999 * now.candidate.merit() {
            return best;
        }
        best = Some(next);
    }
}

/// Tries all assignments for a few steps, and finishes the best of them.
fn best_of(
    problem: &DesignProblem,
    pattern: &Pattern,
    assignments: Vec<PartAssignment>,
    still: StillWanted,
) -> Option<FilmOfParts> {
    let mut tried: Vec<FilmOfParts> = assignments
        .into_par_iter()
        .filter_map(|assignment| designed(assignment, problem, pattern, TRIAL_STEPS, still))
        .collect();
    tried.sort_by(|a, b| a.candidate.merit().total_cmp(&b.candidate.merit()));
    tried.truncate(TRIALS_FINISHED);
    let finished: Vec<FilmOfParts> = tried
        .into_par_iter()
        .filter_map(|film| {
            let start = film.candidate.variables;
            let candidate = problem.least_squares.descend(&film.pattern, start, MOST_STEPS, &mut |_| still())?;
            let assignment = film.assignment.updated(&film.pattern, &candidate);
            Some(FilmOfParts { assignment, pattern: film.pattern, candidate })
        })
        .collect();
    finished.into_iter().min_by(|a, b| a.candidate.merit().total_cmp(&b.candidate.merit()))
}

/// The film of an assignment, with the sizes of parts and the positions of tiles free, after at
/// most `steps` steps.
fn designed(
    assignment: PartAssignment,
    problem: &DesignProblem,
    like: &Pattern,
    steps: usize,
    still: StillWanted,
) -> Option<FilmOfParts> {
    let pattern = assignment.pattern(&problem.brief, like);
    let start = problem.least_squares.nearest(&pattern, &pattern.start).ok()?;
    let candidate = problem.least_squares.descend(&pattern, start, steps, &mut |_| still())?;
    Some(FilmOfParts { assignment: assignment.updated(&pattern, &candidate), pattern, candidate })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::ignore_progress;

    /// Three tiles of different sizes in a row.
    fn layout(design: &str) -> Layout {
        let mut text = format!(
            "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
             [volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 2.0\n\
             [design]\nvary = [\"size\", \"position\", \"direction\"]\nsmallest_cut_mm = 0.5\n{design}\n"
        );
        for (n, (width, depth)) in [(2.0, 3.0), (2.1, 3.4), (2.0, 4.0)].into_iter().enumerate() {
            let (x, j_t) = (4.0 * n as f64 - 4.0, if n % 2 == 0 { 0.1 } else { -0.1 });
            text += &format!(
                "[[tile]]\nposition_mm = [{x:?}, 0.1, 0.5]\nsize_mm = [{width:?}, {depth:?}, 1.0]\n\
                 polarization_t = [{j_t:?}, 0.05, 0.0]\n"
            );
        }
        Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"))
    }

    fn start(problem: &DesignProblem) -> Candidate {
        let start = problem.pattern.start.clone();
        problem.least_squares.candidate_at(&problem.pattern, start).expect("a field")
    }

    /// Tiles without polarization are no part.
    #[test]
    fn distinct_parts_are_counted_as_in_the_bill_of_materials() {
        let layout = layout("");
        let mut tiles = layout.bare_tiles();
        assert_eq!(count_distinct(&layout, &tiles), 3);
        tiles[1] = Tile::new(tiles[1].position(), tiles[0].size(), tiles[0].polarization_t()).unwrap();
        assert_eq!(count_distinct(&layout, &tiles), 2);
        tiles[2] = Tile::new(tiles[2].position(), tiles[2].size(), DVec3::ZERO).unwrap();
        assert_eq!(count_distinct(&layout, &tiles), 1);
    }

    /// Each level has a part less than the one before, down to the number that is asked for. Its
    /// film is made of its parts.
    #[test]
    fn levels_have_fewer_and_fewer_parts() {
        let layout = layout("");
        let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
        let counts = |free_parts: usize, watch: &Watch| -> Vec<usize> {
            let levels = levels(&problem, &problem.pattern, &start(&problem), free_parts, watch);
            for film in &levels {
                let tiles = film.pattern.all_tiles(&film.candidate.variables).expect("sides above 0");
                let made = film.assignment.pattern(&problem.brief, &problem.pattern);
                let made = made.all_tiles(&made.start).expect("sides above 0");
                assert!(tiles.iter().zip(&made).all(|(a, b)| {
                    a.size().distance(b.size()) < 1e-12 && a.position().distance(b.position()) < 1e-12
                }));
                let found = problem.least_squares.candidate_at(&film.pattern, film.candidate.variables.clone());
                assert_eq!(found.map(|found| found.merit()), Some(film.candidate.merit()));
            }
            levels.iter().map(FilmOfParts::part_count).collect()
        };
        let watch = Watch::new(&ignore_progress);
        assert_eq!(counts(1, &watch), [3, 2, 1]);
        assert_eq!(counts(2, &watch), [3, 2]);
        assert_eq!(counts(3, &watch).len(), 1);
        let stop = |_: ProgressUpdate| ControlFlow::Break(());
        assert_eq!(counts(1, &Watch::new(&stop)), [3]);
    }

    /// Parts in stock count among the parts that are asked for.
    #[test]
    fn fewest_parts_are_those_of_the_brief() {
        let count = |design: &str| {
            let layout = layout(design);
            let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
            let film = fewest(&problem, &problem.pattern, &start(&problem), &Watch::new(&ignore_progress));
            let film = film.expect("a film");
            (film.part_count(), film.assignment.free())
        };
        assert_eq!(count("parts = 2"), (2, 2));
        let stock = "stock = [{ size_mm = [3.0, 2.1], direction_deg = 60.0 }]";
        assert_eq!(count(&format!("parts = 2\n{stock}")), (2, 1));
    }

    #[test]
    fn nearest_parts_are_merged_down_to_the_aim() {
        let layout = layout("");
        let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
        let all = PartAssignment::new(&problem.brief, &problem.pattern, &start(&problem));
        let free: Vec<usize> = (0..4).map(|aim| with_nearest_merged(all.clone(), aim, true).free()).collect();
        assert_eq!(free, [1, 1, 2, 3]);
    }
}

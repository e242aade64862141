//! The search for a film: several starts, strengths in stock, fewer parts if asked for, rounding.

use std::ops::ControlFlow;
use std::sync::Mutex;

use magsplice_layout::{Brief, Goal, Variable};
use magsplice_magnet::{Overlap, Tile, overlaps};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::error::{DesignError, RoundingFault};
use crate::parts::merging;
use crate::problem::design_problem::DesignProblem;
use crate::problem::least_squares::Candidate;
use crate::problem::pattern::Pattern;
use crate::progress::{ProgressUpdate, SearchProgress, SearchStage, Watch};
use crate::rule::{Demand, Rule};
use crate::search::made_films::MadeFilms;
use crate::search::metrics::Metrics;
use crate::search::rounding;
use crate::search::search_result::{SearchResult, StageMetrics};
use crate::search::shortfall::Shortfall;
use crate::strengths::stock_strengths::fix_to_stock;
use crate::tolerances::{MOST_STEPS, ROUNDS_OF_AMPLITUDE, SPREAD_OF_STARTS};

impl DesignProblem<'_> {
    /// Searches for the film that the brief asks for.
    ///
    /// The film found is a local minimum, the best of the brief's starts. The same layout gives the
    /// same film for any number of threads, unless `progress` stops the search. A demand that the
    /// film misses is no error: [`SearchResult::short_of`] lists it.
    ///
    /// # Errors
    /// If no film keeps the rules, or the film to start from has no field or no decoupling
    /// parameters.
    pub fn search(&self, progress: SearchProgress) -> Result<SearchResult, DesignError> {
        self.metrics(&self.cells(&self.tiles)?)?;
        let mut problem = self.clone();
        problem.hold_recoil(&self.tiles)?;
        let watch = Watch::new(progress);
        let mut found = problem.best_of_starts(&watch)?;
        // Other stages follow where there are few parts, and they keep their own distance.
        if !found.keeps_rules && self.brief.parts.is_none() && self.brief.stock.is_empty() {
            // Rounding moves each of two faces by at most half a step. Where there is no room for
            // it, the last stage names what is broken.
            let mut wider = problem.clone();
            wider.least_squares.bounds.gap.least_mm += self.brief.resolution_mm;
            if let Ok(again) = wider.best_of_starts(&watch) {
                (problem, found) = (wider, again);
            }
        }
        let (problem, found) = problem.with_best_spacing(found, &watch)?;
        problem.finished(found, &watch)
    }

    /// The stages after the starts.
    pub(crate) fn finished(&self, best: BestOfStarts, watch: &Watch) -> Result<SearchResult, DesignError> {
        let BestOfStarts { best, agreeing, .. } = best;
        let mut problem = self.clone();
        let mut stages = vec![problem.stage_metrics(SearchStage::Starts, &self.pattern, &best)?];
        let (mut pattern, mut candidate) = (self.pattern.clone(), best);
        if self.layout.has_recoil() {
            candidate = problem.settle_recoil(&pattern, candidate, watch)?;
            stages.push(problem.stage_metrics(SearchStage::Recoil, &pattern, &candidate)?);
        }
        if !self.brief.stock_strengths_t.is_empty() {
            (pattern, candidate) = fix_to_stock(&problem, pattern, candidate, watch);
            stages.push(self.stage_metrics(SearchStage::Strengths, &pattern, &candidate)?);
            candidate = problem.settle_recoil(&pattern, candidate, watch)?;
        }
        if self.brief.parts.is_some() || !self.brief.stock.is_empty() {
            problem.leave_room_for_rounding();
            let film = merging::fewest(&problem, &pattern, &candidate, watch).ok_or_else(|| {
                DesignError::Contradiction(vec![Rule { tiles: Vec::new(), demand: Demand::FewParts }])
            })?;
            stages.push(self.stage_metrics(SearchStage::Parts(film.part_count()), &film.pattern, &film.candidate)?);
            (pattern, candidate) = (film.pattern, film.candidate);
            candidate = problem.settle_recoil(&pattern, candidate, watch)?;
        }
        problem.rounded(&pattern, candidate, stages, agreeing, watch)
    }

    /// Widens the gap by two steps of the resolution: where tiles share sizes that vary, rounding
    /// may move each of two neighbours nearer by one step.
    pub(crate) fn leave_room_for_rounding(&mut self) {
        if self.least_squares.bounds.rounds_centres {
            return;
        }
        self.least_squares.bounds.gap.least_mm += 2.0 * self.brief.resolution_mm;
    }

    /// The last stage.
    pub(crate) fn rounded(
        self,
        pattern: &Pattern,
        candidate: Candidate,
        mut stages: Vec<StageMetrics>,
        agreeing_starts: usize,
        watch: &Watch,
    ) -> Result<SearchResult, DesignError> {
        let before = self.metrics(&self.cells(&self.tiles)?)?;
        let (layout, least, most) = (self.layout.clone(), self.brief.least_amplitude, self.brief.parts);
        let spacing_mm = self.layout.head_spacing_mm().filter(|_| self.brief.varies(Variable::Head));
        let sampled_by = self.clone();
        let (tiles, [after, finer]) = self.rounded_with_amplitude(pattern, candidate, watch)?;
        stages.push(StageMetrics { stage: SearchStage::Rounding, uniformity_rmse: after.figures.uniformity_rmse });
        let parts = merging::count_distinct(&layout, &tiles);
        let mut short_of = Vec::new();
        let reached = smaller_amplitude(&[after, finer]);
        short_of.extend(least.filter(|least| reached < *least).map(|least| Shortfall::Amplitude { reached, least }));
        short_of.extend(most.filter(|most| parts > *most).map(|most| Shortfall::Parts { reached: parts, most }));
        short_of.extend(sampled_by.useless_axes(&[after, finer]));
        let made = sampled_by.made_films(&tiles, watch).unwrap_or_else(|missed| {
            short_of.push(missed);
            None
        });
        let error = sampled_by.error(&after, made.as_ref());
        let interrupted = watch.is_stopped();
        Ok(SearchResult {
            tiles,
            spacing_mm,
            before,
            after,
            finer,
            made,
            error,
            stages,
            parts,
            agreeing_starts,
            short_of,
            interrupted,
        })
    }

    /// The error that the brief asks to minimize.
    fn error(&self, after: &Metrics, made: Option<&MadeFilms>) -> f64 {
        let weighted = |errors: [f64; 3]| {
            let squares = self.brief.weights.iter().zip(errors).map(|(weight, error)| weight * error * error);
            squares.sum::<f64>().sqrt()
        };
        if let Some(made) = made {
            return weighted(made.after.displacement_rmse_mm.map(|axis| axis.p95.value).to_array());
        }
        match self.brief.goal {
            // An undefined uniformity is no error.
            Goal::Uniformity => weighted(after.figures.uniformity_rmse.map(Option::unwrap_or_default).to_array()),
            Goal::Displacement => weighted(after.figures.displacement_rmse_mm.to_array()),
            Goal::Field => after.scaled_relative_rmse.unwrap_or(f64::INFINITY),
        }
    }

    /// Rounds a film. While its amplitude, over more points than the design grid has, is short of
    /// the bound, the bound is raised and the film designed further.
    fn rounded_with_amplitude(
        mut self,
        pattern: &Pattern,
        mut candidate: Candidate,
        watch: &Watch,
    ) -> Result<(Vec<Tile>, [Metrics; 2]), DesignError> {
        let mut rounds = 0;
        loop {
            let variables = rounding::rounded(&self, pattern, &candidate.variables);
            let name = |index: usize| self.layout.tiles[index].name.clone();
            let tiles = pattern
                .images_of(|variable_tile| rounding::tile(variable_tile, &variables))
                .map_err(|index| self.too_coarse(RoundingFault::NoSide(name(index))))?;
            if let Some(Overlap { first, second, depth, .. }) = overlaps(&tiles).next() {
                let fault = RoundingFault::Overlap { tiles: [first, second].map(name), depth_mm: depth };
                return Err(self.too_coarse(fault));
            }
            let broken = rounding::broken_rules(&self, pattern, &variables);
            if !broken.is_empty() {
                return Err(self.too_coarse(RoundingFault::Rules(self.named(broken))));
            }
            let no_metrics = |error: DesignError| self.too_coarse(RoundingFault::NoMetrics(Box::new(error)));
            let cells = self.cells(&tiles)?;
            let metrics = [self.metrics(&cells).map_err(no_metrics)?, self.finer_metrics(&cells).map_err(no_metrics)?];
            let short = self.brief.least_amplitude.map_or(0.0, |least| least - smaller_amplitude(&metrics));
            let update = ProgressUpdate {
                stage: SearchStage::Rounding,
                done: rounds,
                of: ROUNDS_OF_AMPLITUDE,
                best: Some(candidate.root_mean_square()),
            };
            if short <= 0.0 || rounds == ROUNDS_OF_AMPLITUDE || watch.show(update).is_break() {
                return Ok((tiles, metrics));
            }
            rounds += 1;
            self.least_squares.least_amplitude = self.least_squares.least_amplitude.map(|least| least + 1.1 * short);
            candidate = self
                .least_squares
                .descend(pattern, candidate.variables, MOST_STEPS, &mut |_| watch.show(update))
                .ok_or(DesignError::Singular)?;
        }
    }

    fn too_coarse(&self, fault: RoundingFault) -> DesignError {
        let Brief { resolution_mm, resolution_deg, .. } = self.brief;
        DesignError::Resolution { resolution_mm, resolution_deg, fault }
    }

    /// The best film of several starts, which run in parallel.
    pub(crate) fn best_of_starts(&self, watch: &Watch) -> Result<BestOfStarts, DesignError> {
        let first = self.least_squares.nearest(&self.pattern, &self.pattern.start);
        let first = first.map_err(|rules| self.contradiction(rules))?;
        // Number of finished starts, and the least error so far of a film that keeps every bound.
        let state: Mutex<(usize, Option<f64>)> = Mutex::new((0, None));
        let show = |found: &Candidate| {
            let Ok(mut state) = state.lock() else { return ControlFlow::Break(()) };
            let error = found.root_mean_square();
            if found.lack == 0.0 && state.1.is_none_or(|best| error < best) {
                state.1 = Some(error);
            }
            let (done, best) = *state;
            watch.show(ProgressUpdate { stage: SearchStage::Starts, done, of: self.brief.starts, best })
        };
        let all: Vec<Option<Candidate>> = (0..self.brief.starts)
            .into_par_iter()
            .map(|index| {
                // The first start always runs, so that there is a film.
                if index > 0 && watch.is_stopped() {
                    return None;
                }
                let start = if index == 0 { Some(first.clone()) } else { self.start(&first, index) };
                let candidate = start.and_then(|start| {
                    self.least_squares.descend(&self.pattern, start, MOST_STEPS, &mut |found| show(found))
                });
                if let Ok(mut state) = state.lock() {
                    state.0 += 1;
                }
                candidate
            })
            .collect();
        let merits = || all.iter().flatten().map(Candidate::merit);
        let least = merits().fold(f64::INFINITY, f64::min);
        // Errors within a tenth are squares within a fifth.
        let agreeing = merits().filter(|merit| *merit <= 1.2 * least).count();
        // Rounding to coarse steps may cost more than the starts differ by.
        let rounded: Vec<([f64; 2], Candidate)> = all
            .into_par_iter()
            .flatten()
            .map(|found| {
                let merit = rounding::rounded_merit(self, &self.pattern, &found.variables);
                ([merit.unwrap_or(f64::INFINITY), found.merit()], found)
            })
            .collect();
        let order = |a: &[f64; 2], b: &[f64; 2]| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]));
        let best = rounded.into_iter().min_by(|a, b| order(&a.0, &b.0));
        let ([merit, _], best) = best.ok_or(DesignError::Singular)?;
        Ok(BestOfStarts { best, agreeing, keeps_rules: merit.is_finite() })
    }

    /// A start away from the first one. `None` if no film near it keeps the rules.
    fn start(&self, first: &[f64], index: usize) -> Option<Vec<f64>> {
        let mut random = ChaCha8Rng::seed_from_u64(self.brief.seed);
        random.set_stream(index as u64);
        let away: Vec<f64> = (self.least_squares.steps(&self.pattern).into_iter())
            .map(|step| {
                // A variable without a longest step has no scale, so it stays.
                if step.is_finite() { SPREAD_OF_STARTS * step * random.random_range(-1.0..1.0) } else { 0.0 }
            })
            .collect();
        // Where tiles have changed sides and no film keeps the rules, the distance is halved.
        (0..6).find_map(|halvings| {
            let factor = 0.5_f64.powi(halvings);
            let start: Vec<f64> = first.iter().zip(&away).map(|(value, away)| value + factor * away).collect();
            self.least_squares.nearest(&self.pattern, &start).ok()
        })
    }

    fn metrics(&self, tiles: &[Tile]) -> Result<Metrics, DesignError> {
        Metrics::from_tiles(
            tiles,
            &self.layout.iron,
            self.layout.head(),
            &self.volume.grid,
            self.volume.reference_mm,
            &self.ideal,
        )
    }

    fn finer_metrics(&self, tiles: &[Tile]) -> Result<Metrics, DesignError> {
        Metrics::from_tiles(
            tiles,
            &self.layout.iron,
            self.layout.head(),
            &self.finer_grid(),
            self.volume.reference_mm,
            &self.ideal,
        )
    }

    /// Metrics of a film at the end of a stage.
    pub(crate) fn stage_metrics(
        &self,
        stage: SearchStage,
        pattern: &Pattern,
        candidate: &Candidate,
    ) -> Result<StageMetrics, DesignError> {
        let tiles = pattern.all_tiles(&candidate.variables).ok_or(DesignError::NoField)?;
        let figures = self.metrics(&self.cells(&tiles)?)?.figures;
        Ok(StageMetrics { stage, uniformity_rmse: figures.uniformity_rmse })
    }
}

fn smaller_amplitude(metrics: &[Metrics; 2]) -> f64 {
    metrics[0].figures.amplitude.min(metrics[1].figures.amplitude)
}

/// The best film of several starts.
pub(crate) struct BestOfStarts {
    pub(crate) best: Candidate,
    /// Number of starts whose error is within a tenth of the best.
    pub(crate) agreeing: usize,
    /// Whether the film keeps its rules after rounding.
    pub(crate) keeps_rules: bool,
}

#[cfg(test)]
mod tests {
    use magsplice_decouple::Figures;
    use magsplice_layout::Layout;

    use super::*;

    fn layout(design: &str) -> Layout {
        let text = format!(
            "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
             [volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 2.0\n\
             [design]\nvary = [\"size\", \"position\"]\nsmallest_cut_mm = 1.9\n\
             outline_mm = {{ x = [-4.0, 4.0], y = [-4.0, 4.0] }}\n{design}\n\
             [[tile]]\nposition_mm = [-1.7, 0.3, 0.5]\nsize_mm = [3.0, 2.0, 1.0]\npolarization_t = [-0.1, 0.05, 0.0]\n\
             [[tile]]\nposition_mm = [1.7, 0.1, 0.5]\nsize_mm = [3.1, 2.5, 1.0]\npolarization_t = [0.1, 0.06, 0.0]\n"
        );
        Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"))
    }

    /// The root of the weighted sum of squares, of the figures that the goal names.
    #[test]
    fn error_is_the_weighted_sum_of_squares_of_the_goal() {
        let metrics = Metrics {
            points: 9,
            figures: Figures {
                uniformity_rmse: [Some(0.1), Some(0.2), None].into(),
                displacement_rmse_mm: [3.0, 4.0, 5.0].into(),
                amplitude: 0.5,
            },
            ideal_rmse: [7.0; 3].into(),
            scaled_relative_rmse: Some(0.3),
        };
        let error = |goal: &str, metrics: &Metrics| {
            let layout = layout(&format!("goal = \"{goal}\"\nweights = {{ r_x = 1.0, r_y = 4.0, s_z = 0.5 }}"));
            DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}")).error(metrics, None)
        };
        assert!((error("uniformity", &metrics) - 0.17_f64.sqrt()).abs() < 1e-15);
        assert!((error("displacement", &metrics) - 85.5_f64.sqrt()).abs() < 1e-14);
        assert_eq!(error("field", &metrics), 0.3);
        assert_eq!(error("field", &Metrics { scaled_relative_rmse: None, ..metrics }), f64::INFINITY);
        // The smaller amplitude of the two grids.
        let larger = Metrics { figures: Figures { amplitude: 0.7, ..metrics.figures }, ..metrics };
        assert_eq!([smaller_amplitude(&[metrics, larger]), smaller_amplitude(&[larger, metrics])], [0.5; 2]);
    }

    /// Starts keep the rules, lie within the longest steps of the first one, and depend on the seed
    /// and their number alone.
    #[test]
    fn starts_lie_within_the_longest_steps() {
        let of = |seed: u64| layout(&format!("gap_mm = 0.0\nseed = {seed}"));
        let (one, other) = (of(1), of(2));
        let [one, other] = [&one, &other].map(|layout| DesignProblem::new(layout).unwrap_or_else(|e| panic!("{e}")));
        let first = &one.pattern.start;
        let steps = one.least_squares.steps(&one.pattern);
        let mut furthest = 0.0_f64;
        for index in 1..20 {
            let start = one.start(first, index).expect("a film");
            assert!(one.least_squares.nearest(&one.pattern, &start).is_ok_and(|nearest| nearest == start));
            let parts = start.iter().zip(first).zip(&steps).map(|((to, from), step)| ((to - from) / step).abs());
            furthest = parts.fold(furthest, f64::max);
            assert_eq!(one.start(first, index), Some(start.clone()));
            assert_ne!(one.start(first, index + 1), Some(start.clone()));
            assert_ne!(other.start(first, index), Some(start));
        }
        // Moves that keep the rules may be a little longer than the deviates.
        assert!((0.8..1.5).contains(&furthest), "{furthest}");
    }

    /// The best start, by its merit after rounding, and the number of starts near the best.
    #[test]
    fn best_start_has_the_least_merit() {
        let layout = layout("starts = 5\nresolution_mm = 0.001");
        let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
        let squares = &problem.least_squares;
        let first = squares.nearest(&problem.pattern, &problem.pattern.start).expect("a film");
        let starts = (0..5).map(|index| if index == 0 { Some(first.clone()) } else { problem.start(&first, index) });
        let all: Vec<Candidate> = starts
            .flatten()
            .filter_map(|start| {
                squares.descend(&problem.pattern, start, MOST_STEPS, &mut |_| ControlFlow::Continue(()))
            })
            .collect();
        let merit = |found: &Candidate| {
            rounding::rounded_merit(&problem, &problem.pattern, &found.variables).unwrap_or(f64::INFINITY)
        };
        let least = all.iter().map(Candidate::merit).fold(f64::INFINITY, f64::min);
        let agreeing = all.iter().filter(|found| found.merit() <= 1.2 * least).count();
        let best = all.iter().min_by(|a, b| merit(a).total_cmp(&merit(b))).expect("a film");
        let found =
            problem.best_of_starts(&Watch::new(&|_| ControlFlow::Continue(()))).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!((&found.best, found.agreeing), (best, agreeing));
        assert_eq!(found.keeps_rules, merit(best).is_finite());
    }

    /// Rounding with shared sizes may move each of two neighbours by a step. Centres keep their
    /// distance by themselves.
    #[test]
    fn gaps_widen_by_two_steps_of_the_resolution() {
        let gap = |design: &str| {
            let layout = layout(&format!("gap_mm = 0.1\nresolution_mm = 0.02\n{design}"));
            let mut brief = layout.brief.clone().expect("a design");
            if design.contains("centres") {
                brief.vary = [magsplice_layout::Variable::Position].into();
            }
            let mut problem = DesignProblem::from_brief(&layout, brief).unwrap_or_else(|e| panic!("{e}"));
            problem.leave_room_for_rounding();
            problem.least_squares.bounds.gap.least_mm
        };
        assert!((gap("") - 0.14).abs() < 1e-15);
        assert_eq!(gap("# centres"), 0.1);
    }

    /// A film that keeps its rules after rounding is searched once. A second search would widen the
    /// gap, which binds the best film here.
    #[test]
    fn films_that_keep_their_rules_are_searched_once() {
        let layout = layout("gap_mm = 0.35\nresolution_mm = 0.001\nstarts = 1");
        let problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
        let watch = Watch::new(&|_| ControlFlow::Continue(()));
        let film = |problem: &DesignProblem| {
            let found = problem.best_of_starts(&watch).unwrap_or_else(|e| panic!("{e}"));
            let keeps_rules = found.keeps_rules;
            (keeps_rules, problem.finished(found, &watch).unwrap_or_else(|e| panic!("{e}")).tiles)
        };
        let (keeps_rules, tiles) = film(&problem);
        let found = problem.search(&|_| ControlFlow::Continue(())).unwrap_or_else(|e| panic!("{e}"));
        assert!(keeps_rules && found.tiles == tiles);
        let mut wider = problem.clone();
        wider.least_squares.bounds.gap.least_mm += 0.001;
        assert_ne!(film(&wider).1, tiles);
    }
}

//! The search for a film: several starts, strengths in stock, fewer parts if asked for, rounding.

use std::ops::ControlFlow;
use std::sync::Mutex;

use magsplice_layout::{Brief, Goal};
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
        let (layout, least, most) = (self.layout, self.brief.least_amplitude, self.brief.parts);
        let sampled_by = self.clone();
        let (tiles, [after, finer]) = self.rounded_with_amplitude(pattern, candidate, watch)?;
        stages.push(StageMetrics { stage: SearchStage::Rounding, uniformity_rmse: after.figures.uniformity_rmse });
        let parts = merging::count_distinct(layout, &tiles);
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
        Metrics::from_tiles(tiles, &self.volume.grid, self.volume.reference_mm, &self.ideal)
    }

    fn finer_metrics(&self, tiles: &[Tile]) -> Result<Metrics, DesignError> {
        Metrics::from_tiles(tiles, &self.finer_grid(), self.volume.reference_mm, &self.ideal)
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

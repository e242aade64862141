//! The search for a film: several starts, fewer parts if asked for, rounding.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use magsplice_decouple::PerParameter;
use magsplice_field::Tile;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::descent::Found;
use crate::error::DesignError;
use crate::figures::Figures;
use crate::parts;
use crate::pattern::Pattern;
use crate::rounding;
use crate::setting::Setting;
use crate::strengths;
use crate::tolerances::{MOST_STEPS, ROUNDS_OF_AMPLITUDE, SPREAD_OF_STARTS};

/// How far a search is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// What it is at.
    pub stage: Stage,
    /// How many parts of this stage are done, of how many.
    pub done: usize,
    /// Of how many.
    pub of: usize,
    /// Root of the mean squared error of the best film so far, all weighted errors together; `None` before there is one.
    pub best: Option<f64>,
}

/// What a search is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Descents from several starts.
    Starts,
    /// Strengths that are at hand.
    Strengths,
    /// Fewer distinct parts: so many are left.
    Parts(usize),
    /// Rounding, and what it cost made good.
    Rounding,
}

/// A film that was found.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Its tiles, in the order of the layout.
    pub tiles: Vec<Tile>,
    /// The layout's film.
    pub before: Figures,
    /// The film found, over the layout's working volume.
    pub after: Figures,
    /// The film found, over the grid it was designed on but five times finer.
    pub finer: Figures,
    /// Uniformity RMSE over the working volume after each stage, in the order they were gone through.
    pub stages: Vec<(Stage, PerParameter)>,
    /// How many distinct parts it has, directions included.
    pub parts: usize,
    /// Of how many starts the best came within a tenth of the best error.
    pub agreeing_starts: usize,
    /// What was asked for and not reached.
    pub short_of: Vec<String>,
    /// Whether the search was broken off.
    pub interrupted: bool,
}

/// Is told how far a search is, and may break it off; the best film so far is kept then.
pub type Watch<'a> = &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync);

impl Setting<'_> {
    /// Searches for the film that is wanted.
    ///
    /// The same layout gives the same film for any number of threads, unless the search is broken off.
    ///
    /// # Errors
    /// If no film keeps the rules, or the film to start from has no field or no parameters.
    pub fn search(&self, watch: Watch) -> Result<Outcome, DesignError> {
        self.figures(&self.tiles)?;
        let best = self.best_of_starts(watch)?;
        self.finished(best, watch)
    }

    /// The stages after the starts.
    pub(crate) fn finished(&self, best: BestOfStarts, watch: Watch) -> Result<Outcome, DesignError> {
        let BestOfStarts { best, agreeing, interrupted } = best;
        let stop = AtomicBool::new(interrupted);
        let watch = |progress: Progress| {
            if stop.load(Ordering::Relaxed) || watch(progress).is_break() {
                stop.store(true, Ordering::Relaxed);
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        };
        let mut stages = vec![(Stage::Starts, self.uniformity(&self.pattern, &best)?)];
        let (mut pattern, mut found) = (self.pattern.clone(), best);
        if !self.brief.stock_strengths_t.is_empty() {
            (pattern, found) = strengths::from_stock(self, pattern, found, &watch);
            stages.push((Stage::Strengths, self.uniformity(&pattern, &found)?));
        }
        let mut setting = self.clone();
        if self.brief.parts.is_some() || !self.brief.stock.is_empty() {
            setting.leave_room_for_rounding();
            let parted = parts::fewer(&setting, &pattern, &found, &watch).ok_or_else(DesignError::no_parts)?;
            stages.push((Stage::Parts(parted.count()), self.uniformity(&parted.pattern, &parted.found)?));
            (pattern, found) = (parted.pattern, parted.found);
        }
        setting.rounded(&pattern, found, stages, agreeing, &watch, &stop)
    }

    /// Where sizes are shared, rounding lets two tiles each come nearer by one step.
    pub(crate) fn leave_room_for_rounding(&mut self) {
        self.problem.bounds.gap_mm += 2.0 * self.brief.resolution_mm;
    }

    /// The last stage.
    pub(crate) fn rounded(
        self,
        pattern: &Pattern,
        found: Found,
        mut stages: Vec<(Stage, PerParameter)>,
        agreeing_starts: usize,
        watch: Watch,
        stop: &AtomicBool,
    ) -> Result<Outcome, DesignError> {
        let before = self.figures(&self.tiles)?;
        let (layout, least, wanted) = (self.layout, self.brief.least_amplitude, self.brief.parts);
        let (tiles, [after, finer]) = self.rounded_with_amplitude(pattern, found, watch)?;
        stages.push((Stage::Rounding, after.uniformity_rmse));
        let parts = parts::distinct(layout, &tiles);
        let mut short_of = Vec::new();
        let amplitude = least_amplitude(&[after, finer]);
        if let Some(least) = least.filter(|least| amplitude < *least) {
            short_of.push(format!("amplitude {amplitude:.4}, must be at least {least}"));
        }
        if let Some(wanted) = wanted.filter(|wanted| parts > *wanted) {
            short_of.push(format!("{parts} distinct parts, must be at most {wanted}"));
        }
        let interrupted = stop.load(Ordering::Relaxed);
        Ok(Outcome { tiles, before, after, finer, stages, parts, short_of, agreeing_starts, interrupted })
    }

    /// Rounds a film; where the amplitude over more points than the film was designed on is short, goes on for more of it.
    fn rounded_with_amplitude(
        mut self,
        pattern: &Pattern,
        mut found: Found,
        watch: Watch,
    ) -> Result<(Vec<Tile>, [Figures; 2]), DesignError> {
        let mut rounds = 0;
        loop {
            let at = rounding::rounded(&self, pattern, &found.at);
            let tiles = rounding::tiles(pattern, &at).ok_or(DesignError::NoField)?;
            let figures = [self.figures(&tiles)?, self.finer_figures(&tiles)?];
            let short = self.brief.least_amplitude.map_or(0.0, |least| least - least_amplitude(&figures));
            let more = Progress {
                stage: Stage::Rounding,
                done: rounds,
                of: ROUNDS_OF_AMPLITUDE,
                best: Some(self.root_mean_square(&found)),
            };
            if short <= 0.0 || rounds == ROUNDS_OF_AMPLITUDE || watch(more).is_break() {
                return Ok((tiles, figures));
            }
            rounds += 1;
            self.problem.least_amplitude = self.problem.least_amplitude.map(|least| least + 1.1 * short);
            let go_on = &mut |_: &Found| ControlFlow::Continue(());
            found = self.problem.descend(pattern, found.at, MOST_STEPS, go_on).ok_or(DesignError::Singular)?;
        }
    }

    /// The best of several starts.
    pub(crate) fn best_of_starts(&self, watch: Watch) -> Result<BestOfStarts, DesignError> {
        let first = self.problem.nearest(&self.pattern, &self.pattern.start);
        let first = first.map_err(|rules| DesignError::Contradiction(self.told(&rules)))?;
        let shared = Shared::new(watch, Stage::Starts, self.brief.starts);
        let all: Vec<Option<Found>> = (0..self.brief.starts)
            .into_par_iter()
            .map(|index| {
                // The first is always tried: there is to be a film.
                if index > 0 && shared.stopped() {
                    return None;
                }
                let start = if index == 0 { Some(first.clone()) } else { self.start(&first, index) };
                let found = start.and_then(|at| {
                    let mut tell = |found: &Found| shared.tell(self.root_mean_square(found), found.lack == 0.0);
                    self.problem.descend(&self.pattern, at, MOST_STEPS, &mut tell)
                });
                shared.one_done();
                found
            })
            .collect();
        let merits = || all.iter().flatten().map(Found::merit);
        let least = merits().fold(f64::INFINITY, f64::min);
        // Errors within a tenth: squares within a fifth.
        let agreeing = merits().filter(|merit| *merit <= 1.2 * least).count();
        let best = all.into_iter().flatten().min_by(|a, b| a.merit().total_cmp(&b.merit()));
        Ok(BestOfStarts { best: best.ok_or(DesignError::Singular)?, agreeing, interrupted: shared.stopped() })
    }

    /// A start away from the first one; `None` if none near there keeps the rules.
    fn start(&self, first: &[f64], index: usize) -> Option<Vec<f64>> {
        let mut random = ChaCha8Rng::seed_from_u64(self.brief.seed);
        random.set_stream(index as u64);
        let away: Vec<f64> = (self.problem.steps(&self.pattern).into_iter())
            .map(|step| {
                // A step without bound belongs to a number that has none; it stays.
                if step.is_finite() { SPREAD_OF_STARTS * step * random.random_range(-1.0..1.0) } else { 0.0 }
            })
            .collect();
        // Tiles thrown across each other leave no room: half as far, then.
        (0..6).find_map(|halvings| {
            let factor = 0.5_f64.powi(halvings);
            let at: Vec<f64> = first.iter().zip(&away).map(|(value, away)| value + factor * away).collect();
            self.problem.nearest(&self.pattern, &at).ok()
        })
    }

    pub(crate) fn root_mean_square(&self, found: &Found) -> f64 {
        (2.0 * found.loss).sqrt()
    }

    pub(crate) fn figures(&self, tiles: &[Tile]) -> Result<Figures, DesignError> {
        Figures::of(tiles, &self.volume.grid, self.volume.reference_mm, &self.ideal)
    }

    fn finer_figures(&self, tiles: &[Tile]) -> Result<Figures, DesignError> {
        Figures::of(tiles, &self.finer_grid(), self.volume.reference_mm, &self.ideal)
    }

    pub(crate) fn uniformity(&self, pattern: &Pattern, found: &Found) -> Result<PerParameter, DesignError> {
        let tiles = pattern.all_tiles(&found.at).ok_or(DesignError::NoField)?;
        Ok(self.figures(&tiles)?.uniformity_rmse)
    }
}

fn least_amplitude(figures: &[Figures; 2]) -> f64 {
    figures[0].amplitude.min(figures[1].amplitude)
}

/// The best film of several starts.
pub(crate) struct BestOfStarts {
    pub(crate) best: Found,
    /// How many starts came near it.
    pub(crate) agreeing: usize,
    pub(crate) interrupted: bool,
}

/// What descents that run at the same time tell together.
pub(crate) struct Shared<'a> {
    watch: Watch<'a>,
    stage: Stage,
    of: usize,
    state: std::sync::Mutex<(usize, Option<f64>)>,
    stop: AtomicBool,
}

impl<'a> Shared<'a> {
    pub(crate) fn new(watch: Watch<'a>, stage: Stage, of: usize) -> Shared<'a> {
        Shared { watch, stage, of, state: std::sync::Mutex::new((0, None)), stop: AtomicBool::new(false) }
    }

    /// A film with this error was found; it counts if it keeps every bound.
    pub(crate) fn tell(&self, error: f64, counts: bool) -> ControlFlow<()> {
        if self.stopped() {
            return ControlFlow::Break(());
        }
        let Ok(mut state) = self.state.lock() else { return ControlFlow::Break(()) };
        if counts && state.1.is_none_or(|best| error < best) {
            state.1 = Some(error);
        }
        let progress = Progress { stage: self.stage, done: state.0, of: self.of, best: state.1 };
        if (self.watch)(progress).is_break() {
            self.stop.store(true, Ordering::Relaxed);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }

    pub(crate) fn one_done(&self) {
        if let Ok(mut state) = self.state.lock() {
            state.0 += 1;
        }
    }

    pub(crate) fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

//! The spacing of the head that goes with a film.

use std::borrow::Cow;

use magsplice_layout::{MinMax, Variable};

use crate::error::DesignError;
use crate::problem::design_problem::DesignProblem;
use crate::problem::least_squares::Candidate;
use crate::progress::{ProgressUpdate, SearchStage, Watch};
use crate::search::rounding;
use crate::search::stages::BestOfStarts;
use crate::tolerances::{FIRST_SPACINGS, FURTHER_SPACINGS, MOST_STEPS};

/// The golden ratio.
const GOLDEN: f64 = 1.618_033_988_749_895;

/// A film and the problem of the spacing that it was found for.
struct Spaced<'a> {
    problem: DesignProblem<'a>,
    film: Candidate,
}

impl<'a> DesignProblem<'a> {
    /// The problem with the spacing of the head at which the film has the least error, and the film
    /// for it. Both as they are where the brief does not let the head vary.
    ///
    /// The spacings lie evenly between their bounds first, then in golden sections about the best.
    /// At each of them the search descends from the best film so far.
    pub(crate) fn with_best_spacing(
        self,
        found: BestOfStarts,
        watch: &Watch,
    ) -> Result<(DesignProblem<'a>, BestOfStarts), DesignError> {
        let (Some(MinMax { min, max }), Some(stated_mm)) = (self.brief.spacing_mm, self.layout.head_spacing_mm())
        else {
            return Ok((self, found));
        };
        if !self.brief.varies(Variable::Head) {
            return Ok((self, found));
        }
        let is_allowed = (min..=max).contains(&stated_mm);
        let agreeing = found.agreeing;
        let mut best = Spaced { problem: self, film: found.best };
        let mut least = if is_allowed { best.film.merit() } else { f64::INFINITY };
        let mut done = 0;
        let mut merit_at = |asked_mm: f64| {
            let of = FIRST_SPACINGS + FURTHER_SPACINGS;
            let update =
                ProgressUpdate { stage: SearchStage::Head, done, of, best: Some(best.film.root_mean_square()) };
            done += 1;
            // Without a film for any spacing within the bounds there is no result yet.
            if watch.show(update).is_break() && least.is_finite() {
                return f64::INFINITY;
            }
            let Some(spaced) = best.at(asked_mm, (min, max), update, watch) else { return f64::INFINITY };
            let merit = spaced.film.merit();
            if merit < least {
                (best, least) = (spaced, merit);
            }
            merit
        };
        let step_mm = (max - min) / (FIRST_SPACINGS - 1) as f64;
        let first: Vec<f64> = (0..FIRST_SPACINGS).map(|n| min + step_mm * n as f64).collect();
        let merits: Vec<f64> = first.iter().map(|spacing_mm| merit_at(*spacing_mm)).collect();
        let nearest = (0..FIRST_SPACINGS).min_by(|a, b| merits[*a].total_cmp(&merits[*b])).expect("spacings");
        let (mut low, mut high) = (first[nearest.saturating_sub(1)], first[(nearest + 1).min(FIRST_SPACINGS - 1)]);
        let section = |from: f64, to: f64| to - (to - from) / GOLDEN;
        let mut inner = [section(low, high), section(high, low)];
        let mut values = inner.map(&mut merit_at);
        for _ in 2..FURTHER_SPACINGS {
            if values[0] < values[1] {
                (high, inner[1], values[1]) = (inner[1], inner[0], values[0]);
                inner[0] = section(low, high);
                values[0] = merit_at(inner[0]);
            } else {
                (low, inner[0], values[0]) = (inner[0], inner[1], values[1]);
                inner[1] = section(high, low);
                values[1] = merit_at(inner[1]);
            }
        }
        if !least.is_finite() {
            return Err(DesignError::NoSpacingBetween { min_mm: min, max_mm: max });
        }
        let Spaced { problem, film } = best;
        let merit = rounding::rounded_merit(&problem, &problem.pattern, &film.variables);
        let keeps_rules = merit.is_some_and(f64::is_finite);
        Ok((problem, BestOfStarts { best: film, agreeing, keeps_rules }))
    }
}

impl<'a> Spaced<'a> {
    /// The film for another spacing, rounded to the resolution of the brief within the bounds.
    /// `None` if no weights keep the form of the ideal film there, or the film has no such field.
    fn at(&self, asked_mm: f64, (min, max): (f64, f64), update: ProgressUpdate, watch: &Watch) -> Option<Spaced<'a>> {
        let (problem, resolution_mm) = (&self.problem, self.problem.brief.resolution_mm);
        let rounded_mm = magsplice_layout::ten_decimals((asked_mm / resolution_mm).round() * resolution_mm);
        let spacing_mm = if (min..=max).contains(&rounded_mm) { rounded_mm } else { asked_mm };
        let layout = problem.layout.with_head_spacing(spacing_mm)?;
        let mut spaced = DesignProblem::of(Cow::Owned(layout), problem.brief.clone()).ok()?;
        spaced.least_squares.bounds = problem.least_squares.bounds.clone();
        spaced.hold_recoil(&problem.pattern.all_tiles(&self.film.variables)?).ok()?;
        let film =
            spaced
                .least_squares
                .descend(&spaced.pattern, self.film.variables.clone(), MOST_STEPS, &mut |_| watch.show(update))?;
        Some(Spaced { problem: spaced, film })
    }
}

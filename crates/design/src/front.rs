//! What a better film costs: error against amplitude, and against the number of distinct parts.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use magsplice_layout::{Brief, Goal};

use crate::descent::Found;
use crate::error::DesignError;
use crate::parts;
use crate::search::{Outcome, Progress, Stage, Watch};
use crate::setting::Setting;
use crate::tolerances::MOST_STEPS;

/// The best films found for one wish after another.
#[derive(Clone, Debug)]
pub struct Front {
    /// For each least amplitude, from small to large, the film found; without a bound on parts.
    pub by_amplitude: Vec<(f64, Outcome)>,
    /// The films found with fewer and fewer distinct parts, at the least amplitude of the layout.
    pub by_parts: Vec<Outcome>,
}

/// Starts for each amplitude: the film found for the one before, and these.
const STARTS: usize = 3;

impl Setting<'_> {
    /// The front of this setting for these least amplitudes. A film for one amplitude also serves for every smaller one, so errors grow along the front as far as
    /// the search succeeded.
    ///
    /// # Errors
    /// As [`Setting::search`].
    pub fn front(&self, amplitudes: &[f64], watch: Watch) -> Result<Front, DesignError> {
        let stop = AtomicBool::new(false);
        let watch = |progress: Progress| {
            if stop.load(Ordering::Relaxed) || watch(progress).is_break() {
                stop.store(true, Ordering::Relaxed);
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        };
        let mut by_amplitude: Vec<(f64, Outcome)> = Vec::new();
        // From the largest down: what serves for more amplitude is a good start for less.
        let mut descending = amplitudes.to_vec();
        descending.sort_by(|a, b| b.total_cmp(a));
        let mut before: Option<Found> = None;
        for &amplitude in &descending {
            let (parts, stock) = (None, Vec::new());
            let brief = Brief { least_amplitude: Some(amplitude), parts, stock, starts: STARTS, ..self.brief.clone() };
            let setting = Setting::with_brief(self.layout, brief)?;
            let mut starts = setting.best_of_starts(&watch)?;
            // With the field itself as the goal the films are for one amplitude each.
            if let Some(before) = before.filter(|_| self.brief.goal != Goal::Field) {
                let at = setting.problem.nearest(&setting.pattern, &before.at).unwrap_or(before.at);
                let go_on = &mut |_: &Found| ControlFlow::Continue(());
                let again = setting.problem.descend(&setting.pattern, at, MOST_STEPS, go_on);
                if let Some(again) = again.filter(|again| again.merit() < starts.best.merit()) {
                    starts.best = again;
                }
            }
            before = Some(starts.best.clone());
            by_amplitude.insert(0, (amplitude, setting.finished(starts, &watch)?));
            if stop.load(Ordering::Relaxed) {
                break;
            }
        }
        Ok(Front { by_amplitude, by_parts: self.front_of_parts(&watch, &stop)? })
    }

    fn front_of_parts(&self, watch: Watch, stop: &AtomicBool) -> Result<Vec<Outcome>, DesignError> {
        let vary = self.brief.vary;
        if !(vary.size && vary.position) || vary.tilt || stop.load(Ordering::Relaxed) {
            return Ok(Vec::new());
        }
        let mut setting = self.clone();
        let best = setting.best_of_starts(watch)?.best;
        setting.leave_room_for_rounding();
        // Down to what is at hand, or to a single part.
        let least = usize::from(self.brief.stock.is_empty());
        let levels = parts::levels(&setting, &setting.pattern, &best, least, watch);
        let outcome = |level: parts::Parted| {
            let stages = vec![(Stage::Parts(level.count()), self.uniformity(&level.pattern, &level.found)?)];
            let brief = Brief { parts: None, ..setting.brief.clone() };
            let rounding = Setting { brief, ..setting.clone() };
            rounding.rounded(&level.pattern, level.found, stages, 1, watch, stop)
        };
        levels.into_iter().map(outcome).collect()
    }
}

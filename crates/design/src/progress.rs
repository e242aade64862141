//! Progress of a search, and the way to stop it.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// How far a search is, in one of its stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProgressUpdate {
    /// The stage that is running.
    pub stage: SearchStage,
    /// Number of finished items of this stage, such as starts.
    pub done: usize,
    /// Number of items of this stage. It is 0 where they cannot be counted.
    pub of: usize,
    /// Root mean square of the weighted residuals of the best film so far. `None` before the first
    /// film. Relative to the ideal field for `goal = "field"`, in radians for uniformity, in
    /// millimetres for displacement.
    pub best: Option<f64>,
}

/// A stage of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SearchStage {
    /// Descents from several starts.
    Starts,
    /// Descents with what recoil adds to the field of the film found.
    Recoil,
    /// Strengths are replaced by strengths in stock.
    Strengths,
    /// Distinct parts are merged; the value is the number of distinct parts of the film.
    Parts(usize),
    /// Numbers are rounded to the resolution, and the amplitude that rounding costs is regained.
    Rounding,
    /// Films with the errors of `[tolerance]` are evaluated.
    Samples,
}

impl SearchStage {
    /// Result of the stage in a few words, such as "fewer parts".
    pub const fn name(self) -> &'static str {
        match self {
            SearchStage::Starts => "searched",
            SearchStage::Recoil => "with recoil",
            SearchStage::Strengths => "strengths of the stock",
            SearchStage::Parts(_) => "fewer parts",
            SearchStage::Rounding => "rounded",
            SearchStage::Samples => "sampled",
        }
    }
}

/// A stage is serialized as its name.
#[cfg(feature = "serde")]
impl serde::Serialize for SearchStage {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// A callback that observes a search. If it returns [`ControlFlow::Break`], the search stops and
/// keeps the best film so far. Several threads call it.
pub type Progress<'a> = &'a (dyn Fn(ProgressUpdate) -> ControlFlow<()> + Sync);

/// Ignores every update and never stops the search.
pub fn ignore_progress(_: ProgressUpdate) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// The same callback, which keeps returning `Break` once it has returned it. `stop` remembers that.
pub(crate) fn latched<'a>(
    progress: Progress<'a>,
    stop: &'a AtomicBool,
) -> impl Fn(ProgressUpdate) -> ControlFlow<()> + Sync + 'a {
    move |update| {
        if stop.load(Ordering::Relaxed) || progress(update).is_break() {
            stop.store(true, Ordering::Relaxed);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }
}

/// Combined progress of descents that run in parallel.
pub(crate) struct SharedProgress<'a> {
    progress: Progress<'a>,
    stage: SearchStage,
    of: usize,
    /// Number of finished descents, and the least error so far.
    state: Mutex<(usize, Option<f64>)>,
    stop: AtomicBool,
}

impl<'a> SharedProgress<'a> {
    pub(crate) fn new(progress: Progress<'a>, stage: SearchStage, of: usize) -> SharedProgress<'a> {
        SharedProgress { progress, stage, of, state: Mutex::new((0, None)), stop: AtomicBool::new(false) }
    }

    /// Reports a film with this error. `counts` says whether the film keeps every bound, so that it
    /// may be the best.
    pub(crate) fn report(&self, error: f64, counts: bool) -> ControlFlow<()> {
        if self.is_stopped() {
            return ControlFlow::Break(());
        }
        let Ok(mut state) = self.state.lock() else { return ControlFlow::Break(()) };
        if counts && state.1.is_none_or(|best| error < best) {
            state.1 = Some(error);
        }
        let update = ProgressUpdate { stage: self.stage, done: state.0, of: self.of, best: state.1 };
        if (self.progress)(update).is_break() {
            self.stop.store(true, Ordering::Relaxed);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }

    /// Counts one descent as finished.
    pub(crate) fn finish_one(&self) {
        if let Ok(mut state) = self.state.lock() {
            state.0 += 1;
        }
    }

    pub(crate) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

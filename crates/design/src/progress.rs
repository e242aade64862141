//! Progress of a search, and the way to stop it.

use std::ops::ControlFlow;
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
    /// Descents with other spacings of the head.
    Head,
    /// Descents with the field that recoil adds to the film found.
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
            SearchStage::Head => "with the best spacing",
            SearchStage::Recoil => "with recoil",
            SearchStage::Strengths => "strengths of the stock",
            SearchStage::Parts(_) => "fewer parts",
            SearchStage::Rounding => "rounded",
            SearchStage::Samples => "sampled",
        }
    }
}

/// A stage is serialized as its name.
impl serde::Serialize for SearchStage {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// A callback that observes a search. If it returns [`ControlFlow::Break`], the search stops and
/// keeps the best film so far. Several threads call it.
pub type SearchProgress<'a> = &'a (dyn Fn(ProgressUpdate) -> ControlFlow<()> + Sync);

/// Ignores every update and never stops the search.
pub fn ignore_progress(_: ProgressUpdate) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// The callback of a search, which is not called again once it has stopped the search.
pub(crate) struct Watch<'a> {
    progress: SearchProgress<'a>,
    stop: AtomicBool,
}

impl<'a> Watch<'a> {
    pub(crate) fn new(progress: SearchProgress<'a>) -> Watch<'a> {
        Watch { progress, stop: AtomicBool::new(false) }
    }

    pub(crate) fn show(&self, update: ProgressUpdate) -> ControlFlow<()> {
        if self.is_stopped() {
            return ControlFlow::Break(());
        }
        let flow = (self.progress)(update);
        self.stop.fetch_or(flow.is_break(), Ordering::Relaxed);
        flow
    }

    pub(crate) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

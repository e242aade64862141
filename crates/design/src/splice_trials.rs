//! Which number of a request stands in the way of a film: searches with one number changed.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use magsplice_decouple::PerAxis;

use crate::problem::design_problem::DesignProblem;
use crate::progress::{ProgressUpdate, SearchProgress};
use crate::splice::{SMALLEST_CUT, SpliceRequest, four_digits};

/// Least number of starts of a trial with more starts, and factor to the number of the request.
/// Where one of 8 starts in 16 finds a film, 32 find it in 19 of 20 searches.
const TRIED_STARTS: usize = 32;
const MORE_STARTS: usize = 4;

/// Largest number of starts.
const MOST_STARTS: usize = 10_000;

/// A change of one number of a [`SpliceRequest`] that gives the search more freedom. Lengths in
/// millimetres.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum SpliceChange {
    /// Number of starts.
    Starts(usize),
    /// Shortest side of a tile.
    SmallestCutMm(f64),
    /// Extent of the film along x and y.
    FilmMm([f64; 2]),
    /// Extent of the working volume along x and y.
    RangeMm([f64; 2]),
    /// Least and largest distance of the sensor.
    DistanceMm([f64; 2]),
    /// Least amplitude.
    LeastAmplitude(f64),
    /// Any number of distinct parts.
    AnyParts,
}

impl SpliceChange {
    /// Why the film of a request fails, if this change is enough.
    pub const fn limit(self) -> &'static str {
        match self {
            SpliceChange::Starts(_) => "the search has not converged",
            SpliceChange::SmallestCutMm(_) => "the smallest cut is too long",
            SpliceChange::FilmMm(_) => "the film is too small for the wavelength and the range",
            SpliceChange::RangeMm(_) => "the range is too large for the film",
            SpliceChange::DistanceMm(_) => "the sensor moves too far from the film",
            SpliceChange::LeastAmplitude(_) => "the amplitude is too large",
            SpliceChange::AnyParts => "the parts are too few",
        }
    }
}

/// The film of a request with one number changed.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct SpliceTrial {
    /// What was changed.
    pub change: SpliceChange,
    /// RMSE of the displacement of the film found, over the working volume.
    pub displacement_rmse_mm: PerAxis,
    /// Whether the film meets every requirement.
    pub is_enough: bool,
}

impl SpliceRequest {
    /// Searches for the film with one number changed at a time, to find which number stands in the
    /// way of a film that meets its requirements. Each trial is the search of the changed request.
    ///
    /// The first trial has more starts. If it is enough, no number stands in the way, and there are
    /// no other trials. Changes without a film are left out. If `progress` stops a search, the
    /// trials end.
    pub fn trials(&self, progress: SearchProgress) -> Vec<SpliceTrial> {
        let stopped = AtomicBool::new(false);
        let watched = |update: ProgressUpdate| {
            let flow = progress(update);
            stopped.fetch_or(flow.is_break(), Ordering::Relaxed);
            flow
        };
        let mut trials = Vec::new();
        for change in self.changes() {
            trials.extend(self.trial(change, &watched).filter(|_| !stopped.load(Ordering::Relaxed)));
            let has_converged =
                |trial: &SpliceTrial| trial.is_enough && matches!(trial.change, SpliceChange::Starts(_));
            if stopped.load(Ordering::Relaxed) || trials.last().is_some_and(has_converged) {
                break;
            }
        }
        trials
    }

    fn trial(
        &self,
        change: SpliceChange,
        progress: &(dyn Fn(ProgressUpdate) -> ControlFlow<()> + Sync),
    ) -> Option<SpliceTrial> {
        let layout = self.changed(change).layout().ok()?;
        let found = DesignProblem::new(&layout).ok()?.search(progress).ok()?;
        let displacement_rmse_mm = found.after.figures.displacement_rmse_mm;
        Some(SpliceTrial { change, displacement_rmse_mm, is_enough: found.short_of.is_empty() })
    }

    /// The changes that are tried, the ones that cost the user least first.
    fn changes(&self) -> Vec<SpliceChange> {
        let wave = self.wavelength_mm;
        let usual_cut = four_digits(SMALLEST_CUT * wave);
        let cut_mm = if self.smallest_cut_mm > usual_cut { usual_cut } else { four_digits(0.5 * self.smallest_cut_mm) };
        let [near, far] = self.distance_mm;
        let starts = TRIED_STARTS.max(MORE_STARTS.saturating_mul(self.brief.starts)).min(MOST_STARTS);
        let more_starts = (starts > self.brief.starts).then_some(SpliceChange::Starts(starts));
        let any_parts = self.brief.parts.map(|_| SpliceChange::AnyParts);
        let amplitude = self.brief.least_amplitude.map(|least| SpliceChange::LeastAmplitude(four_digits(0.5 * least)));
        let others = [
            SpliceChange::SmallestCutMm(cut_mm),
            SpliceChange::FilmMm(self.film_mm.map(|extent| four_digits(extent + 0.5 * wave))),
            SpliceChange::RangeMm(self.range_mm.map(|extent| four_digits(0.5 * extent))),
            SpliceChange::DistanceMm([near, four_digits(0.5 * (near + far))]),
        ];
        more_starts.into_iter().chain(any_parts).chain(others).chain(amplitude).collect()
    }

    /// The request with one number changed.
    pub fn changed(&self, change: SpliceChange) -> SpliceRequest {
        let mut request = self.clone();
        match change {
            SpliceChange::Starts(starts) => request.brief.starts = starts,
            SpliceChange::SmallestCutMm(cut_mm) => request.smallest_cut_mm = cut_mm,
            SpliceChange::FilmMm(film_mm) => request.film_mm = film_mm,
            SpliceChange::RangeMm(range_mm) => request.range_mm = range_mm,
            SpliceChange::DistanceMm(distance_mm) => request.distance_mm = distance_mm,
            SpliceChange::LeastAmplitude(least) => request.brief.least_amplitude = Some(least),
            SpliceChange::AnyParts => request.brief.parts = None,
        }
        request
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each change gives the search more freedom: by hand, for a wavelength of 10 mm.
    #[test]
    fn changes_loosen_one_number_each() {
        let default = SpliceRequest::new(10.0, [20.0, 24.0]);
        let mut request =
            SpliceRequest { smallest_cut_mm: 1.0, range_mm: [4.0, 3.0], distance_mm: [3.0, 5.5], ..default };
        request.brief.starts = 8;
        let of = |request: &SpliceRequest| request.changes();
        let others = [
            SpliceChange::FilmMm([25.0, 29.0]),
            SpliceChange::RangeMm([2.0, 1.5]),
            SpliceChange::DistanceMm([3.0, 4.25]),
            SpliceChange::LeastAmplitude(0.325),
        ];
        let known = [&[SpliceChange::Starts(32), SpliceChange::SmallestCutMm(0.8)][..], &others].concat();
        assert_eq!(of(&request), known);
        // A cut that is not longer than the usual one is halved. Starts grow by four, to a limit.
        request.smallest_cut_mm = 0.8;
        request.brief.starts = 17;
        request.brief.parts = Some(4);
        let first = [SpliceChange::Starts(68), SpliceChange::AnyParts, SpliceChange::SmallestCutMm(0.4)];
        assert_eq!(of(&request), [&first[..], &others].concat());
        request.brief.starts = 9_999;
        assert_eq!(of(&request)[0], SpliceChange::Starts(10_000));
        request.brief.starts = 10_000;
        request.brief.least_amplitude = None;
        assert_eq!(of(&request), [&first[1..], &others[..3]].concat());
        for change in [&first[..], &others].concat() {
            let changed = request.changed(change);
            let SpliceRequest { film_mm, range_mm, distance_mm, smallest_cut_mm, ref brief, .. } = changed;
            let is_made = match change {
                SpliceChange::Starts(starts) => brief.starts == starts,
                SpliceChange::SmallestCutMm(cut_mm) => smallest_cut_mm == cut_mm,
                SpliceChange::FilmMm(mm) => film_mm == mm,
                SpliceChange::RangeMm(mm) => range_mm == mm,
                SpliceChange::DistanceMm(mm) => distance_mm == mm,
                SpliceChange::LeastAmplitude(least) => brief.least_amplitude == Some(least),
                SpliceChange::AnyParts => brief.parts.is_none(),
            };
            assert!(is_made && changed != request, "{change:?}");
        }
    }
}

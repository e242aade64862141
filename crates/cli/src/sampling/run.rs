//! The evaluation of samples in stretches.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use magsplice::Stage;
use magsplice::decouple::Figures;

use super::source::SampleSource;
use crate::failure::Failure;
use crate::progress::ProgressLine;

/// Time that a stretch of samples should take: often enough for progress and interruptions.
const STRETCH: Duration = Duration::from_millis(200);

/// Largest number of samples of a stretch.
const LONGEST_STRETCH: u64 = 1 << 16;

/// Samples to evaluate.
pub(crate) struct SamplingRun<'a> {
    /// The errors of samples with these numbers.
    pub(crate) errors_of: &'a dyn Fn(Range<u64>) -> Result<Vec<Figures>, Failure>,
    pub(crate) source: &'a SampleSource,
}

impl SamplingRun<'_> {
    /// Appends the errors of the samples that are not among `errors` yet. `keep` is called with
    /// each stretch of them. Ends early if `stop` is set.
    pub(crate) fn extend(
        &self,
        errors: &mut Vec<Figures>,
        mut keep: impl FnMut(&[Figures]) -> Result<(), Failure>,
        progress: &ProgressLine,
        stop: Option<&AtomicBool>,
    ) -> Result<(), Failure> {
        let SamplingRun { errors_of, source } = self;
        let mut stretch = rayon::current_num_threads() as u64;
        while (errors.len() as u64) < source.count && !stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
            let (done, of) = (errors.len(), Some(source.count as usize));
            progress.show(Stage { name: "films", done, of, unit: "samples" });
            let next = source.first + done as u64;
            let start = Instant::now();
            let samples = next..source.range().end.min(next + stretch);
            let found = errors_of(samples)?;
            keep(&found)?;
            errors.extend(found);
            if start.elapsed() < STRETCH / 2 {
                stretch = (2 * stretch).min(LONGEST_STRETCH);
            }
        }
        Ok(())
    }
}

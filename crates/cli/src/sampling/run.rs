//! The evaluation of samples in stretches.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use magsplice::Stage;
use magsplice::tolerance::{FilmErrors, Sampler};

use super::scene::SampledScene;
use super::source::SampleSource;
use crate::failure::Failure;
use crate::progress::ProgressLine;

/// Time that a stretch of samples should take: often enough for progress and interruptions.
const STRETCH: Duration = Duration::from_millis(200);

/// Largest number of samples of a stretch.
const LONGEST_STRETCH: u64 = 1 << 16;

/// Samples to evaluate.
pub(crate) struct SamplingRun<'a> {
    pub(crate) scene: &'a SampledScene<'a>,
    pub(crate) sampler: &'a Sampler<'a>,
    pub(crate) source: &'a SampleSource,
}

impl SamplingRun<'_> {
    /// Appends the errors of the samples that are not among `errors` yet. `keep` is called with each
    /// stretch of them. Ends early if `stop` is set.
    pub(crate) fn extend(
        &self,
        errors: &mut Vec<FilmErrors>,
        mut keep: impl FnMut(&[FilmErrors]) -> Result<(), Failure>,
        progress: &ProgressLine,
        stop: Option<&AtomicBool>,
    ) -> Result<(), Failure> {
        let SamplingRun { scene, sampler, source } = self;
        let mut stretch = rayon::current_num_threads() as u64;
        while (errors.len() as u64) < source.count && !stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
            let (done, of) = (errors.len(), Some(source.count as usize));
            progress.show(Stage { name: "films", done, of, unit: "samples" });
            let next = source.first + done as u64;
            let start = Instant::now();
            let samples = next..source.range().end.min(next + stretch);
            let found =
                sampler.errors_of_range(samples).map_err(|(sample, error)| scene.sample_failure(sample, &error))?;
            keep(&found)?;
            errors.extend(found);
            if start.elapsed() < STRETCH / 2 {
                stretch = (2 * stretch).min(LONGEST_STRETCH);
            }
        }
        Ok(())
    }
}

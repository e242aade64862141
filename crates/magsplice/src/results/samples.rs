//! Samples of films as made, and their statistics.

use std::ops::{ControlFlow, Range};
use std::time::{Duration, Instant};

use magsplice_decouple::Figures;
use magsplice_expect::keeps_bounds;
use magsplice_layout::{FigureBounds, FilmTolerance};
use magsplice_magnet::overlaps;
use magsplice_making::{PlaceGroup, SortedSampler, Sorting};
use magsplice_tolerance::{Estimate, EvaluationGrid, RealFilm, SampleError, Sampler, Statistics, share, statistics};
use serde::Serialize;

use super::source::Source;
use crate::film::Film;
use crate::film_error::FilmError;

/// Time that a stretch of samples should take: often enough for progress and interruptions.
const STRETCH: Duration = Duration::from_millis(200);

/// Largest number of samples of a stretch.
const LONGEST_STRETCH: u64 = 1 << 16;

/// Whether the time can be read: a WebAssembly module without imports has no clock.
const HAS_CLOCK: bool = !cfg!(all(target_family = "wasm", target_os = "unknown"));

/// Bytes of a sampler for each point of the volume: points, and the field of a neighbour.
const BYTES_PER_POINT: f64 = 48.0;

/// Bytes of a sample for each point: readings and parameters. Measured with both: 174 for two
/// threads.
const BYTES_PER_THREAD: f64 = 64.0;

/// Number of samples whose tiles are searched for overlaps. Tiles that touch overlap in the first.
const SEARCHED_FOR_OVERLAPS: u64 = 20;

/// Depth of an overlap that counts, in millimetres: the resolution of machine tools.
const LEAST_OVERLAP_MM: f64 = 1e-3;

/// A run of samples: the hash of the sampled film, the seed, and the numbers of the samples.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SampleRun {
    /// Hash of all that determines a sample besides the seed; see
    /// [`Layout::sample_fingerprint`](magsplice_layout::Layout::sample_fingerprint).
    pub film: String,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Number of the first sample.
    pub first: u64,
    /// Number of samples.
    pub count: u64,
}

/// Statistics of the samples of a film.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SampledFilm {
    /// The film.
    #[serde(flatten)]
    pub source: Source,
    /// What they are samples of.
    #[serde(flatten)]
    pub run: SampleRun,
    /// How the tiles of each sample are sorted. `None` if they are not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sorting: Option<Sorting>,
    /// Nominal values and statistics.
    #[serde(flatten)]
    pub figures: Figures<SampledFigure>,
    /// Depth to which tiles overlap in the first 20 samples, beyond what the layout allows, in
    /// millimetres; 0 without overlaps. Errors of neighbours are independent, but placed tiles push
    /// each other aside. `None` for sorted tiles.
    pub overlap_mm: Option<f64>,
    /// Depth to which tiles reach into iron that moves with the film in the first 20 samples,
    /// beyond what the layout allows, in millimetres: placed tiles cannot. `None` without iron, and
    /// for sorted tiles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub in_iron_mm: Option<f64>,
    /// The share of the samples that keep all bounds of `[expect.made]`. `None` without bounds.
    /// Bounds of `[expect]` are for the film as ordered, and no sample is compared with them.
    pub yield_made: Option<Estimate>,
}

/// A figure of the samples of a film.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SampledFigure {
    /// The figure of the film as ordered.
    pub nominal: f64,
    /// Statistics of the samples.
    #[serde(flatten)]
    pub statistics: Statistics,
}

/// A film whose samples are drawn, with its working volume and its ideal film.
#[derive(Clone, Debug)]
pub struct FilmSampling {
    film: Film,
    real: RealFilm,
    volume: EvaluationGrid,
}

impl SampleRun {
    /// The numbers of the samples.
    pub fn range(&self) -> Range<u64> {
        self.first..self.first + self.count
    }
}

impl Film {
    /// The samples of films as made.
    ///
    /// # Errors
    /// If the layout has no ideal film, no working volume or no errors; [`FilmError::Memory`].
    pub fn sampling(&self) -> Result<FilmSampling, FilmError> {
        self.ideal()?;
        let bytes_per_point = BYTES_PER_POINT + BYTES_PER_THREAD * rayon::current_num_threads() as f64;
        let (volume, real) = (self.evaluation_grid(bytes_per_point)?, self.real_film()?);
        Ok(FilmSampling { film: self.clone(), real, volume })
    }
}

impl FilmSampling {
    /// A sampler of films as made.
    ///
    /// # Errors
    /// [`FilmError::Sample`] if the figures of the film do not exist.
    pub fn sampler(&self, seed: u64) -> Result<Sampler<'_>, FilmError> {
        self.sampler_of(&self.real, seed)
    }

    /// A sampler of films whose tiles are sorted: tiles of one part of the layout may be exchanged.
    ///
    /// # Errors
    /// [`FilmError::Sorting`] if a part does not fit its places.
    pub fn sorted_sampler<'s>(
        &self,
        sampler: &'s Sampler<'s>,
        sorting: Sorting,
    ) -> Result<SortedSampler<'s>, FilmError> {
        let parts = PlaceGroup::from_layout(self.film.layout());
        SortedSampler::new(sampler, parts, &self.volume, self.film.ideal()?, sorting).map_err(FilmError::Sorting)
    }

    /// The figures of the film as it was ordered.
    ///
    /// # Errors
    /// [`FilmError::Sample`] if they do not exist.
    pub fn nominal(&self) -> Result<Figures, FilmError> {
        let ordered = self.real.clone().with_tolerance(&FilmTolerance::default());
        self.sampler_of(&ordered, 1)?.errors_of(0).map_err(of_sample(0))
    }

    /// Statistics of samples.
    ///
    /// # Errors
    /// As [`FilmSampling::nominal`].
    ///
    /// # Panics
    /// Without samples.
    pub fn statistics(
        &self,
        run: SampleRun,
        sorting: Option<Sorting>,
        samples: &[Figures],
    ) -> Result<SampledFilm, FilmError> {
        let (nominal, statistics) = (self.nominal()?, statistics(samples).expect("at least one sample"));
        let sampled =
            |figure| Some(SampledFigure { nominal: *nominal.get(figure)?, statistics: *statistics.get(figure)? });
        let made = &self.film.layout().expectations.made;
        let depths_mm = sorting.is_none().then(|| self.depths_mm(&run));
        Ok(SampledFilm {
            source: Source::of(&self.film),
            run,
            sorting,
            figures: Figures::from_fn(sampled).expect("only a uniformity is undefined"),
            overlap_mm: depths_mm.map(|[overlap_mm, _]| overlap_mm),
            in_iron_mm: depths_mm.map(|[_, in_iron_mm]| in_iron_mm).filter(|_| !self.film.layout().iron.is_empty()),
            yield_made: made.as_ref().and_then(|made| keeping(&made.bounds, samples)),
        })
    }

    /// The largest depths to which tiles overlap, and reach into iron, in the first samples of a
    /// run.
    fn depths_mm(&self, run: &SampleRun) -> [f64; 2] {
        let layout = self.film.layout();
        let made = run.range().take(SEARCHED_FOR_OVERLAPS as usize).filter_map(|n| self.real.sample(run.seed, n).ok());
        let deepest = made.fold([0.0_f64; 2], |[overlap, in_iron], sample| {
            let of_pairs = overlaps(sample.tiles()).map(|pair| pair.depth).fold(overlap, f64::max);
            [of_pairs, in_iron.max(layout.iron.depth_of(sample.tiles()))]
        });
        let allowed_mm = layout.overlap_mm.max(LEAST_OVERLAP_MM);
        deepest.map(|depth_mm| if depth_mm > allowed_mm { depth_mm } else { 0.0 })
    }

    fn sampler_of<'s>(&'s self, film: &'s RealFilm, seed: u64) -> Result<Sampler<'s>, FilmError> {
        Sampler::new(film, &self.volume, self.film.ideal()?, seed).map_err(of_sample(0))
    }
}

/// Evaluates samples in stretches of a fifth of a second. The first stretch has one sample for each
/// thread, and all have where there is no clock. `keep` takes each stretch, and may end the run.
///
/// # Errors
/// Those of `evaluate` and of `keep`.
pub fn in_stretches<T, E>(
    samples: Range<u64>,
    threads: usize,
    mut evaluate: impl FnMut(Range<u64>) -> Result<Vec<T>, E>,
    mut keep: impl FnMut(Vec<T>) -> Result<ControlFlow<()>, E>,
) -> Result<(), E> {
    let (mut next, mut stretch) = (samples.start, threads as u64);
    while next < samples.end {
        let part = next..samples.end.min(next + stretch);
        next = part.end;
        let begun = HAS_CLOCK.then(Instant::now);
        if keep(evaluate(part)?)?.is_break() {
            break;
        }
        if begun.is_some_and(|begun| begun.elapsed() < STRETCH / 2) {
            stretch = (2 * stretch).min(LONGEST_STRETCH);
        }
    }
    Ok(())
}

/// The share of the samples that keep all bounds; nothing if there are none.
fn keeping(bounds: &FigureBounds, samples: &[Figures]) -> Option<Estimate> {
    let kept: Vec<bool> = samples.iter().map(|figures| keeps_bounds(bounds, figures)).collect::<Option<_>>()?;
    share(kept.iter().filter(|kept| **kept).count(), kept.len())
}

fn of_sample(sample: u64) -> impl Fn(SampleError) -> FilmError {
    move |error| FilmError::Sample { sample, error }
}

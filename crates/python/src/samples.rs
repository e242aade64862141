//! Samples of films that are made.

use std::time::{Duration, Instant};

use magsplice::FilmError;
use magsplice::decouple::Figures;
use magsplice::ideal::IdealFilm;
use magsplice::tolerance::{Estimate, EvaluationGrid, RealFilm, SampleError, Sampler, Statistics};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::exceptions::{failed, of_film};
use crate::film::Film;
use crate::vectors::{Triple, numbers, rows_of};

/// Time that a stretch of samples should take: often enough for signals.
const STRETCH: Duration = Duration::from_millis(200);
/// Largest number of samples of a stretch.
const LONGEST_STRETCH: u64 = 1 << 16;

/// Errors of samples: uniformity RMSE and displacement RMSE of shape (n, 3), amplitude of shape
/// (n,).
type Errors<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>);

/// The errors of samples `first` to `first + count` of the films that are made from a layout, on so
/// many threads.
#[pyfunction]
#[pyo3(signature = (film, preset, seed, first, count, threads=None, progress=None))]
#[expect(clippy::too_many_arguments, reason = "Python passes them by name")]
pub(crate) fn samples<'py>(
    py: Python<'py>,
    film: &Film,
    preset: Option<&str>,
    seed: Option<u64>,
    first: u64,
    count: u64,
    threads: Option<usize>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Errors<'py>> {
    let layout = film.layout_with_errors(preset)?;
    let pool = threads.map(|count| rayon::ThreadPoolBuilder::new().num_threads(count).build()).transpose();
    let pool = pool.map_err(failed)?;
    let tell = |done: u64| progress.as_ref().map_or(Ok(()), |call| call.call1((done, count)).map(|_| ()));
    let scene = SampledFilm::new(&film.with_tables(py, layout)?)?;
    let found = sampled(py, &scene, seed, first..first + count, pool.as_ref(), &tell)?;
    Ok(arrays(py, &found))
}

/// The errors of samples of a film. Signals are polled between stretches.
pub(crate) fn sampled(
    py: Python<'_>,
    scene: &SampledFilm,
    seed: Option<u64>,
    range: std::ops::Range<u64>,
    pool: Option<&rayon::ThreadPool>,
    tell: &dyn Fn(u64) -> PyResult<()>,
) -> PyResult<Vec<Figures>> {
    let sampler = py.detach(|| scene.sampler(seed)).map_err(failed)?;
    let workers = pool.map_or_else(rayon::current_num_threads, rayon::ThreadPool::current_num_threads);
    let (mut found, mut stretch) = (Vec::new(), workers as u64);
    while range.start + (found.len() as u64) < range.end {
        let next = range.start + found.len() as u64;
        let part = next..range.end.min(next + stretch);
        let begun = Instant::now();
        let errors = py.detach(|| match pool {
            Some(pool) => pool.install(|| sampler.errors_of_range(part)),
            None => sampler.errors_of_range(part),
        });
        found.extend(errors.map_err(|(sample, error)| failed(FilmError::Sample { sample, error }))?);
        if begun.elapsed() < STRETCH / 2 {
            stretch = (2 * stretch).min(LONGEST_STRETCH);
        }
        py.check_signals()?;
        tell(found.len() as u64)?;
    }
    Ok(found)
}

/// The errors of the film as it is ordered.
#[pyfunction]
pub(crate) fn nominal<'py>(py: Python<'py>, film: &Film) -> PyResult<Errors<'py>> {
    let layout = film.layout_with_errors(Some("workshop"))?;
    let scene = SampledFilm::new(&film.with_tables(py, layout)?)?;
    let found = py.detach(|| scene.nominal()).map_err(failed)?;
    Ok(arrays(py, &[found]))
}

/// A film whose samples are drawn.
pub(crate) struct SampledFilm {
    real: RealFilm,
    volume: EvaluationGrid,
    ideal: IdealFilm,
    seed: u64,
}

impl SampledFilm {
    pub(crate) fn new(film: &magsplice::Film) -> PyResult<SampledFilm> {
        let real = film.real_film().map_err(of_film)?;
        let volume = film.evaluation_grid().map_err(of_film)?;
        let (ideal, seed) = (*film.ideal().map_err(of_film)?, real.tolerance().seed);
        Ok(SampledFilm { real, volume, ideal, seed })
    }

    fn sampler(&self, seed: Option<u64>) -> Result<Sampler<'_>, SampleError> {
        Sampler::new(&self.real, &self.volume, &self.ideal, seed.unwrap_or(self.seed))
    }

    /// The errors of the film without errors of its tiles.
    pub(crate) fn nominal(&self) -> Result<Figures, SampleError> {
        let exact = self.real.clone().without_errors();
        Sampler::new(&exact, &self.volume, &self.ideal, self.seed)?.errors_of(0)
    }
}

fn arrays<'py>(py: Python<'py>, errors: &[Figures]) -> Errors<'py> {
    let undefined = |rmse: Option<f64>| rmse.unwrap_or(f64::NAN);
    let uniformity: Vec<_> = errors.iter().map(|e| e.uniformity_rmse.to_array().map(undefined).into()).collect();
    let displacement: Vec<_> = errors.iter().map(|e| e.displacement_rmse_mm.into()).collect();
    let amplitude = errors.iter().map(|e| e.amplitude).collect();
    (rows_of(py, &uniformity), rows_of(py, &displacement), numbers(py, amplitude))
}

/// Mean and percentiles of samples, each with the ends of its interval of 95 %.
#[derive(IntoPyObject)]
pub(crate) struct StatisticsNumbers {
    count: usize,
    mean: Triple,
    p1: Triple,
    p5: Triple,
    p50: Triple,
    p95: Triple,
    p99: Triple,
}

impl From<Statistics> for StatisticsNumbers {
    fn from(s: Statistics) -> StatisticsNumbers {
        let numbers = |Estimate { value, interval: [low, high] }| (value, low, high);
        let [mean, p1, p5, p50, p95, p99] = [s.mean, s.p1, s.p5, s.p50, s.p95, s.p99].map(numbers);
        StatisticsNumbers { count: s.count, mean, p1, p5, p50, p95, p99 }
    }
}

/// Mean and percentiles of samples; None without samples.
#[pyfunction]
pub(crate) fn statistics(py: Python<'_>, values: PyReadonlyArray1<'_, f64>) -> PyResult<Option<StatisticsNumbers>> {
    let values = values.as_slice()?;
    Ok(py.detach(|| Statistics::new(values.iter().copied())).map(StatisticsNumbers::from))
}

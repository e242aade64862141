//! Samples of films as made.

use std::ops::{ControlFlow, Range};

use magsplice::FilmError;
use magsplice::decouple::{Figure, Figures};
use magsplice::making::Sorting;
use magsplice::results::{FilmSampling, SampleRun, in_stretches};
use magsplice::tolerance::Statistics;
use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::exceptions::{failed, of_film};
use crate::film::Film;
use crate::results::dictionary;
use crate::threads::{self, detached, on};
use crate::vectors::rows;

/// The figures of samples `first` to `first + count` of films as made, on `threads` threads.
#[pyfunction]
#[pyo3(signature = (film, preset, seed, first, count, threads=None, progress=None))]
#[expect(clippy::too_many_arguments, reason = "Python passes them by name")]
pub(crate) fn samples<'py>(
    py: Python<'py>,
    film: &Film,
    preset: Option<&str>,
    seed: u64,
    first: u64,
    count: u64,
    threads: Option<usize>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let film = film.with_tables(py, film.layout_with_errors(preset)?)?;
    let pool = threads.map(|count| magsplice::threads::pool(Some(count))).transpose();
    let pool = pool.map_err(failed)?;
    let tell = |done: u64| progress.as_ref().map_or(Ok(()), |call| call.call1((done, count)).map(|_| ()));
    let sampling = film.sampling().map_err(of_film)?;
    let found = errors_of(py, &sampling, seed, first..first + count, pool.as_ref(), &tell)?;
    rows(py, found.iter().map(numbers_of))
}

/// The errors of samples of a film, on the threads of `pool` or of the process. Signals are polled
/// between stretches.
pub(crate) fn errors_of(
    py: Python<'_>,
    sampling: &FilmSampling,
    seed: u64,
    range: Range<u64>,
    pool: Option<&rayon::ThreadPool>,
    tell: &dyn Fn(u64) -> PyResult<()>,
) -> PyResult<Vec<Figures>> {
    let of_process = threads::pool(py)?;
    let pool = pool.or(of_process.as_deref());
    let sampler = py.detach(|| on(pool, || sampling.sampler(seed))).map_err(of_film)?;
    let threads = on(pool, rayon::current_num_threads);
    let mut found = Vec::new();
    let evaluate = |part: Range<u64>| {
        let errors = py.detach(|| on(pool, || sampler.errors_of_range(part, || {})));
        errors.map_err(|(sample, error)| of_film(FilmError::Sample { sample, error }))
    };
    in_stretches(range, threads, evaluate, |stretch| {
        found.extend(stretch);
        py.check_signals()?;
        tell(found.len() as u64)?;
        Ok(ControlFlow::Continue(()))
    })?;
    Ok(found)
}

/// The statistics of samples from `first` on with these errors.
#[pyfunction]
pub(crate) fn sampled<'py>(
    py: Python<'py>,
    film: &Film,
    preset: Option<&str>,
    seed: u64,
    first: u64,
    errors: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let film = film.with_tables(py, film.layout_with_errors(preset)?)?;
    let errors: Vec<Figures> = errors.as_slice()?.as_chunks().0.iter().map(figures_of).collect();
    let run =
        SampleRun { film: film.layout().sample_fingerprint(&None::<Sorting>), seed, first, count: errors.len() as u64 };
    let found = detached(py, || film.sampling()?.statistics(run, None, &errors))?.map_err(of_film)?;
    dictionary(py, &found)
}

/// The figures of a sample in the order of [`Figure::ALL`]; NaN where a uniformity is undefined.
fn numbers_of(figures: &Figures) -> [f64; Figure::ALL.len()] {
    Figure::ALL.map(|figure| figures.get(figure).copied().unwrap_or(f64::NAN))
}

/// The inverse of [`numbers_of`].
fn figures_of(numbers: &[f64; Figure::ALL.len()]) -> Figures {
    let defined = |figure: Figure| Some(numbers[figure.index()]).filter(|number| !number.is_nan());
    Figures::from_fn(defined).expect("only a uniformity is undefined")
}

/// Mean and percentiles of samples, each with the ends of its interval of 95 %; None without
/// samples.
#[pyfunction]
pub(crate) fn statistics<'py>(
    py: Python<'py>,
    values: PyReadonlyArray1<'py, f64>,
) -> PyResult<Option<Bound<'py, PyDict>>> {
    let values = values.as_slice()?;
    let found = detached(py, || Statistics::new(values.iter().copied()))?;
    found.map(|statistics| dictionary(py, &statistics)).transpose()
}

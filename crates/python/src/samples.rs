//! Samples of films that are made.

use std::ops::{ControlFlow, Range};

use magsplice::FilmError;
use magsplice::decouple::Figures;
use magsplice::results::{FilmSampling, in_stretches};
use magsplice::tolerance::Statistics;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::exceptions::{failed, of_film};
use crate::film::Film;
use crate::results::dictionary;
use crate::vectors::{numbers, rows_of};

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
    seed: u64,
    first: u64,
    count: u64,
    threads: Option<usize>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Errors<'py>> {
    let film = film.with_tables(py, film.layout_with_errors(preset)?)?;
    let pool = threads.map(|count| rayon::ThreadPoolBuilder::new().num_threads(count).build()).transpose();
    let pool = pool.map_err(failed)?;
    let tell = |done: u64| progress.as_ref().map_or(Ok(()), |call| call.call1((done, count)).map(|_| ()));
    let sampling = film.sampling().map_err(of_film)?;
    let found = sampled(py, &sampling, seed, first..first + count, pool.as_ref(), &tell)?;
    Ok(arrays(py, &found))
}

/// The errors of samples of a film. Signals are polled between stretches.
pub(crate) fn sampled(
    py: Python<'_>,
    sampling: &FilmSampling,
    seed: u64,
    range: Range<u64>,
    pool: Option<&rayon::ThreadPool>,
    tell: &dyn Fn(u64) -> PyResult<()>,
) -> PyResult<Vec<Figures>> {
    let sampler = py.detach(|| sampling.sampler(seed)).map_err(of_film)?;
    let threads = pool.map_or_else(rayon::current_num_threads, rayon::ThreadPool::current_num_threads);
    let mut found = Vec::new();
    let evaluate = |part: Range<u64>| {
        let errors = py.detach(|| match pool {
            Some(pool) => pool.install(|| sampler.errors_of_range(part)),
            None => sampler.errors_of_range(part),
        });
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

/// The errors of the film as it is ordered.
#[pyfunction]
pub(crate) fn nominal<'py>(py: Python<'py>, film: &Film) -> PyResult<Errors<'py>> {
    let film = film.with_tables(py, film.layout_with_errors(Some("workshop"))?)?;
    let found = py.detach(|| film.sampling()?.nominal()).map_err(of_film)?;
    Ok(arrays(py, &[found]))
}

fn arrays<'py>(py: Python<'py>, errors: &[Figures]) -> Errors<'py> {
    let undefined = |rmse: Option<f64>| rmse.unwrap_or(f64::NAN);
    let uniformity: Vec<_> = errors.iter().map(|e| e.uniformity_rmse.to_array().map(undefined).into()).collect();
    let displacement: Vec<_> = errors.iter().map(|e| e.displacement_rmse_mm.into()).collect();
    let amplitude = errors.iter().map(|e| e.amplitude).collect();
    (rows_of(py, &uniformity), rows_of(py, &displacement), numbers(py, amplitude))
}

/// Mean and percentiles of samples, each with the ends of its interval of 95 %; None without
/// samples.
#[pyfunction]
pub(crate) fn statistics<'py>(
    py: Python<'py>,
    values: PyReadonlyArray1<'py, f64>,
) -> PyResult<Option<Bound<'py, PyDict>>> {
    let values = values.as_slice()?;
    let found = py.detach(|| Statistics::new(values.iter().copied()));
    found.map(|statistics| dictionary(py, &statistics)).transpose()
}

//! Expectations of a film.

use std::path::PathBuf;

use magsplice::expect::{Baseline, Bound, Location, Outcome};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;

use crate::film::Film;
use crate::interruption::Interruption;
use crate::vectors::{Triple, vectors};

/// An expectation with its outcome, with the fields of the Python class.
#[derive(Default, IntoPyObject)]
pub(crate) struct OutcomeNumbers {
    expectation: String,
    error: Option<String>,
    value: Option<f64>,
    at_most: Option<f64>,
    at_least: Option<f64>,
    margin: Option<f64>,
    at_mm: Option<Triple>,
    tile: Option<String>,
    /// Per cent, estimate and number of samples.
    percentile: Option<(f64, f64, usize)>,
}

/// File of the baseline that the layout names, relative to the layout.
#[pyfunction]
pub(crate) fn baseline_file(film: &Film) -> Option<PathBuf> {
    film.layout.expectations.field.as_ref().map(|field| field.file.clone())
}

/// The outcomes of all expectations of the layout. The baseline has points and B in tesla.
#[pyfunction]
#[pyo3(signature = (film, baseline=None))]
pub(crate) fn check(
    py: Python<'_>,
    film: &Film,
    baseline: Option<(PyReadonlyArray2<'_, f64>, PyReadonlyArray2<'_, f64>)>,
) -> PyResult<Vec<OutcomeNumbers>> {
    let held = baseline.as_ref().map(|(points, field_t)| {
        Ok::<_, PyErr>(Baseline { points: vectors(points)?.to_vec(), field_t: vectors(field_t)?.to_vec() })
    });
    let held = held.transpose()?;
    let interruption = Interruption::default();
    let progress = |_| interruption.poll();
    let evaluated = film.evaluated(py)?.telling(&progress);
    let outcomes = interruption.run(py, || evaluated.outcomes(held.as_ref()))?;
    let numbers = outcomes.into_iter().map(|(expectation, outcome)| OutcomeNumbers {
        expectation: expectation.to_string(),
        ..match outcome {
            Ok(outcome) => of_outcome(film, &outcome),
            Err(error) => OutcomeNumbers { error: Some(error.to_string()), ..OutcomeNumbers::default() },
        }
    });
    Ok(numbers.collect())
}

fn of_outcome(film: &Film, outcome: &Outcome) -> OutcomeNumbers {
    let (at_most, at_least) = match outcome.bound {
        Bound::AtMost(most) => (Some(most), None),
        Bound::AtLeast(least) => (None, Some(least)),
    };
    let (mut at_mm, mut tile, mut percentile) = (None, None, None);
    match outcome.location {
        Some(Location::Point(point)) => at_mm = Some(point.into()),
        Some(Location::Tile(index)) => tile = Some(film.layout.tiles[index].name.clone()),
        Some(Location::Percentile { per_cent, value, samples }) => percentile = Some((per_cent, value, samples)),
        _ => {}
    }
    let (value, margin) = (Some(outcome.value), Some(outcome.margin()));
    OutcomeNumbers { value, at_most, at_least, margin, at_mm, tile, percentile, ..OutcomeNumbers::default() }
}

//! Expectations of a film.

use std::path::Path;
use std::time::Duration;

use magsplice::RecoilEstimate;
use magsplice::expect::{Baseline, Expectation};
use magsplice::layout::Layout;
use magsplice::results::{CheckedExpectation, CheckedLayout};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::film::Film;
use crate::results::dictionary;
use crate::vectors::vectors;

/// A baseline, or the reason why it cannot be read.
#[derive(FromPyObject)]
pub(crate) enum Held<'py> {
    /// The fault.
    Fault(String),
    /// Points in millimetres, and B in tesla.
    Field(PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f64>),
}

/// The outcomes of all expectations of the layout.
#[pyfunction]
#[pyo3(signature = (film, baseline=None))]
pub(crate) fn check<'py>(py: Python<'py>, film: &Film, baseline: Option<Held<'py>>) -> PyResult<Bound<'py, PyDict>> {
    let (held, fault) = match &baseline {
        None => (None, None),
        Some(Held::Fault(fault)) => (None, Some(fault)),
        Some(Held::Field(points, field_t)) => {
            (Some(Baseline { points: vectors(points)?.to_vec(), field_t: vectors(field_t)?.to_vec() }), None)
        }
    };
    let layout = &film.layout;
    let mut checked = CheckedLayout::new(Path::new(&film.source.1), &Ok(Layout::clone(layout)), Duration::ZERO);
    if layout.expectations.is_empty() {
        return dictionary(py, &checked);
    }
    let (outcomes, estimates) =
        film.run(py, |film| Ok((film.outcomes(held.as_ref()), RecoilEstimate::of_stated(film.layout()))))?;
    let outcome = |(expectation, outcome): (Expectation, Result<_, magsplice::FilmError>)| {
        let outcome = match (fault, expectation) {
            (Some(fault), Expectation::Field) => Err(fault.clone()),
            _ => outcome.map_err(|error| error.to_string()),
        };
        CheckedExpectation::new(expectation, outcome, layout, Duration::ZERO)
    };
    // A film without an estimate has no figures.
    checked.recoil_estimates = estimates.unwrap_or_default();
    dictionary(py, &checked.with_expectations(outcomes.into_iter().map(outcome).collect()))
}

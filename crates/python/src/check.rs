//! Expectations of a film.

use std::path::Path;
use std::time::Duration;

use magsplice::RecoilEstimate;
use magsplice::decouple::Figures;
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
    let layout = &film.layout;
    let mut checked = CheckedLayout::new(Path::new(&film.source.1), &Ok(Layout::clone(layout)), Duration::ZERO);
    if layout.expectations.is_empty() {
        return dictionary(py, &checked);
    }
    let baseline = known(baseline)?;
    let (outcomes, estimates) =
        film.run(py, |film| Ok((expectations(&film, &baseline, &[]), RecoilEstimate::of_stated(film.layout()))))?;
    // A film without an estimate has no figures.
    checked.recoil_estimates = estimates.unwrap_or_default();
    dictionary(py, &checked.with_expectations(outcomes))
}

/// The baseline, if any, as the program reads it.
pub(crate) fn known(baseline: Option<Held<'_>>) -> PyResult<Option<Result<Baseline, String>>> {
    Ok(match &baseline {
        None => None,
        Some(Held::Fault(fault)) => Some(Err(fault.clone())),
        Some(Held::Field(points, field_t)) => {
            Some(Ok(Baseline { points: vectors(points)?.to_vec(), field_t: vectors(field_t)?.to_vec() }))
        }
    })
}

/// The expectations of a film, checked. `made` are the errors of the first films as made, as far as
/// they are known.
pub(crate) fn expectations(
    film: &magsplice::Film,
    baseline: &Option<Result<Baseline, String>>,
    made: &[Figures],
) -> Vec<CheckedExpectation> {
    let mut checked = Vec::new();
    film.each_outcome(baseline.as_ref().and_then(|b| b.as_ref().ok()), made, |expectation, outcome| {
        let outcome = match (baseline, expectation) {
            (Some(Err(fault)), Expectation::Field) => Err(fault.clone()),
            _ => outcome.map_err(|error| error.to_string()),
        };
        checked.push(CheckedExpectation::new(expectation, outcome, film.layout(), Duration::ZERO));
    });
    checked
}

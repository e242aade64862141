//! `compare`: the comparison with the ideal film.

use magsplice::Film;
use magsplice::field::Comparison;
use serde::Serialize;

use super::source::SourceJson;

/// The result of `compare`.
#[derive(Serialize)]
pub(crate) struct CompareJson<'a> {
    #[serde(flatten)]
    source: SourceJson<'a>,
    comparison: ComparisonJson,
}

impl<'a> CompareJson<'a> {
    pub(crate) fn new(film: &Film<'a>, comparison: &Comparison) -> CompareJson<'a> {
        CompareJson { source: SourceJson::new(film), comparison: comparison.into() }
    }
}

/// [`Comparison`] with units in its keys.
#[derive(Serialize)]
pub(crate) struct ComparisonJson {
    points: usize,
    component_rmse_t: [f64; 3],
    rmse_t: f64,
    relative_rmse: f64,
    worst_t: f64,
    worst_at_mm: [f64; 3],
    amplitude: f64,
    scaled_relative_rmse: Option<f64>,
    correlation: [Option<f64>; 3],
}

impl From<&Comparison> for ComparisonJson {
    fn from(c: &Comparison) -> ComparisonJson {
        ComparisonJson {
            points: c.points,
            component_rmse_t: c.component_rmse_t.to_array(),
            rmse_t: c.rmse_t,
            relative_rmse: c.relative_rmse,
            worst_t: c.worst_t,
            worst_at_mm: c.worst_at.to_array(),
            amplitude: c.amplitude,
            scaled_relative_rmse: c.scaled_relative_rmse,
            correlation: c.correlation,
        }
    }
}

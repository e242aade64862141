//! The outcome of an expectation of a film.

use std::time::Duration;

use glam::DVec3;
use magsplice_expect::{Bound, Expectation, Location, Outcome};
use magsplice_layout::Layout;
use serde::Serialize;

/// Status of an expectation, from best to worst. The numbers are exit statuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub enum CheckStatus {
    /// The bound is kept.
    #[serde(rename = "ok")]
    Ok = 0,
    /// The bound is broken, or something is allowed but rarely intended.
    #[serde(rename = "failed")]
    Finding = 1,
    /// It cannot be evaluated.
    #[serde(rename = "error")]
    Unusable = 2,
}

/// An expectation that was checked. Either `error` or `value` is `None`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckedExpectation {
    /// The quantity.
    pub expectation: Expectation,
    /// Whether its bound is kept.
    pub status: CheckStatus,
    /// Why it cannot be evaluated.
    pub error: Option<String>,
    /// The computed value, in the unit of the expectation.
    pub value: Option<f64>,
    /// The bound of the layout, in the same unit.
    #[serde(flatten)]
    pub bound: Option<Bound>,
    /// Distance of the value from its bound; negative if the value breaks it.
    pub margin: Option<f64>,
    /// The point of the value, if it is the worst of many points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_mm: Option<DVec3>,
    /// The tile of the value, if it is the worst of all tiles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tile: Option<String>,
    /// The percentile of films as made; `value` is its confidence limit, which is compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub percentile: Option<CheckedPercentile>,
    /// Time that the evaluation took. The first expectation that needs the field bears its time.
    #[serde(skip)]
    pub took: Duration,
}

/// A percentile of films as made.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CheckedPercentile {
    /// Which percentile.
    pub per_cent: f64,
    /// Its estimate.
    pub value: f64,
    /// Number of samples.
    pub samples: usize,
}

impl CheckedExpectation {
    /// An expectation of a layout with its outcome, or why it cannot be evaluated.
    pub fn new(
        expectation: Expectation,
        outcome: Result<Outcome, String>,
        layout: &Layout,
        took: Duration,
    ) -> CheckedExpectation {
        let status = match &outcome {
            Ok(outcome) if outcome.is_met() => CheckStatus::Ok,
            Ok(_) => CheckStatus::Finding,
            Err(_) => CheckStatus::Unusable,
        };
        let (outcome, error) = match outcome {
            Ok(outcome) => (Some(outcome), None),
            Err(error) => (None, Some(error)),
        };
        let (mut at_mm, mut tile, mut percentile) = (None, None, None);
        match outcome.and_then(|outcome| outcome.location) {
            Some(Location::Point(point)) => at_mm = Some(point),
            Some(Location::Tile(index)) => tile = Some(layout.tiles[index].name.clone()),
            Some(Location::Percentile { per_cent, value, samples }) => {
                percentile = Some(CheckedPercentile { per_cent, value, samples });
            }
            _ => {}
        }
        CheckedExpectation {
            expectation,
            status,
            error,
            value: outcome.map(|outcome| outcome.value),
            bound: outcome.map(|outcome| outcome.bound),
            margin: outcome.map(|outcome| outcome.margin()),
            at_mm,
            tile,
            percentile,
            took,
        }
    }
}

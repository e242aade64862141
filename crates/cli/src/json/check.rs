//! `check`: layouts with their expectations.

use std::path::Path;

use magsplice::expect::{Bound, Expectation, Location};
use magsplice::layout::Layout;
use serde::Serialize;

use super::recoil::RecoilEstimateJson;
use crate::checked::{CheckStatus, CheckedExpectation, CheckedLayout};
use crate::layout_files::NO_LAYOUT;

/// The result of `check`.
#[derive(Serialize)]
pub(crate) struct CheckJson<'a> {
    version: &'static str,
    layouts: Vec<CheckedLayoutJson<'a>>,
    skipped: Vec<SkippedJson>,
}

/// A TOML file of a folder that is no layout.
#[derive(Serialize)]
struct SkippedJson {
    file: String,
    reason: &'static str,
}

impl<'a> CheckJson<'a> {
    pub(crate) fn new(layouts: &'a [CheckedLayout], skipped: &[&Path]) -> CheckJson<'a> {
        let skipped = skipped.iter().map(|path| SkippedJson { file: path.display().to_string(), reason: NO_LAYOUT });
        CheckJson {
            version: env!("CARGO_PKG_VERSION"),
            layouts: layouts.iter().map(CheckedLayoutJson::from).collect(),
            skipped: skipped.collect(),
        }
    }
}

#[derive(Serialize)]
struct CheckedLayoutJson<'a> {
    file: String,
    status: &'static str,
    /// Why the layout cannot be used; null if it can.
    error: Option<&'a str>,
    layout: Option<&'a str>,
    sha256: Option<&'a str>,
    tiles: Option<usize>,
    findings: Vec<&'a str>,
    expectations: Vec<CheckedExpectationJson<'a>>,
    /// What recoil changes, to first order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    recoil_estimates: Vec<RecoilEstimateJson>,
    /// How far the field moved from the earlier baseline.
    #[serde(skip_serializing_if = "Option::is_none")]
    moved: Option<&'a str>,
}

impl<'a> From<&'a CheckedLayout> for CheckedLayoutJson<'a> {
    fn from(checked: &'a CheckedLayout) -> CheckedLayoutJson<'a> {
        let layout = checked.layout.as_ref();
        let expectation = |e| CheckedExpectationJson::new(e, layout.expect("only usable layouts have expectations"));
        CheckedLayoutJson {
            file: checked.path.display().to_string(),
            status: word(checked.status()),
            error: layout.err().map(String::as_str),
            layout: layout.ok().map(|l| l.name.as_str()),
            sha256: layout.ok().map(|l| l.sha256.as_str()),
            tiles: layout.ok().map(|l| l.tiles.len()),
            findings: checked.findings().iter().map(|finding| finding.message.as_str()).collect(),
            expectations: checked.expectations.iter().map(expectation).collect(),
            recoil_estimates: checked.recoil.iter().map(Into::into).collect(),
            moved: checked.moved.as_deref(),
        }
    }
}

#[derive(Serialize)]
struct CheckedExpectationJson<'a> {
    expectation: Expectation,
    status: &'static str,
    /// Why the expectation cannot be evaluated; null if it can. Either this or `value` is null.
    error: Option<&'a str>,
    value: Option<f64>,
    #[serde(flatten)]
    bound: Option<Bound>,
    margin: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    at_mm: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tile: Option<&'a str>,
    /// The percentile of the films that are made; `value` is the limit that it passes.
    #[serde(skip_serializing_if = "Option::is_none")]
    percentile: Option<PercentileJson>,
}

#[derive(Serialize)]
struct PercentileJson {
    per_cent: f64,
    value: f64,
    samples: usize,
}

impl<'a> CheckedExpectationJson<'a> {
    fn new(checked: &'a CheckedExpectation, layout: &'a Layout) -> CheckedExpectationJson<'a> {
        let outcome = checked.outcome.as_ref().ok();
        let (at_mm, tile) = match outcome.and_then(|o| o.location) {
            Some(Location::Point(p)) => (Some(p.to_array()), None),
            Some(Location::Tile(tile)) => (None, Some(layout.tiles[tile].name.as_str())),
            _ => (None, None),
        };
        let percentile = match outcome.and_then(|o| o.location) {
            Some(Location::Percentile { per_cent, value, samples }) => {
                Some(PercentileJson { per_cent, value, samples })
            }
            _ => None,
        };
        CheckedExpectationJson {
            expectation: checked.expectation,
            status: word(checked.status()),
            error: checked.outcome.as_ref().err().map(String::as_str),
            value: outcome.map(|o| o.value),
            bound: outcome.map(|o| o.bound),
            margin: outcome.map(|o| o.margin()),
            at_mm,
            tile,
            percentile,
        }
    }
}

fn word(status: CheckStatus) -> &'static str {
    match status {
        CheckStatus::Ok => "ok",
        CheckStatus::Finding => "failed",
        CheckStatus::Unusable => "error",
    }
}

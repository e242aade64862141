//! What `check` found, as one JSON object.

use magsplice::expect::{Bound, Location};
use magsplice::layout::Layout;
use serde::Serialize;

use super::{Checked, Line, Status};
use crate::text;

pub(super) fn of(all: &[Checked]) -> String {
    let layouts = all.iter().map(layout).collect();
    text::json(&Report { version: env!("CARGO_PKG_VERSION"), layouts })
}

#[derive(Serialize)]
struct Report<'a> {
    version: &'static str,
    layouts: Vec<LayoutReport<'a>>,
}

#[derive(Serialize)]
struct LayoutReport<'a> {
    file: String,
    status: &'static str,
    /// Why it cannot be used; null if it can.
    error: Option<&'a str>,
    layout: Option<&'a str>,
    sha256: Option<&'a str>,
    tiles: Option<usize>,
    findings: &'a [String],
    expectations: Vec<ExpectationReport<'a>>,
}

#[derive(Serialize)]
struct ExpectationReport<'a> {
    expectation: String,
    status: &'static str,
    /// Why it cannot be evaluated; null if it can, and then the rest is not.
    error: Option<&'a str>,
    value: Option<f64>,
    /// Upper bound, for expectations that have one.
    #[serde(skip_serializing_if = "Option::is_none")]
    at_most: Option<f64>,
    /// Lower bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    at_least: Option<f64>,
    margin: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    at_mm: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tile: Option<&'a str>,
}

fn word(status: Status) -> &'static str {
    match status {
        Status::Fine => "ok",
        Status::Finding => "failed",
        Status::Unusable => "error",
    }
}

fn layout(checked: &Checked) -> LayoutReport<'_> {
    let layout = checked.layout.as_ref();
    LayoutReport {
        file: checked.path.display().to_string(),
        status: word(checked.status()),
        error: layout.err().map(String::as_str),
        layout: layout.ok().map(|l| l.name.as_str()),
        sha256: layout.ok().map(|l| l.sha256.as_str()),
        tiles: layout.ok().map(|l| l.tiles.len()),
        findings: checked.findings(),
        expectations: layout.map_or(Vec::new(), |l| checked.lines.iter().map(|line| expectation(line, l)).collect()),
    }
}

fn expectation<'a>(line: &'a Line, layout: &'a Layout) -> ExpectationReport<'a> {
    let outcome = line.outcome.as_ref().ok();
    let (at_most, at_least) = match outcome.map(|o| o.bound) {
        None => (None, None),
        Some(Bound::AtMost(most)) => (Some(most), None),
        Some(Bound::AtLeast(least)) => (None, Some(least)),
    };
    let (at_mm, tile) = match outcome.and_then(|o| o.location) {
        Some(Location::Point(p)) => (Some(p.to_array()), None),
        Some(Location::Tile(tile)) => (None, Some(layout.tiles[tile].name.as_str())),
        _ => (None, None),
    };
    ExpectationReport {
        expectation: line.expectation.to_string(),
        status: word(line.status()),
        error: line.outcome.as_ref().err().map(String::as_str),
        value: outcome.map(|o| o.value),
        at_most,
        at_least,
        margin: outcome.map(|o| o.margin()),
        at_mm,
        tile,
    }
}

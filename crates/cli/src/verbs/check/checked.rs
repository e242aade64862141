//! Results of `check`: layouts with the outcomes of their expectations.

use std::path::Path;
use std::time::Duration;

use magsplice::RecoilEstimate;
use magsplice::layout::Layout;
use magsplice::results::{CheckStatus, CheckedExpectation};
use serde::Serialize;

/// The result of `check`.
#[derive(Serialize)]
pub(super) struct Check {
    pub(super) version: &'static str,
    pub(super) layouts: Vec<CheckedLayout>,
    pub(super) skipped: Vec<SkippedFile>,
}

/// A TOML file of a folder that is no layout.
#[derive(Serialize)]
pub(super) struct SkippedFile {
    pub(super) file: String,
    pub(super) reason: &'static str,
}

/// A layout file that was checked.
#[derive(Serialize)]
pub(super) struct CheckedLayout {
    pub(super) file: String,
    /// The worst status of the layout and its expectations.
    pub(super) status: CheckStatus,
    /// Why the layout cannot be used; null if it can.
    pub(super) error: Option<String>,
    pub(super) layout: Option<String>,
    sha256: Option<String>,
    pub(super) tiles: Option<usize>,
    pub(super) findings: Vec<String>,
    pub(super) expectations: Vec<CheckedExpectation>,
    /// What recoil changes, to first order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) recoil_estimates: Vec<RecoilEstimate>,
    /// How far the field moved from the earlier baseline, if the baseline was rewritten.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) moved: Option<String>,
    /// Time that reading and validating the file took.
    #[serde(skip)]
    pub(super) reading: Duration,
}

impl CheckedLayout {
    /// A layout without expectations, or why it cannot be used.
    pub(super) fn new(path: &Path, layout: &Result<Layout, String>, reading: Duration) -> CheckedLayout {
        let (layout, error) = match layout {
            Ok(layout) => (Some(layout), None),
            Err(error) => (None, Some(error.clone())),
        };
        let findings = layout.map_or(&[][..], |layout| &layout.findings);
        let status = match &error {
            Some(_) => CheckStatus::Unusable,
            None if findings.is_empty() => CheckStatus::Ok,
            None => CheckStatus::Finding,
        };
        CheckedLayout {
            file: path.display().to_string(),
            status,
            error,
            layout: layout.map(|layout| layout.name.clone()),
            sha256: layout.map(|layout| layout.sha256.clone()),
            tiles: layout.map(|layout| layout.tiles.len()),
            findings: findings.iter().map(ToString::to_string).collect(),
            expectations: Vec::new(),
            recoil_estimates: Vec::new(),
            moved: None,
            reading,
        }
    }

    /// The same layout with its expectations.
    pub(super) fn with_expectations(self, expectations: Vec<CheckedExpectation>) -> CheckedLayout {
        let status = expectations.iter().map(|expectation| expectation.status).fold(self.status, CheckStatus::max);
        CheckedLayout { status, expectations, ..self }
    }
}

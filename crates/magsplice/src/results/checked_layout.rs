//! Layout files that were checked, with the outcomes of their expectations.

use std::path::Path;
use std::time::Duration;

use magsplice_layout::Layout;
use serde::Serialize;

use super::check::{CheckStatus, CheckedExpectation};
use crate::film_recoil::RecoilEstimate;

/// The result of checks of layout files.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Check {
    /// Version of the library.
    pub version: &'static str,
    /// The layouts.
    pub layouts: Vec<CheckedLayout>,
    /// Files that are no layouts.
    pub skipped: Vec<SkippedFile>,
}

/// A TOML file of a folder that is no layout.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SkippedFile {
    /// Path of the file.
    pub file: String,
    /// Why it was skipped.
    pub reason: &'static str,
}

/// A layout file that was checked.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckedLayout {
    /// Path of the file.
    pub file: String,
    /// The worst status of the layout and its expectations.
    pub status: CheckStatus,
    /// Why the layout cannot be used; `None` if it can.
    pub error: Option<String>,
    /// Name of the layout.
    pub layout: Option<String>,
    /// SHA-256 of its text.
    pub sha256: Option<String>,
    /// Number of tiles.
    pub tiles: Option<usize>,
    /// Properties that are allowed but rarely intended.
    pub findings: Vec<String>,
    /// Outcomes of the expectations.
    pub expectations: Vec<CheckedExpectation>,
    /// What recoil changes, to first order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub recoil_estimates: Vec<RecoilEstimate>,
    /// How far the field moved from the earlier baseline, if the baseline was rewritten.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moved: Option<String>,
    /// Time that reading and validating the file took.
    #[serde(skip)]
    pub reading: Duration,
}

impl Check {
    /// A result to which layouts are added.
    pub fn new() -> Check {
        Check { version: env!("CARGO_PKG_VERSION"), ..Check::default() }
    }
}

impl CheckedLayout {
    /// A layout without expectations, or why it cannot be used.
    pub fn new(path: &Path, layout: &Result<Layout, String>, reading: Duration) -> CheckedLayout {
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
    pub fn with_expectations(self, expectations: Vec<CheckedExpectation>) -> CheckedLayout {
        let status = expectations.iter().map(|expectation| expectation.status).fold(self.status, CheckStatus::max);
        CheckedLayout { status, expectations, ..self }
    }
}

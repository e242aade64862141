//! Results of `check`: a layout with the outcome of each of its expectations.

use std::path::{Path, PathBuf};
use std::time::Duration;

use magsplice::RecoilEstimate;
use magsplice::expect::{Expectation, Outcome};
use magsplice::layout::{Finding, Layout};

/// A layout file that was checked.
pub(crate) struct CheckedLayout {
    pub(crate) path: PathBuf,
    /// The layout, or why it cannot be used.
    pub(crate) layout: Result<Layout, String>,
    pub(crate) expectations: Vec<CheckedExpectation>,
    /// What recoil changes in the figures of the film, to first order.
    pub(crate) recoil: Vec<RecoilEstimate>,
    /// How far the field moved from the earlier baseline, in words, if the baseline was rewritten.
    pub(crate) moved: Option<String>,
    /// Time that reading and validating the file took.
    pub(crate) reading: Duration,
}

/// An expectation that was checked.
pub(crate) struct CheckedExpectation {
    pub(crate) expectation: Expectation,
    /// The outcome, or why the expectation cannot be evaluated.
    pub(crate) outcome: Result<Outcome, String>,
    /// Time that the evaluation took. The first expectation that needs the field bears its time.
    pub(crate) took: Duration,
}

/// Status of an expectation, a layout or the whole run, from best to worst. The numbers are exit
/// statuses.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum CheckStatus {
    Ok = 0,
    /// An expectation is not met, or the layout has something that is allowed but rarely intended.
    Finding = 1,
    /// The layout cannot be used, or an expectation cannot be evaluated.
    Unusable = 2,
}

impl CheckedExpectation {
    pub(crate) fn status(&self) -> CheckStatus {
        match &self.outcome {
            Ok(outcome) if outcome.is_met() => CheckStatus::Ok,
            Ok(_) => CheckStatus::Finding,
            Err(_) => CheckStatus::Unusable,
        }
    }
}

impl CheckedLayout {
    /// A file or a folder that cannot be checked.
    pub(crate) fn refused(path: &Path, message: &str) -> CheckedLayout {
        let layout = Err(format!("{}: {message}", path.display()));
        CheckedLayout {
            path: path.to_owned(),
            layout,
            expectations: Vec::new(),
            recoil: Vec::new(),
            moved: None,
            reading: Duration::ZERO,
        }
    }

    /// The worst status of the layout and its expectations.
    pub(crate) fn status(&self) -> CheckStatus {
        let own = match &self.layout {
            Ok(layout) if layout.findings.is_empty() => CheckStatus::Ok,
            Ok(_) => CheckStatus::Finding,
            Err(_) => CheckStatus::Unusable,
        };
        self.expectations.iter().map(CheckedExpectation::status).fold(own, CheckStatus::max)
    }

    pub(crate) fn findings(&self) -> &[Finding] {
        self.layout.as_ref().map_or(&[], |layout| &layout.findings)
    }
}

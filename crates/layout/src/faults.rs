//! The list of broken rules, each with its line and place in the file, and rules for numbers.

use std::fmt::Display;

use magsplice_magnet::MAX_LENGTH;

use crate::error::LayoutFault;
use crate::finding::{Finding, FindingSubject};
use crate::limits::{MAX_LISTED, SAMPLE_COUNTS};

/// Largest magnitude of a number that is no length. Products of three such numbers are finite.
const LARGEST_NUMBER: f64 = 1e100;

/// The broken rules found so far in one file: the first [`MAX_LISTED`], and the number of the
/// others. Beside them the findings about what is allowed.
pub(crate) struct Faults<'t> {
    text: &'t str,
    listed: Vec<LayoutFault>,
    count: usize,
    pub(crate) findings: Vec<Finding>,
}

impl<'t> Faults<'t> {
    /// An empty list for the file with this text.
    pub(crate) fn new(text: &'t str) -> Faults<'t> {
        Faults { text, listed: Vec::new(), count: 0, findings: Vec::new() }
    }

    /// The list for faults of one table, which begins at `start` in the text and is called `place`.
    pub(crate) fn at(&mut self, start: usize, place: impl Into<String>) -> TableFaults<'_, 't> {
        TableFaults { start: Some(start), place: place.into(), list: self }
    }

    /// Adds a fault of the layout as a whole, which has no line.
    pub(crate) fn add_to_layout(&mut self, message: impl Into<String>) {
        TableFaults { start: None, place: "layout".to_owned(), list: self }.add(message);
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Number of faults so far. A caller compares it before and after a check.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// All listed faults in the order of the file, those without a line first, and the number of
    /// the others last.
    pub(crate) fn into_sorted(self) -> Vec<LayoutFault> {
        let mut faults = self.listed;
        faults.sort_by_key(|fault| fault.line);
        let others = self.count - faults.len();
        if others > 0 {
            let message = format!("and {others} more");
            faults.push(LayoutFault { line: None, place: "layout".to_owned(), message });
        }
        faults
    }
}

/// The faults of one table.
pub(crate) struct TableFaults<'f, 't> {
    start: Option<usize>,
    place: String,
    list: &'f mut Faults<'t>,
}

impl TableFaults<'_, '_> {
    /// Adds a fault: the value, then the rule.
    pub(crate) fn add(&mut self, message: impl Into<String>) {
        self.list.count += 1;
        if self.list.count <= MAX_LISTED {
            let line = self.start.map(|start| self.list.text[..start].matches('\n').count() + 1);
            self.list.listed.push(LayoutFault { line, place: self.place.clone(), message: message.into() });
        }
    }

    /// Adds a fault without which there would be a value.
    pub(crate) fn refuse<T>(&mut self, message: impl Into<String>) -> Option<T> {
        self.add(message);
        None
    }

    /// Adds a finding.
    pub(crate) fn remark(&mut self, subject: FindingSubject, message: impl Into<String>) {
        self.list.findings.push(Finding::new(subject, message));
    }

    /// The table in words, such as `tolerance.film`.
    pub(crate) fn place(&self) -> &str {
        &self.place
    }

    /// Adds a fault unless a rule about the value of a key is kept.
    pub(crate) fn require(&mut self, is_kept: bool, key: impl Display, value: impl Display, rule: impl Display) {
        if !is_kept {
            self.add(format!("{key} = {value}, {rule}"));
        }
    }

    /// Adds a fault unless a rule about the number of a key is kept, or the key is not given.
    pub(crate) fn number(&mut self, key: impl Display, value: impl Into<Option<f64>>, rule: Rule) {
        match value.into() {
            None => {}
            Some(value) if value.is_finite() && value.abs() > LARGEST_NUMBER => {
                let words = format_args!("must be at most {LARGEST_NUMBER:e} in magnitude");
                self.require(false, key, format_args!("{value:e}"), words);
            }
            Some(value) => self.require((rule.is_kept)(value), key, value, rule.words),
        }
    }

    /// Checks each number of a list.
    pub(crate) fn numbers(&mut self, key: impl Display, values: &[f64], rule: Rule) {
        for (index, value) in values.iter().enumerate() {
            self.number(format_args!("{key}[{index}]"), *value, rule);
        }
    }

    /// Requires the coordinates of a point, if it is given.
    pub(crate) fn point(&mut self, key: impl Display, point: impl Into<Option<[f64; 3]>>) {
        if let Some(point) = point.into() {
            let is_kept = point.iter().all(|c| c.abs() <= MAX_LENGTH);
            self.require(is_kept, key, format_args!("{point:?}"), "must be three finite numbers");
        }
    }

    /// The one of these forms that a value gives, or `None` after adding a fault.
    pub(crate) fn only_one<'k>(&mut self, key: &str, forms: &[(&'k str, bool)]) -> Option<&'k str> {
        let given: Vec<&str> = forms.iter().filter(|(_, is_given)| *is_given).map(|(form, _)| *form).collect();
        let [only] = given[..] else {
            let found = if given.is_empty() { "nothing".to_owned() } else { given.join(", ") };
            let all: Vec<&str> = forms.iter().map(|(form, _)| *form).collect();
            self.add(format!("{key} gives {found}, must give one of: {}", all.join("; ")));
            return None;
        };
        Some(only)
    }

    /// Requires a number of samples that can be evaluated, if it is given.
    pub(crate) fn sample_count(&mut self, samples: Option<u64>) {
        let Some(samples) = samples else { return };
        let rule = format_args!("must be from {} to {}", SAMPLE_COUNTS.start(), SAMPLE_COUNTS.end());
        self.require(SAMPLE_COUNTS.contains(&samples), "samples", samples, rule);
    }

    /// Number of faults in the whole file so far. A caller compares it before and after a check.
    pub(crate) fn count(&self) -> usize {
        self.list.count
    }
}

/// A rule about the number of a key.
#[derive(Clone, Copy)]
pub(crate) struct Rule {
    pub(crate) is_kept: fn(f64) -> bool,
    pub(crate) words: &'static str,
}

pub(crate) const POSITIVE: Rule =
    Rule { is_kept: |value| value.is_finite() && value > 0.0, words: "must be a finite number greater than 0" };
pub(crate) const NOT_NEGATIVE: Rule =
    Rule { is_kept: |value| value.is_finite() && value >= 0.0, words: "must be a finite number of at least 0" };
pub(crate) const FINITE: Rule = Rule { is_kept: f64::is_finite, words: "must be a finite number" };

//! The list of broken rules, each with its line and place in the file.

use std::ops::Range;

use crate::error::LayoutFault;

/// Every broken rule found so far in one file.
pub(crate) struct Faults<'t> {
    text: &'t str,
    found: Vec<LayoutFault>,
}

impl<'t> Faults<'t> {
    /// An empty list for the file with this text.
    pub(crate) fn new(text: &'t str) -> Faults<'t> {
        Faults { text, found: Vec::new() }
    }

    /// The list for faults of one table, which stands at `span` of the text and is called `place`.
    pub(crate) fn at(&mut self, span: &Range<usize>, place: impl Into<String>) -> TableFaults<'_> {
        TableFaults { text: self.text, start: span.start, place: place.into(), found: &mut self.found }
    }

    /// Adds a fault of the layout as a whole, which has no line.
    pub(crate) fn add_to_layout(&mut self, message: impl Into<String>) {
        self.found.push(LayoutFault { line: None, place: "layout".to_owned(), message: message.into() });
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    /// All faults in the order of the file, those without a line first.
    pub(crate) fn into_sorted(mut self) -> Vec<LayoutFault> {
        self.found.sort_by_key(|fault| fault.line);
        self.found
    }
}

/// The faults of one table.
pub(crate) struct TableFaults<'f> {
    text: &'f str,
    start: usize,
    place: String,
    found: &'f mut Vec<LayoutFault>,
}

impl TableFaults<'_> {
    /// Adds a fault: the value, then the rule.
    pub(crate) fn add(&mut self, message: impl Into<String>) {
        let line = self.text[..self.start].matches('\n').count() + 1;
        self.found.push(LayoutFault { line: Some(line), place: self.place.clone(), message: message.into() });
    }

    /// Number of faults in the whole file so far. A caller compares it before and after a check.
    pub(crate) fn count(&self) -> usize {
        self.found.len()
    }
}

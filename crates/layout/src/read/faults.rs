//! The list of broken rules, each with its line and place in the file.

use std::ops::Range;

use crate::error::LayoutFault;
use crate::limits::MAX_LISTED;

/// The broken rules found so far in one file: the first [`MAX_LISTED`], and the number of the
/// others.
pub(crate) struct Faults<'t> {
    text: &'t str,
    list: FaultList,
}

#[derive(Default)]
struct FaultList {
    listed: Vec<LayoutFault>,
    count: usize,
}

impl FaultList {
    /// Adds a fault. It is built only if it is listed.
    fn add(&mut self, fault: impl FnOnce() -> LayoutFault) {
        if self.count < MAX_LISTED {
            self.listed.push(fault());
        }
        self.count += 1;
    }
}

impl<'t> Faults<'t> {
    /// An empty list for the file with this text.
    pub(crate) fn new(text: &'t str) -> Faults<'t> {
        Faults { text, list: FaultList::default() }
    }

    /// The list for faults of one table, which stands at `span` of the text and is called `place`.
    pub(crate) fn at(&mut self, span: &Range<usize>, place: impl Into<String>) -> TableFaults<'_> {
        TableFaults { text: self.text, start: span.start, place: place.into(), list: &mut self.list }
    }

    /// Adds a fault of the layout as a whole, which has no line.
    pub(crate) fn add_to_layout(&mut self, message: impl Into<String>) {
        self.list.add(|| LayoutFault { line: None, place: "layout".to_owned(), message: message.into() });
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.list.count == 0
    }

    /// Number of faults so far. A caller compares it before and after a check.
    pub(crate) fn count(&self) -> usize {
        self.list.count
    }

    /// All listed faults in the order of the file, those without a line first, and the number of
    /// the others last.
    pub(crate) fn into_sorted(self) -> Vec<LayoutFault> {
        let mut faults = self.list.listed;
        faults.sort_by_key(|fault| fault.line);
        let others = self.list.count - faults.len();
        if others > 0 {
            let message = format!("and {others} more");
            faults.push(LayoutFault { line: None, place: "layout".to_owned(), message });
        }
        faults
    }
}

/// The faults of one table.
pub(crate) struct TableFaults<'f> {
    text: &'f str,
    start: usize,
    place: String,
    list: &'f mut FaultList,
}

impl TableFaults<'_> {
    /// Adds a fault: the value, then the rule.
    pub(crate) fn add(&mut self, message: impl Into<String>) {
        let (text, start, place) = (self.text, self.start, &self.place);
        self.list.add(|| {
            let line = text[..start].matches('\n').count() + 1;
            LayoutFault { line: Some(line), place: place.clone(), message: message.into() }
        });
    }

    /// Number of faults in the whole file so far. A caller compares it before and after a check.
    pub(crate) fn count(&self) -> usize {
        self.list.count
    }
}

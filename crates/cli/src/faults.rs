//! Lists of faulty lines and points.

use std::fmt;

use crate::failure::{Failure, PRINTED_FAULTS};

/// Faults to print: the first few with their messages, the rest as a number.
#[derive(Default)]
pub(crate) struct FaultList {
    named: Vec<(u64, String)>,
    more: usize,
}

impl FaultList {
    /// Adds a fault and the number of its line; 0 where there are no lines.
    pub(crate) fn add(&mut self, line: u64, fault: String) {
        if self.named.len() < PRINTED_FAULTS {
            self.named.push((line, fault));
        } else {
            self.more += 1;
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.named.is_empty()
    }

    /// The faults of a place as lines, in the order of their lines in the file.
    pub(crate) fn remarks(mut self, place: impl fmt::Display) -> String {
        self.named.sort_by_key(|(line, _)| *line);
        let named = self.named.into_iter().map(|(_, fault)| format!("{place}: {fault}"));
        let more = (self.more > 0).then(|| format!("{place}: and {} more", self.more));
        named.chain(more).collect::<Vec<_>>().join("\n")
    }

    /// The same as the reason why the program stops.
    pub(crate) fn failure(self, place: impl fmt::Display) -> Failure {
        Failure::Refused(self.remarks(place))
    }
}

//! Lists of faulty lines and points.

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

    /// The faults as remarks about a place, in the order of their lines.
    pub(crate) fn remarks(self, place: &str) -> String {
        self.failure(place.to_owned()).to_string()
    }

    /// The faults as the reason why the program stops, in the order of their lines.
    pub(crate) fn failure(mut self, place: String) -> Failure {
        self.named.sort_by_key(|(line, _)| *line);
        Failure::Faults { place, faults: self.named.into_iter().map(|(_, fault)| fault).collect(), more: self.more }
    }
}

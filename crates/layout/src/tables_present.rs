//! The rule that `[expect]` and `[design]` come with the tables they need.

use crate::faults::TableFaults;

/// Which of the tables that others need a file has.
#[derive(Clone, Copy)]
pub(crate) struct TablesPresent {
    pub(crate) ideal: bool,
    pub(crate) volume: bool,
    pub(crate) tolerance: bool,
    pub(crate) plane: bool,
}

impl TablesPresent {
    /// Requires `[volume]`, and `[ideal]` if `needs_ideal`. `subject` begins the message: a key and
    /// a space, or nothing where the whole table needs them.
    pub(crate) fn check(self, subject: &str, needs_ideal: bool, faults: &mut TableFaults) {
        for (table, missing) in [("[ideal]", needs_ideal && !self.ideal), ("[volume]", !self.volume)] {
            if missing {
                faults.add(format!("{subject}needs the table {table}, which the layout does not have"));
            }
        }
    }

    /// Requires `[tolerance]`, `[ideal]` and `[volume]`.
    pub(crate) fn check_for_made_films(self, faults: &mut TableFaults) {
        if !self.tolerance {
            faults.add("needs the table [tolerance], which the layout does not have");
        }
        self.check("", true, faults);
    }
}

//! Findings: properties of a layout that are allowed but usually a mistake.

use std::fmt;

use crate::limits::MAX_LISTED;

/// A property of a layout that is allowed but usually a mistake, such as a tile without
/// polarization.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The part of the layout that the finding is about.
    pub subject: FindingSubject,
    /// A sentence for the author, in the units of the file.
    pub message: String,
}

/// The part of a layout that a finding is about. A program that does not use this part need not
/// report the finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FindingSubject {
    /// The tiles and their kinds.
    Tiles,
    /// The working volume, by itself and beside the tiles.
    Volume,
    /// The ideal film, by itself and beside the tiles and the volume.
    IdealFilm,
    /// The expectations.
    Expectations,
    /// The design brief.
    Design,
    /// The errors of films as made.
    Tolerance,
}

impl Finding {
    pub(crate) fn new(subject: FindingSubject, message: impl Into<String>) -> Finding {
        Finding { subject, message: message.into() }
    }
}

impl fmt::Display for Finding {
    /// Writes the sentence.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// One finding for each item: the first [`MAX_LISTED`] by name, the others as one count.
pub(crate) fn listed<T>(
    mut items: impl Iterator<Item = T>,
    subject: FindingSubject,
    finding: impl Fn(T) -> String,
    sort: &str,
) -> Vec<Finding> {
    let mut found: Vec<String> = items.by_ref().take(MAX_LISTED).map(&finding).collect();
    if let Some(next) = items.next() {
        found.push(format!("{} more {sort}, such as: {}", 1 + items.count(), finding(next)));
    }
    found.into_iter().map(|message| Finding::new(subject, message)).collect()
}

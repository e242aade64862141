//! Findings: properties of a layout that are allowed but usually a mistake.

use std::fmt;

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
    /// The errors of films that are made.
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

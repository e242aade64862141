//! Reasons why the program stops, and how it tells them.

use std::fmt;
use std::io::{self, Write};
use std::path::Path;

use magsplice::design::DesignError;
use magsplice::layout::{LayoutError, rearranges_text};

/// Largest number of faults of one kind that are printed; the rest are counted.
pub(crate) const PRINTED_FAULTS: usize = 20;

/// Prints a message on standard error.
pub(crate) fn tell(message: &impl fmt::Display) {
    print_escaped(&format_args!("magsplice: {message}\n"));
}

/// Prints a text on standard error: a message, or a summary while the result is on standard output.
/// A closed standard error is ignored: there is nobody to tell.
///
/// A text may cite a path or a file, so characters that a terminal would obey are escaped.
pub(crate) fn print_escaped(text: &impl fmt::Display) {
    let _ = io::stderr().write_all(escaped(text).as_bytes());
}

/// The text with escapes in place of control characters and of marks of direction, but for ends of
/// lines and tabs.
pub(crate) fn escaped(message: &impl fmt::Display) -> String {
    let mut text = String::new();
    for c in message.to_string().chars() {
        if rearranges_text(c) && !matches!(c, '\n' | '\t') {
            text.extend(c.escape_default());
        } else {
            text.push(c);
        }
    }
    text
}

/// Why the program stops.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The work cannot be done. The text has the place of each fault.
    Refused(String),
    /// Writing failed.
    Write { target: String, error: io::Error },
    /// The reader of standard output closed it.
    PipeClosed,
}

impl Failure {
    /// Faults in a file.
    pub(crate) fn at(path: &Path, message: impl fmt::Display) -> Failure {
        Failure::Refused(format!("{}: {message}", path.display()))
    }

    /// A file that cannot be written.
    pub(crate) fn write(path: &Path, error: io::Error) -> Failure {
        Failure::Write { target: path.display().to_string(), error }
    }

    /// There is no film to design. `place` is the layout file or the verb.
    pub(crate) fn design(place: &Path, error: DesignError) -> Failure {
        let DesignError::Request(problems) = error else { return Failure::at(place, error) };
        let lines: Vec<String> = problems.iter().map(|problem| format!("{}: {problem}", place.display())).collect();
        Failure::Refused(lines.join("\n"))
    }
}

impl From<LayoutError> for Failure {
    fn from(error: LayoutError) -> Failure {
        Failure::Refused(error.to_string())
    }
}

#[cfg(feature = "report")]
impl From<magsplice_report::ReportError> for Failure {
    fn from(error: magsplice_report::ReportError) -> Failure {
        Failure::Refused(error.to_string())
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Refused(message) => f.write_str(message),
            Failure::Write { target, error } => write!(f, "cannot write {target}: {error}"),
            Failure::PipeClosed => f.write_str("the reader of standard output closed it"),
        }
    }
}

//! What can be wrong with a layout file.

use std::fmt;
use std::io;
use std::path::PathBuf;

/// Why a layout could not be used. Messages speak the units and names of the file.
#[derive(Debug)]
pub enum LayoutError {
    /// The file could not be read.
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// The text is not TOML, a key is unknown or missing, or a value has the wrong type.
    Syntax {
        /// Where the text came from.
        origin: String,
        /// The error with line, column and excerpt.
        message: String,
    },
    /// The text is well-formed, but what it says breaks rules. All of them at once.
    Invalid {
        /// Where the text came from.
        origin: String,
        /// Every problem, in the order of the file.
        problems: Vec<Problem>,
    },
}

/// One broken rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The line it is on, where there is one.
    pub line: Option<usize>,
    /// What it concerns, e.g. `tile "rim-3"`.
    pub place: String,
    /// Value and rule, e.g. `size_mm[1] = -1, must be greater than 0`.
    pub message: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            write!(f, "line {line}: ")?;
        }
        write!(f, "{}: {}", self.place, self.message)
    }
}

impl fmt::Display for LayoutError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LayoutError::Read { path, error } => write!(f, "cannot read {}: {error}", path.display()),
            LayoutError::Syntax { origin, message } => write!(f, "{origin}: {}", message.trim_end()),
            LayoutError::Invalid { origin, problems } => {
                for (i, problem) in problems.iter().enumerate() {
                    let separator = if i == 0 { "" } else { "\n" };
                    write!(f, "{separator}{origin}: {problem}")?;
                }
                Ok(())
            }
        }
    }
}

impl std::error::Error for LayoutError {}

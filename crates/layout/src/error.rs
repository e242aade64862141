//! Errors of reading a layout: an unreadable file, broken syntax, or broken rules.

use std::error::Error;
use std::fmt;
use std::io;
use std::path::PathBuf;

/// Why a layout could not be read. Messages use the names and units of the file.
#[derive(Debug)]
#[non_exhaustive]
pub enum LayoutError {
    /// The file could not be read.
    Read {
        /// Path of the file.
        path: PathBuf,
        /// The error of the operating system.
        error: io::Error,
    },
    /// The text is not TOML, a key is unknown or missing, or a value has the wrong type.
    Syntax {
        /// Path or other origin of the text.
        origin: String,
        /// The error with line, column and excerpt.
        message: String,
    },
    /// The text is well-formed TOML, but its values break rules.
    Invalid {
        /// Path or other origin of the text.
        origin: String,
        /// Every broken rule, in the order of the file.
        faults: Vec<LayoutFault>,
    },
}

/// One broken rule.
#[derive(Clone, Debug, PartialEq)]
pub struct LayoutFault {
    /// Line of the table that breaks the rule, if one does. The first line is 1.
    pub line: Option<usize>,
    /// The table or tile, for example `tile "rim-3"`.
    pub place: String,
    /// The value, then the rule: `size_mm[1] = -1, must be greater than 0`.
    pub message: String,
}

impl fmt::Display for LayoutFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            write!(f, "line {line}: ")?;
        }
        write!(f, "{}: {}", self.place, self.message)
    }
}

impl Error for LayoutFault {}

impl fmt::Display for LayoutError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LayoutError::Read { path, error } => write!(f, "cannot read {}: {error}", path.display()),
            LayoutError::Syntax { origin, message } => write!(f, "{origin}: {}", message.trim_end()),
            LayoutError::Invalid { origin, faults } => {
                for (i, fault) in faults.iter().enumerate() {
                    let separator = if i == 0 { "" } else { "\n" };
                    write!(f, "{separator}{origin}: {fault}")?;
                }
                Ok(())
            }
        }
    }
}

impl Error for LayoutError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            LayoutError::Read { error, .. } => Some(error),
            // The faults are equals; none of them is the cause of the others.
            LayoutError::Syntax { .. } | LayoutError::Invalid { .. } => None,
        }
    }
}

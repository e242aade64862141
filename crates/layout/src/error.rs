//! Errors of reading a layout: an unreadable file, broken syntax, or broken rules.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

/// Why a layout could not be read. Messages use the names and units of the file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LayoutError {
    /// The file could not be read.
    #[error("cannot read {path}: {error}")]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// The error of the operating system.
        #[source]
        error: io::Error,
    },
    /// The text is not TOML, a key is unknown or missing, or a value has the wrong type.
    #[error("{origin}: {}", message.trim_end())]
    Syntax {
        /// Path or other origin of the text.
        origin: String,
        /// The error with line, column and excerpt.
        message: String,
    },
    /// The text is well-formed TOML, but its values break rules.
    #[error("{}", faults.iter().map(|fault| format!("{origin}: {fault}")).collect::<Vec<_>>().join("\n"))]
    Invalid {
        /// Path or other origin of the text.
        origin: String,
        /// Every broken rule, in the order of the file.
        faults: Vec<LayoutFault>,
    },
}

/// One broken rule.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{}{place}: {message}", line.map_or(String::new(), |line| format!("line {line}: ")))]
pub struct LayoutFault {
    /// Line of the table that breaks the rule, if one does. The first line is 1.
    pub line: Option<usize>,
    /// The table or tile, for example `tile "rim-3"`.
    pub place: String,
    /// The value, then the rule: `size_mm[1] = -1, must be greater than 0`.
    pub message: String,
}

//! Why the program could not do its work, in words for the person at the terminal.

use std::fmt;
use std::io::{self, Write};
use std::path::PathBuf;

use magsplice::FilmError;
use magsplice::design::DesignError;
use magsplice::layout::LayoutError;

/// At most this many faults of one kind are printed; the rest are counted.
pub(crate) const PRINTED_FAULTS: usize = 20;

/// Says something on standard error; if that is closed there is nobody to tell.
pub(crate) fn tell(what: &impl fmt::Display) {
    let _ = writeln!(io::stderr(), "magsplice: {what}");
}

#[derive(Debug)]
pub(crate) enum Failure {
    Layout(LayoutError),
    Film {
        layout: PathBuf,
        error: FilmError,
    },
    Design {
        place: String,
        error: DesignError,
    },
    Points {
        path: PathBuf,
        message: String,
    },
    #[cfg(feature = "report")]
    Report {
        layout: PathBuf,
        message: String,
    },
    /// Lines of a point file, or points, that have no field.
    Faults {
        place: String,
        faults: Vec<String>,
        more: usize,
    },
    /// What was asked for cannot be written so.
    Format(String),
    Write {
        target: String,
        error: io::Error,
    },
    PipeClosed,
}

impl From<LayoutError> for Failure {
    fn from(error: LayoutError) -> Failure {
        Failure::Layout(error)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Layout(error) => error.fmt(f),
            Failure::Film { layout, error } => write!(f, "{}: {error}", layout.display()),
            Failure::Design { place, error } => write!(f, "{place}: {error}"),
            #[cfg(feature = "report")]
            Failure::Report { layout, message } => write!(f, "{}: {message}", layout.display()),
            Failure::Points { path, message } => write!(f, "{}: {message}", path.display()),
            Failure::Faults { place, faults, more } => {
                for (i, fault) in faults.iter().enumerate() {
                    let separator = if i == 0 { "" } else { "\n" };
                    write!(f, "{separator}{place}: {fault}")?;
                }
                if *more > 0 {
                    write!(f, "\n{place}: and {more} more")?;
                }
                Ok(())
            }
            Failure::Format(message) => f.write_str(message),
            Failure::Write { target, error } => write!(f, "cannot write {target}: {error}"),
            Failure::PipeClosed => f.write_str("the reader of the output closed it"),
        }
    }
}

//! Errors: why a report, or one of its figures, cannot be made.

use std::error::Error;
use std::fmt;

use magsplice::FilmError;

/// Why one figure cannot be drawn: an error of plotters, resvg or the PNG encoder.
pub(crate) type DrawError = Box<dyn Error + Send + Sync>;

/// Why a report, or one of its figures, cannot be made.
#[derive(Debug)]
#[non_exhaustive]
pub enum ReportError {
    /// The film cannot be evaluated over its working volume.
    Film(FilmError),
    /// A figure cannot be drawn.
    Drawing {
        /// Name of the figure, as in [`Drawing::name`](crate::Drawing::name).
        figure: &'static str,
        /// The reason.
        source: Box<dyn Error + Send + Sync>,
    },
}

impl fmt::Display for ReportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ReportError::Film(error) => error.fmt(f),
            ReportError::Drawing { figure, source } => {
                write!(f, "the figure {figure} cannot be drawn: {source}")
            }
        }
    }
}

impl Error for ReportError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            ReportError::Film(error) => Some(error),
            ReportError::Drawing { source, .. } => Some(source.as_ref()),
        }
    }
}

impl From<FilmError> for ReportError {
    fn from(error: FilmError) -> ReportError {
        ReportError::Film(error)
    }
}

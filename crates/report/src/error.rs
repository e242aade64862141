//! Errors: why a report, or one of its figures, cannot be made.

use magsplice::FilmError;
use thiserror::Error;

/// Why one figure cannot be drawn: an error of plotters, resvg or the PNG encoder.
pub(crate) type DrawError = Box<dyn std::error::Error + Send + Sync>;

/// Why a report, or one of its figures, cannot be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The film cannot be evaluated over its working volume.
    #[error("{0}")]
    Film(#[from] FilmError),
    /// A figure cannot be drawn.
    #[error("the figure {figure} cannot be drawn: {source}")]
    Drawing {
        /// Name of the figure, as in [`Drawing::name`](crate::Drawing::name).
        figure: &'static str,
        /// The reason.
        source: DrawError,
    },
}

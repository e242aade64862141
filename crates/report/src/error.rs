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
    /// The report has no such figure.
    #[error("there is no figure {name}: the figures of this film are {names}")]
    NoFigure {
        /// The name.
        name: String,
        /// The names of all figures.
        names: String,
    },
    /// The figure does not consist of maps of components.
    #[error("the figure {figure} has no maps of components, of which one could be chosen")]
    NoComponents {
        /// Name of the figure.
        figure: &'static str,
    },
    /// The text of the figure would not be readable, or too large.
    #[error("the figure {figure} has no text of 7 to 9 pt at a width of {width_mm} mm: choose {instead}")]
    Width {
        /// Name of the figure.
        figure: &'static str,
        /// The width in millimetres.
        width_mm: f64,
        /// Widths that are possible, with their unit.
        instead: String,
    },
}

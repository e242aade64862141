//! Why a scan cannot be fitted.

use magsplice_magnet::PointErrors;
use thiserror::Error;

use crate::parameters::ScanParameter;

/// Why a scan cannot be fitted.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum ScanError {
    /// There are too few readings for the parameters.
    #[error("too few readings for the parameters: {readings}, must be at least {needed}")]
    TooFew {
        /// Number of readings.
        readings: usize,
        /// Fewest that are needed.
        needed: usize,
    },
    /// The scan does not tell these parameters apart, or has no information about them.
    #[error(
        "the scan does not determine {}: fit fewer parameters",
        .0.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
    )]
    Undetermined(Vec<ScanParameter>),
    /// The film has no field at the points of the scan.
    #[error("the scan does not determine every parameter: the film has no field there: fit fewer parameters")]
    NoField,
    /// More readings than can be outliers are far from every fit.
    #[error(
        "readings farther from the fit than noise allows: {outliers}; the scan is of another film, or its positions \
         are off by more than a quarter of a wavelength"
    )]
    AnotherFilm {
        /// Number of readings far from the fit.
        outliers: usize,
    },
    /// The steps did not converge.
    #[error("the fit does not converge: the positions may be off by more than a quarter of a wavelength")]
    NoConvergence,
    /// Points without a field.
    #[error("points of the scan have no field: {0}")]
    Points(PointErrors),
}

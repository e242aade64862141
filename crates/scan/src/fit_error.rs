//! The reason why a scan cannot be fitted.

use magsplice_magnet::PointErrors;
use thiserror::Error;

use crate::parameters::ScanParameter;

/// The reason why a scan cannot be fitted.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum ScanError {
    /// There are too few readings for the parameters.
    #[error("too few readings for the parameters: {readings}, must be at least {needed}")]
    TooFew {
        /// Number of readings.
        readings: usize,
        /// Smallest sufficient number of readings.
        needed: usize,
    },
    /// The scan does not separate these parameters, or has no information about them.
    #[error(
        "the scan does not determine {}: fit fewer parameters",
        .0.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
    )]
    Undetermined(Vec<ScanParameter>),
    /// The film has no field at the points of the scan.
    #[error("the film has no field at the points of the scan, so parameters are undetermined: fit fewer parameters")]
    NoField,
    /// The number of readings far from every fit exceeds the limit of outliers.
    #[error(
        "readings farther from the fit than the noise allows: {outliers}; the scan belongs to another film, or its positions \
         have errors of more than a quarter of a wavelength"
    )]
    AnotherFilm {
        /// Number of readings far from the fit.
        outliers: usize,
    },
    /// The steps did not converge.
    #[error("the fit does not converge: the positions may have errors of more than a quarter of a wavelength")]
    NoConvergence,
    /// Points without a field.
    #[error("points of the scan have no field: {0}")]
    Points(PointErrors),
}

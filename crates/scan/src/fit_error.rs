//! Why a scan cannot be fitted.

use std::error::Error;
use std::fmt;

use magsplice_magnet::PointErrors;

/// Why a scan cannot be fitted.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ScanError {
    /// There are too few readings for the parameters.
    TooFew {
        /// Number of readings.
        readings: usize,
        /// Fewest that are needed.
        needed: usize,
    },
    /// The scan does not tell these parameters apart, or has no information about them.
    Undetermined(Vec<&'static str>),
    /// More readings than can be outliers are far from every fit.
    AnotherFilm {
        /// Number of readings far from the fit.
        outliers: usize,
    },
    /// The steps did not converge.
    NoConvergence,
    /// Points without a field.
    Points(PointErrors),
}

impl fmt::Display for ScanError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            ScanError::TooFew { readings, needed } => {
                write!(f, "too few readings for the parameters: {readings}, must be at least {needed}")
            }
            ScanError::Undetermined(names) => {
                write!(f, "the scan does not determine {}: fit fewer parameters", names.join(", "))
            }
            ScanError::AnotherFilm { outliers } => write!(
                f,
                "readings farther from the fit than noise allows: {outliers}; the scan is of another film, or its \
                 positions are off by more than a quarter of a wavelength"
            ),
            ScanError::NoConvergence => {
                write!(f, "the fit does not converge: the positions may be off by more than a quarter of a wavelength")
            }
            ScanError::Points(errors) => write!(f, "points of the scan have no field: {errors}"),
        }
    }
}

impl Error for ScanError {}

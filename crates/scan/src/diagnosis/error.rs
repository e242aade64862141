//! The reason why a scan cannot be diagnosed.

use glam::DVec3;
use magsplice_magnet::{PointErrors, TileFaults};
use magsplice_tolerance::SampleError;
use thiserror::Error;

/// Least noise in tesla, far below every sensor. The squares of readings over a smaller one
/// overflow.
pub(crate) const LEAST_NOISE_T: f64 = 1e-30;

/// The reason why a scan cannot be diagnosed.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum DiagnosisError {
    /// The field does not exist at points of the scan, such as points on an edge of a tile.
    #[error("no field at a point of the scan: {0}")]
    Points(#[source] PointErrors),
    /// The derivatives of the field of a tile do not exist at a point of the scan.
    #[error(
        "the field of tile {tile} has no derivatives at ({}, {}, {}), must be away from its edges and faces",
        point.x, point.y, point.z
    )]
    NoDerivative {
        /// Index of the tile.
        tile: usize,
        /// The point.
        point: DVec3,
    },
    /// There are no tiles or no readings.
    #[error("no tiles or no readings, must be at least one of each")]
    Empty,
    /// The noise is too small along an axis, or not finite.
    #[error("noise[{axis}] = {value_t:e} T, must be a finite number of at least {LEAST_NOISE_T:e} T")]
    Noise {
        /// The axis.
        axis: usize,
        /// The given value, in tesla.
        value_t: f64,
    },
    /// The number of readings that contradict all others exceeds the limit of outliers.
    #[error(
        "readings that contradict the others: {outliers}; the film, the positions or the range of the sensor are not as stated"
    )]
    AnotherFilm {
        /// Number of these readings.
        outliers: usize,
    },
    /// The probability of a false alarm is not between 0 and 1.
    #[error("probability of a false alarm = {0}, must be greater than 0 and less than 1")]
    FalseAlarm(f64),
    /// The derivatives by all errors at all points need too much memory.
    #[error(
        "the derivatives by all errors need {}; use fewer points",
        bytes.map_or("too much memory".to_owned(), |bytes| format!("{bytes} bytes, must be fewer"))
    )]
    TooLarge {
        /// The size of the derivatives in bytes; `None` if it exceeds the range of `usize`.
        bytes: Option<usize>,
    },
    /// The film that explains the scan is invalid.
    #[error("the film that explains the scan has an invalid tile: {0}")]
    Tile(#[source] TileFaults),
    /// The scan and the model contradict each other so much that the equations cannot be solved.
    #[error("no similar film explains the scan: the film or the positions of the scan are wrong")]
    NoSolution,
}

impl From<SampleError> for DiagnosisError {
    fn from(error: SampleError) -> DiagnosisError {
        match error {
            SampleError::Field(errors) => DiagnosisError::Points(errors),
            SampleError::NoDerivative { tile, point } => DiagnosisError::NoDerivative { tile, point },
            SampleError::TooLarge { bytes } => DiagnosisError::TooLarge { bytes },
            SampleError::Tile(faults) => DiagnosisError::Tile(faults),
            _ => DiagnosisError::NoSolution,
        }
    }
}

//! Why a scan cannot be diagnosed.

use std::error::Error;
use std::fmt;

use glam::DVec3;
use magsplice_magnet::{PointErrors, TileFaults};
use magsplice_tolerance::SampleError;

/// Why a scan cannot be diagnosed.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum DiagnosisError {
    /// The field does not exist at points of the scan, such as one on an edge of a tile.
    Points(PointErrors),
    /// The derivatives of the field of a tile do not exist at a point of the scan.
    NoDerivative {
        /// Index of the tile.
        tile: usize,
        /// The point.
        point: DVec3,
    },
    /// There are no tiles or no readings.
    Empty,
    /// The noise is not greater than 0 along an axis.
    Noise {
        /// The axis.
        axis: usize,
        /// What was given, in tesla.
        value_t: f64,
    },
    /// A reading is not finite.
    Reading {
        /// Index of the reading.
        index: usize,
    },
    /// The probability of a false alarm is not between 0 and 1.
    FalseAlarm(f64),
    /// The derivatives by all errors at all points need too much memory.
    TooLarge {
        /// Their size in bytes; `None` if it exceeds the range of `usize`.
        bytes: Option<usize>,
    },
    /// The film that explains the scan cannot exist.
    Tile(TileFaults),
    /// The scan and the model contradict each other so much that the equations cannot be solved.
    NoSolution,
}

impl fmt::Display for DiagnosisError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DiagnosisError::Points(errors) => write!(f, "no field at a point of the scan: {errors}"),
            DiagnosisError::NoDerivative { tile, point: DVec3 { x, y, z } } => write!(
                f,
                "the field of tile {tile} has no derivatives at ({x}, {y}, {z}), must be away from its edges and faces"
            ),
            DiagnosisError::Empty => f.write_str("no tiles or no readings, must be at least one of each"),
            DiagnosisError::Noise { axis, value_t } => {
                write!(f, "noise[{axis}] = {value_t} T, must be greater than 0")
            }
            DiagnosisError::Reading { index } => {
                write!(f, "reading[{index}] is not finite: leave it and its point out")
            }
            DiagnosisError::FalseAlarm(value) => {
                write!(f, "probability of a false alarm = {value}, must be greater than 0 and less than 1")
            }
            DiagnosisError::TooLarge { bytes: Some(bytes) } => {
                write!(f, "the derivatives by all errors need {bytes} bytes, must be fewer: scan fewer points")
            }
            DiagnosisError::TooLarge { bytes: None } => {
                f.write_str("the derivatives by all errors need too much memory: scan fewer points")
            }
            DiagnosisError::Tile(faults) => {
                write!(f, "the film that explains the scan has a tile that cannot exist: {faults}")
            }
            DiagnosisError::NoSolution => {
                f.write_str("no film like this one explains the scan: it is of another film, or elsewhere than stated")
            }
        }
    }
}

impl Error for DiagnosisError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            DiagnosisError::Points(errors) => Some(errors),
            DiagnosisError::Tile(faults) => Some(faults),
            _ => None,
        }
    }
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

//! From a measured field to the film: how a scan was taken, and which tiles of a film that was made
//! are faulty.
//!
//! * [`fit_scan`]: strength, offset, rotation and start of a measured scan, a [`ScanFit`].
//! * [`ScanPositions`]: the grid of a scan, its gaps and repeated positions.
//! * [`ScanDiagnosis`]: which tiles are weak, turned or displaced: a [`Diagnosis`].
//!
//! A fit has ten unknowns and reports the combinations that a scan does not determine. A diagnosis
//! has hundreds, each with a prior deviation. So each has a least-squares solver of its own; both
//! share [`ScanParameters`].
//!
//! Flux densities in tesla. Lengths of a diagnosis are millimetres; a fit takes any one unit, that
//! of the tiles. The equations are in docs/physics.md, section 8. This crate reads no files and
//! prints nothing.

// Rules are written as `!(x > limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// Faulty tiles of a film that was made, from a scan of its field.
mod diagnosis;
/// Fits of measured scans.
mod fit;
/// Why a scan cannot be fitted.
mod fit_error;
/// The least squares of a fit.
mod least_squares;
/// How a scan was taken, and what is fitted.
mod parameters;
/// The positions of a scan.
mod positions;

pub use diagnosis::{
    Candidate, Diagnosis, DiagnosisError, DiagnosisSettings, ErrorKind, FieldScan, FittedError, NamedError,
    NarrowedError, ScanDiagnosis, SimilarErrors,
};
pub use fit::fit_scan;
pub use fit_error::ScanError;
pub use least_squares::ScanFit;
pub use parameters::{FreeParameters, ScanParameter, ScanParameters};
pub use positions::ScanPositions;

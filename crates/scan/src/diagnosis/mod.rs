//! Faulty tiles of a film as made, from a scan of its field.
//!
//! The model is B at the points of the scan: the field of the nominal film and, to first order, the
//! exact derivatives by every error of every tile. Least squares with prior deviations (ridge
//! regression, or the mean of a Gaussian posterior) finds the errors, and Gauss-Newton steps repeat
//! it with the exact field of the resulting film (`gauss_newton`). Forward selection with tests of
//! chi squared then identifies the errors that neither noise nor expected errors explain.
//!
//! References: A. Tarantola, Inverse Problem Theory (SIAM 2005), section 3.2, for the estimate and
//! its covariance; C. R. Rao, Proc. Cambridge Phil. Soc. 44, 50 (1948), for the score test.

/// Candidate errors.
mod candidate;
/// Errors of a diagnosis.
mod error;
/// The fit of all unknowns.
mod gauss_newton;
/// Unknowns, derivatives and residuals.
mod model;
/// Least squares with prior deviations.
mod prior_fit;
/// Identified errors, and further results of a scan.
mod result;
/// The diagnosis of a film.
mod scan_diagnosis;
/// The search for significant errors.
mod search;
/// The settings of a diagnosis.
mod settings;
/// Probabilities of chi squared.
mod significance;
/// The unknowns of a scan as one list, and their prior deviations.
mod unknowns;
/// Errors that the scan does not resolve.
mod unresolved;

pub use candidate::{Candidate, ErrorKind};
pub use error::DiagnosisError;
pub(crate) use result::STRENGTH_ERRORS;
pub use result::{DetectedError, Diagnosis, FittedError};
pub use scan_diagnosis::ScanDiagnosis;
pub use settings::{DiagnosisSettings, FALSE_ALARM, FieldScan, MOST_ERRORS};
pub use unresolved::{NarrowedError, SimilarErrors};

//! Wrong tiles of a film that was made, from a scan of its field.
//!
//! The model is B at the points of the scan: that of the nominal film and, to first order, the
//! exact derivatives by every error of every tile. Least squares with prior deviations (ridge
//! regression, or the mean of a Gaussian posterior) finds the errors, and Gauss-Newton steps repeat
//! it at the film so found, whose field is exact. Forward selection with tests of chi squared then
//! names the errors that neither noise nor ordinary errors explain.
//!
//! References: A. Tarantola, Inverse Problem Theory (SIAM 2005), section 3.2, for the estimate and
//! its covariance; C. R. Rao, Proc. Cambridge Phil. Soc. 44, 50 (1948), for the score test.

/// The diagnosis of a film: settings and results.
mod diagnosis_run;
/// Why a scan cannot be diagnosed.
mod error;
/// The kinds of error that are named.
mod error_kind;
/// Least squares with prior deviations.
mod ridge;
/// Unknowns, derivatives and residuals.
mod scan_model;
/// Which errors are named.
mod search;
/// Probabilities of chi squared.
mod significance;
/// The unknowns of a scan as one list, and their prior deviations.
mod unknowns;
/// Errors that the scan does not resolve.
mod unresolved;

pub use diagnosis_run::{Candidate, Diagnosis, DiagnosisSettings, FieldScan, FittedError, NamedError, ScanDiagnosis};
pub use error::DiagnosisError;
pub use error_kind::ErrorKind;
pub use unresolved::{NarrowedError, SimilarErrors};

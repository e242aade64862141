//! Faulty tiles of a film that was made, from a scan of its field.
//!
//! The model is B at the points of the scan: that of the nominal film and, to first order, the
//! exact derivatives by every error of every tile. Least squares with prior deviations (ridge
//! regression, or the mean of a Gaussian posterior) finds the errors, and Gauss-Newton steps repeat
//! it at the film so found, whose field is exact. Forward selection with tests of chi squared then
//! names the errors that neither noise nor expected errors explain.
//!
//! References: A. Tarantola, Inverse Problem Theory (SIAM 2005), section 3.2, for the estimate and
//! its covariance; C. R. Rao, Proc. Cambridge Phil. Soc. 44, 50 (1948), for the score test.

/// Errors that may be named.
mod candidate;
/// Why a scan cannot be diagnosed.
mod error;
/// Unknowns, derivatives and residuals.
mod model;
/// Least squares with prior deviations.
mod prior_fit;
/// Errors that are named, and what else a scan tells.
mod result;
/// The diagnosis of a film.
mod scan_diagnosis;
/// Which errors are named.
mod search;
/// What is diagnosed, and when an error is named.
mod settings;
/// Probabilities of chi squared.
mod significance;
/// The unknowns of a scan as one list, and their prior deviations.
mod unknowns;
/// What the scan does not resolve.
mod unresolved;

pub use candidate::{Candidate, ErrorKind};
pub use error::DiagnosisError;
pub use result::{Diagnosis, FittedError, NamedError};
pub use scan_diagnosis::ScanDiagnosis;
pub use settings::{DiagnosisSettings, FieldScan};
pub use unresolved::{NarrowedError, SimilarErrors};

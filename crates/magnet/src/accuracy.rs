//! Exact evaluation, or a tolerance.

use std::fmt;

use glam::DVec3;

/// The requested accuracy of a field.
///
/// # Example
/// ```
/// use magsplice_magnet::{Accuracy, Tolerance};
///
/// let accuracy = Accuracy::Within(Tolerance::relative(1e-6)?);
/// assert_eq!(accuracy.to_string(), "within 1e-6 of |B|");
/// # Ok::<(), magsplice_magnet::InvalidTolerance>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Accuracy {
    /// Exact, within the error bound of the evaluator.
    #[default]
    Exact,
    /// Within a tolerance, by the cheapest method that keeps it.
    #[cfg_attr(feature = "serde", serde(untagged))]
    Within(Tolerance),
}

/// The largest accepted error of B, a finite number above zero.
///
/// [`Tolerance::relative`] and [`Tolerance::absolute_t`] build one; the variants are for matching
/// (`Tolerance::Relative { fraction, .. }`).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(into = "UncheckedTolerance", try_from = "UncheckedTolerance")
)]
pub enum Tolerance {
    /// The length of the error over the length of B at the same point.
    #[non_exhaustive]
    Relative {
        /// The fraction, above zero.
        fraction: f64,
    },
    /// The length of the error in tesla.
    #[non_exhaustive]
    AbsoluteT {
        /// The error in tesla, above zero.
        error_t: f64,
    },
}

/// A tolerance as it is serialized, such as `{"relative": 1e-6}`.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
enum UncheckedTolerance {
    Relative(f64),
    AbsoluteT(f64),
}

#[cfg(feature = "serde")]
impl From<Tolerance> for UncheckedTolerance {
    fn from(tolerance: Tolerance) -> UncheckedTolerance {
        match tolerance {
            Tolerance::Relative { fraction } => UncheckedTolerance::Relative(fraction),
            Tolerance::AbsoluteT { error_t } => UncheckedTolerance::AbsoluteT(error_t),
        }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<UncheckedTolerance> for Tolerance {
    type Error = InvalidTolerance;

    fn try_from(tolerance: UncheckedTolerance) -> Result<Tolerance, InvalidTolerance> {
        match tolerance {
            UncheckedTolerance::Relative(fraction) => Tolerance::relative(fraction),
            UncheckedTolerance::AbsoluteT(error_t) => Tolerance::absolute_t(error_t),
        }
    }
}

/// A value given as a tolerance that is not a finite number above zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvalidTolerance(pub f64);

impl Tolerance {
    /// An error as a fraction of |B|.
    ///
    /// # Errors
    /// If `fraction` is not a finite number above zero.
    pub fn relative(fraction: f64) -> Result<Tolerance, InvalidTolerance> {
        valid(fraction).map(|fraction| Tolerance::Relative { fraction })
    }

    /// An error in tesla.
    ///
    /// # Errors
    /// If `error_t` is not a finite number above zero.
    pub fn absolute_t(error_t: f64) -> Result<Tolerance, InvalidTolerance> {
        valid(error_t).map(|error_t| Tolerance::AbsoluteT { error_t })
    }

    /// The tolerance times a factor.
    ///
    /// # Errors
    /// If the product is not a finite number above zero.
    pub fn scaled(self, factor: f64) -> Result<Tolerance, InvalidTolerance> {
        match self {
            Tolerance::Relative { fraction } => Tolerance::relative(factor * fraction),
            Tolerance::AbsoluteT { error_t } => Tolerance::absolute_t(factor * error_t),
        }
    }

    /// Whether a value of B with an error of at most `error_t` certainly keeps the tolerance.
    pub fn is_kept(&self, value_t: DVec3, error_t: f64) -> bool {
        match *self {
            Tolerance::Relative { fraction } => error_t <= fraction * (value_t.length() - error_t),
            Tolerance::AbsoluteT { error_t: most } => error_t <= most,
        }
    }
}

fn valid(value: f64) -> Result<f64, InvalidTolerance> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(InvalidTolerance(value)) }
}

impl fmt::Display for InvalidTolerance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "tolerance = {}, must be a finite number above zero", self.0)
    }
}

impl std::error::Error for InvalidTolerance {}

impl fmt::Display for Accuracy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Accuracy::Exact => f.write_str("exact"),
            Accuracy::Within(Tolerance::Relative { fraction }) => write!(f, "within {fraction:e} of |B|"),
            Accuracy::Within(Tolerance::AbsoluteT { error_t }) => write!(f, "within {error_t:e} T"),
        }
    }
}

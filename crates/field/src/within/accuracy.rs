//! How exact a field is wanted.

use std::fmt;

use glam::DVec3;

use crate::tolerances::{ADDED_DEGREES, HIGHEST_DEGREE, LEAST_DEGREE};

/// How exact a field is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Accuracy {
    /// To the last digits: what [`Scene`](crate::Scene) promises.
    #[default]
    Exact,
    /// To a tolerance, as cheaply as it can be kept.
    Within(Tolerance),
}

/// The largest error of B that is accepted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// The length of the error over that of B at the same point.
    Relative(f64),
    /// The length of the error in tesla.
    AbsoluteT(f64),
}

/// A tolerance must be a finite number above zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvalidTolerance(pub f64);

impl Tolerance {
    /// The error as a fraction of |B|.
    ///
    /// # Errors
    /// If it is not a finite number above zero.
    pub fn relative(fraction: f64) -> Result<Tolerance, InvalidTolerance> {
        valid(fraction).map(Tolerance::Relative)
    }

    /// The error in tesla.
    ///
    /// # Errors
    /// If it is not a finite number above zero.
    pub fn absolute_t(error_t: f64) -> Result<Tolerance, InvalidTolerance> {
        valid(error_t).map(Tolerance::AbsoluteT)
    }

    /// Whether a value that is off by at most `error_t` certainly keeps the tolerance.
    pub fn is_kept(&self, value_t: DVec3, error_t: f64) -> bool {
        match *self {
            Tolerance::Relative(fraction) => error_t <= fraction * (value_t.length() - error_t),
            Tolerance::AbsoluteT(most) => error_t <= most,
        }
    }
}

impl Accuracy {
    /// The degree up to which expansions of tiles whose |J| is at most this pay: it leaves out about the tolerance at twice the radius.
    pub(crate) fn degree(self, most_j_t: f64) -> usize {
        let fraction = match self {
            Accuracy::Exact => return HIGHEST_DEGREE,
            Accuracy::Within(Tolerance::Relative(fraction)) => fraction,
            Accuracy::Within(Tolerance::AbsoluteT(error_t)) => error_t / most_j_t,
        };
        let degree = ADDED_DEGREES - fraction.log2();
        if degree > LEAST_DEGREE as f64 { degree.min(HIGHEST_DEGREE as f64) as usize } else { LEAST_DEGREE }
    }
}

fn valid(value: f64) -> Result<f64, InvalidTolerance> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(InvalidTolerance(value)) }
}

impl fmt::Display for InvalidTolerance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a tolerance of {} cannot be kept: it must be a finite number above zero", self.0)
    }
}

impl std::error::Error for InvalidTolerance {}

impl fmt::Display for Accuracy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Accuracy::Exact => f.write_str("exact"),
            Accuracy::Within(Tolerance::Relative(fraction)) => write!(f, "within {fraction:e} of |B|"),
            Accuracy::Within(Tolerance::AbsoluteT(error_t)) => write!(f, "within {error_t:e} T"),
        }
    }
}

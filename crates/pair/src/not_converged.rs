//! An integral over turned cuboids that does not converge.

use std::error::Error;
use std::fmt;

/// The integrand over two tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PairIntegral {
    /// The field of one tile, over the volume of the other.
    MeanField,
    /// Force and torque of the charges of one tile in the field of the other.
    Load,
}

/// An integral over two tiles turned against each other does not converge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NotConverged {
    /// The integrand.
    pub integral: PairIntegral,
    /// Reached error: relative to the norm of the tensor, or to the integral of magnitudes.
    pub reached: f64,
    /// Requested error.
    pub tolerance: f64,
}

impl fmt::Display for NotConverged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let NotConverged { integral, reached, tolerance } = self;
        match integral {
            PairIntegral::MeanField => write!(
                f,
                "the mean field of a tile in another, turned tile has an error of {reached:.1e}, must have at most \
                 {tolerance:.1e}; tiles must not overlap, leave a gap between them"
            ),
            PairIntegral::Load => write!(
                f,
                "the force of two tiles that are turned against each other has an error of {reached:.1e}, must have \
                 at most {tolerance:.1e}; leave a gap between them or accept a larger tolerance"
            ),
        }
    }
}

impl Error for NotConverged {}

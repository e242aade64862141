//! Points without a field, and the reason.

use std::fmt;

use glam::DVec3;

use crate::tolerances::MAX_LENGTH;

/// The reason why a point has no field.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PointErrorCause {
    /// The point is on an exposed edge or corner, where the field grows without bound like the
    /// logarithm of the distance.
    Unbounded {
        /// Index of a tile with that edge.
        tile: usize,
    },
    /// The point is on an edge that tiles share and whose singular terms cancel. The field exists
    /// there, but the gradient would be the difference of unbounded terms.
    Unresolved {
        /// Index of a tile with that edge.
        tile: usize,
    },
    /// A coordinate of the point is not finite or beyond [`MAX_LENGTH`], or the result is beyond
    /// the range of numbers.
    OutOfRange,
    /// The tolerance is below the error bound of the exact field.
    TooExact {
        /// The error bound of the exact field in tesla, from an upper bound of the sum over tiles.
        bound_t: f64,
    },
    /// The point is on or in iron, where the images of the tiles give no field.
    InIron {
        /// Index of the plane of the iron.
        plane: usize,
    },
}

/// A point without a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointError {
    /// Index into the requested points.
    pub index: usize,
    /// The point.
    pub point: DVec3,
    /// The reason.
    pub cause: PointErrorCause,
}

/// All points without a field, in the order of the points.
#[derive(Clone, Debug, PartialEq)]
pub struct PointErrors(pub Vec<PointError>);

/// Number of points that a message of [`PointErrors`] lists.
const NAMED_POINTS: usize = 10;

/// Whether every coordinate of a point is a number of at most [`MAX_LENGTH`] in magnitude.
#[inline]
pub fn is_in_range(point: DVec3) -> bool {
    // Each component is compared, so that NaN fails.
    point.abs().cmple(DVec3::splat(MAX_LENGTH)).all()
}

impl fmt::Display for PointErrorCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PointErrorCause::Unbounded { tile } => {
                write!(f, "the field is unbounded on an exposed edge of tile {tile}")
            }
            PointErrorCause::Unresolved { tile } => {
                write!(f, "the gradient cannot be resolved on an edge that tile {tile} shares with others")
            }
            PointErrorCause::OutOfRange => {
                f.write_str("coordinates must be finite, at most 2^1000 in magnitude, and the result in range")
            }
            PointErrorCause::TooExact { bound_t } => write!(
                f,
                "the tolerance cannot be kept: even the exact field is only certain to {bound_t:.1e} T; \
                 take a larger tolerance, or one in tesla"
            ),
            PointErrorCause::InIron { plane } => {
                write!(f, "the point is on or behind plane {}, in iron, whose inner field is not computed", plane + 1)
            }
        }
    }
}

impl std::error::Error for PointErrorCause {}

impl fmt::Display for PointError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let PointError { index, point, cause } = self;
        write!(f, "point {index} at ({}, {}, {}): {cause}", point.x, point.y, point.z)
    }
}

impl std::error::Error for PointError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.cause)
    }
}

impl fmt::Display for PointErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, error) in self.0.iter().take(NAMED_POINTS).enumerate() {
            let separator = if i == 0 { "" } else { "; " };
            write!(f, "{separator}{error}")?;
        }
        match self.0.len().saturating_sub(NAMED_POINTS) {
            0 => Ok(()),
            more => write!(f, "; and {more} more"),
        }
    }
}

impl std::error::Error for PointErrors {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.0.first().map(|error| error as _)
    }
}

//! What the readings of all sensors of a head tell.

use glam::{DMat3, DVec3};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Numbers that are fitted to the readings of a head.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize, serde::Serialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum HeadUnknowns {
    /// The position.
    Position,
    /// The position, and a uniform field beside that of the film along the axes of the board.
    StrayField,
    /// The same, and the rotation of the board against the film: two tilts and a turn.
    Pose,
}

impl HeadUnknowns {
    /// Number of fitted numbers.
    pub const fn count(self) -> usize {
        match self {
            HeadUnknowns::Position => 3,
            HeadUnknowns::StrayField => 6,
            HeadUnknowns::Pose => 9,
        }
    }

    /// Whether a stray field is fitted.
    pub const fn has_stray_field(self) -> bool {
        !matches!(self, HeadUnknowns::Position)
    }

    /// Whether the rotation is fitted.
    pub const fn has_rotation(self) -> bool {
        matches!(self, HeadUnknowns::Pose)
    }
}

/// The least-squares fit of the readings of a head.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct HeadFit {
    /// The position of the origin of the board, in the frame and the unit of length of the tiles.
    pub position: DVec3,
    /// Whether it is in the volume.
    pub is_within: bool,
    /// Gradient of the weighted sum there: column j is the derivative along x_j.
    pub gradient: DMat3,
    /// The stray field along the axes of the board, in tesla; 0 unless it is fitted.
    pub stray_t: DVec3,
    /// The rotation vector of the board against the film; 0 unless it is fitted.
    pub rotation_rad: DVec3,
    /// Standard deviations of the position for the noise of the sensors. Without noise, those for a
    /// noise of 1 T.
    pub position_deviation: DVec3,
    /// Those of the stray field, in tesla.
    pub stray_deviation_t: DVec3,
    /// Those of the rotation.
    pub rotation_deviation_rad: DVec3,
    /// Sum of the squares of the residuals over the noise.
    pub chi_squared: f64,
    /// Its expectation for normal noise: the readings less the fitted numbers.
    pub degrees_of_freedom: usize,
}

impl HeadFit {
    /// Probability of as large a residual of a right model with normal noise. `None` without
    /// degrees of freedom.
    pub fn probability(&self) -> Option<f64> {
        probability(self.chi_squared, self.degrees_of_freedom)
    }
}

/// What the noise of all sensors lets a head see at a position: the Fisher information of one
/// reading of each, with the other unknowns fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct HeadResolution {
    /// Standard deviations of the position, in the unit of length of the tiles.
    pub position_deviation: DVec3,
    /// Those of the stray field, in tesla; 0 unless it is fitted.
    pub stray_deviation_t: DVec3,
    /// Smallest singular value of the derivatives of the readings over their noise by the position,
    /// without the parts that other unknowns explain: the reading in units of its noise for a
    /// displacement of 1 along the least visible direction.
    pub least_singular_value: f64,
}

/// The probability of a larger chi squared. `None` without degrees of freedom.
pub(crate) fn probability(chi_squared: f64, freedom: usize) -> Option<f64> {
    Some(ChiSquared::new(freedom as f64).ok()?.sf(chi_squared))
}

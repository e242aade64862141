//! How a scan was taken, and what is fitted.

use glam::{DQuat, DVec3};

/// Number of parameters: strength, offset, rotation, start.
pub(crate) const PARAMETERS: usize = 10;

/// What is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeParameters {
    /// The strength of all tiles.
    pub strength: bool,
    /// A constant reading: the offset of the sensor and a uniform stray field together.
    pub offset: bool,
    /// The rotation of the sensor.
    pub rotation: bool,
    /// The position of the sensor at the origin of the scan.
    pub start: bool,
}

/// How a scan was taken: a sensor at p reads R^-1 (strength B(p + start)) + offset.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ScanParameters {
    /// Strength of all tiles over that of the layout.
    pub strength: f64,
    /// Constant reading along the axes of the sensor, in tesla.
    pub offset_t: DVec3,
    /// Rotation vector of the sensor in the frame of the tiles, in radians.
    pub rotation_rad: DVec3,
    /// Position of the sensor, in the frame of the tiles, where the scan has its origin.
    pub start: DVec3,
}

/// A fitted scan.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ScanFit {
    /// The parameters.
    pub parameters: ScanParameters,
    /// Their standard deviations, from the residuals; 0 for those that were not fitted.
    pub deviations: ScanParameters,
    /// Standard deviation of the residuals of one component, without outliers, in tesla.
    pub noise_t: f64,
    /// Reading minus fit at each point, outliers too, in tesla and along the axes of the sensor.
    pub residuals_t: Vec<DVec3>,
    /// Indices of the readings that were left out, in ascending order.
    pub outliers: Vec<usize>,
}

impl ScanParameters {
    /// Those of a perfect scan.
    pub const PERFECT: ScanParameters =
        ScanParameters { strength: 1.0, offset_t: DVec3::ZERO, rotation_rad: DVec3::ZERO, start: DVec3::ZERO };

    /// The reading where the field of the tiles is `field_t`.
    pub fn reading_t(&self, field_t: DVec3) -> DVec3 {
        self.turn().inverse() * (self.strength * field_t) + self.offset_t
    }

    /// The field, in the frame of the tiles, that a sensor without offset and rotation would have
    /// read.
    pub fn corrected_t(&self, reading_t: DVec3) -> DVec3 {
        self.turn() * (reading_t - self.offset_t)
    }

    pub(crate) fn turn(&self) -> DQuat {
        DQuat::from_scaled_axis(self.rotation_rad)
    }
}

impl FreeParameters {
    /// Everything.
    pub const ALL: FreeParameters = FreeParameters { strength: true, offset: true, rotation: true, start: true };

    pub(crate) fn indices(self) -> Vec<usize> {
        let FreeParameters { strength, offset, rotation, start } = self;
        let is_free = |index: usize| match index {
            0 => strength,
            1..=3 => offset,
            4..=6 => rotation,
            _ => start,
        };
        (0..PARAMETERS).filter(|index| is_free(*index)).collect()
    }
}

/// The names of the parameters.
pub(crate) const NAMES: [&str; PARAMETERS] = [
    "strength",
    "offset along x",
    "offset along y",
    "offset along z",
    "rotation about x",
    "rotation about y",
    "rotation about z",
    "start along x",
    "start along y",
    "start along z",
];

//! The parameters of a scan.

use std::fmt;

use glam::{DQuat, DVec3};
use magsplice_magnet::Axis;

/// One parameter of a scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScanParameter {
    /// The strength of all tiles.
    Strength,
    /// The constant reading along an axis of the sensor.
    Offset(Axis),
    /// A component of the rotation vector of the sensor.
    Rotation(Axis),
    /// A coordinate of the sensor at the origin of the scan.
    Start(Axis),
}

impl ScanParameter {
    /// All parameters: the strength, and three each of offset, rotation and start.
    pub const ALL: [ScanParameter; 10] = [
        ScanParameter::Strength,
        ScanParameter::Offset(Axis::X),
        ScanParameter::Offset(Axis::Y),
        ScanParameter::Offset(Axis::Z),
        ScanParameter::Rotation(Axis::X),
        ScanParameter::Rotation(Axis::Y),
        ScanParameter::Rotation(Axis::Z),
        ScanParameter::Start(Axis::X),
        ScanParameter::Start(Axis::Y),
        ScanParameter::Start(Axis::Z),
    ];

    /// The index of the parameter in [`ScanParameter::ALL`].
    pub const fn index(self) -> usize {
        match self {
            ScanParameter::Strength => 0,
            ScanParameter::Offset(axis) => 1 + axis.index(),
            ScanParameter::Rotation(axis) => 4 + axis.index(),
            ScanParameter::Start(axis) => 7 + axis.index(),
        }
    }
}

impl fmt::Display for ScanParameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ScanParameter::Strength => f.write_str("strength"),
            ScanParameter::Offset(axis) => write!(f, "offset along {}", axis.name()),
            ScanParameter::Rotation(axis) => write!(f, "rotation about {}", axis.name()),
            ScanParameter::Start(axis) => write!(f, "start along {}", axis.name()),
        }
    }
}

/// The parameters to fit.
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

impl FreeParameters {
    /// Every parameter.
    pub const ALL: FreeParameters = FreeParameters { strength: true, offset: true, rotation: true, start: true };

    /// Every parameter but the strength, which is held.
    pub const HELD_STRENGTH: FreeParameters = FreeParameters { strength: false, ..FreeParameters::ALL };

    /// No parameter: the scan is known.
    pub const NONE: FreeParameters = FreeParameters { strength: false, offset: false, rotation: false, start: false };

    /// Whether a parameter is fitted.
    pub const fn contains(self, parameter: ScanParameter) -> bool {
        match parameter {
            ScanParameter::Strength => self.strength,
            ScanParameter::Offset(_) => self.offset,
            ScanParameter::Rotation(_) => self.rotation,
            ScanParameter::Start(_) => self.start,
        }
    }

    /// Number of fitted parameters.
    pub fn count(self) -> usize {
        ScanParameter::ALL.into_iter().filter(|parameter| self.contains(*parameter)).count()
    }
}

/// The parameters of a scan: a sensor at p reads R^-1 (strength B(p + start)) + offset.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ScanParameters {
    /// Strength of all tiles, relative to the layout.
    pub strength: f64,
    /// Constant reading along the axes of the sensor, in tesla.
    pub offset_t: DVec3,
    /// Rotation vector of the sensor in the frame of the tiles, in radians.
    pub rotation_rad: DVec3,
    /// Position of the sensor, in the frame of the tiles, at the origin of the scan.
    pub start: DVec3,
}

impl ScanParameters {
    /// The parameters of a perfect scan.
    pub const PERFECT: ScanParameters =
        ScanParameters { strength: 1.0, offset_t: DVec3::ZERO, rotation_rad: DVec3::ZERO, start: DVec3::ZERO };

    /// The parameters with the values of a function.
    pub fn from_fn(value: impl Fn(ScanParameter) -> f64) -> ScanParameters {
        let vector = |of: fn(Axis) -> ScanParameter| DVec3::from(Axis::ALL.map(|axis| value(of(axis))));
        ScanParameters {
            strength: value(ScanParameter::Strength),
            offset_t: vector(ScanParameter::Offset),
            rotation_rad: vector(ScanParameter::Rotation),
            start: vector(ScanParameter::Start),
        }
    }

    /// The value of a parameter.
    pub fn get(&self, parameter: ScanParameter) -> f64 {
        match parameter {
            ScanParameter::Strength => self.strength,
            ScanParameter::Offset(axis) => self.offset_t[axis.index()],
            ScanParameter::Rotation(axis) => self.rotation_rad[axis.index()],
            ScanParameter::Start(axis) => self.start[axis.index()],
        }
    }

    /// The reading where the field of the tiles is `field_t`.
    pub fn reading_t(&self, field_t: DVec3) -> DVec3 {
        self.turn().inverse() * (self.strength * field_t) + self.offset_t
    }

    /// The field, in the frame of the tiles, read by a sensor without offset and rotation.
    pub fn corrected_t(&self, reading_t: DVec3) -> DVec3 {
        self.turn() * (reading_t - self.offset_t)
    }

    pub(crate) fn turn(&self) -> DQuat {
        DQuat::from_scaled_axis(self.rotation_rad)
    }
}

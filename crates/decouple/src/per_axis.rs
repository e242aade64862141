//! One value for each axis.

use std::ops::Index;

use glam::DVec3;
use magsplice_magnet::Axis;

/// One value for each axis, such as an error of the displacement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct PerAxis<T = f64> {
    /// The value along x.
    pub x: T,
    /// The value along y.
    pub y: T,
    /// The value along z.
    pub z: T,
}

impl<T> PerAxis<T> {
    /// The values along x, y, z.
    pub fn to_array(self) -> [T; 3] {
        [self.x, self.y, self.z]
    }

    /// Applies a function to each value.
    pub fn map<U>(self, f: impl FnMut(T) -> U) -> PerAxis<U> {
        self.to_array().map(f).into()
    }
}

impl<T> From<[T; 3]> for PerAxis<T> {
    fn from([x, y, z]: [T; 3]) -> PerAxis<T> {
        PerAxis { x, y, z }
    }
}

impl From<DVec3> for PerAxis {
    fn from(DVec3 { x, y, z }: DVec3) -> PerAxis {
        PerAxis { x, y, z }
    }
}

impl From<PerAxis> for DVec3 {
    fn from(PerAxis { x, y, z }: PerAxis) -> DVec3 {
        DVec3 { x, y, z }
    }
}

impl<T> Index<Axis> for PerAxis<T> {
    type Output = T;

    fn index(&self, axis: Axis) -> &T {
        match axis {
            Axis::X => &self.x,
            Axis::Y => &self.y,
            Axis::Z => &self.z,
        }
    }
}

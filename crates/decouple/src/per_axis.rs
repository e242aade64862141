//! One value for each axis.

use glam::DVec3;

/// One value for each axis, such as an error of the displacement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PerAxis<T = f64> {
    /// The value along x.
    pub x: T,
    /// The value along y.
    pub y: T,
    /// The value along z.
    pub z: T,
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

impl<T> PerAxis<T> {
    /// The values along x, y, z.
    pub fn to_array(self) -> [T; 3] {
        [self.x, self.y, self.z]
    }
}

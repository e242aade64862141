//! The axes x, y, z.

use std::fmt;

use glam::DVec3;

/// An axis of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema), schemars(rename_all = "lowercase"))]
pub enum Axis {
    /// x.
    X,
    /// y.
    Y,
    /// z.
    Z,
}

impl Axis {
    /// All axes, in order.
    pub const ALL: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

    /// 0, 1, 2 for x, y, z.
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The unit vector along the axis.
    pub fn unit(self) -> DVec3 {
        DVec3::AXES[self.index()]
    }

    /// The letter of the axis.
    pub const fn name(self) -> &'static str {
        ["x", "y", "z"][self.index()]
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

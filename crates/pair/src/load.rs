//! Force and torque on a tile.

use std::ops::{Add, AddAssign, Neg};

use glam::DVec3;

/// Force on a tile, and torque about its centre.
///
/// # Units
/// With lengths in metres, newtons and newton metres. With lengths in another unit L, the force is
/// in newtons times (L / m)^2 and the torque in newton metres times (L / m)^3. So with millimetres
/// a factor of 1e-6 turns the force into N, and the torque into N mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Load {
    /// Force, in the frame of the scene.
    pub force: DVec3,
    /// Torque about the centre of the tile, in the frame of the scene.
    pub torque: DVec3,
}

impl Load {
    /// No force and no torque.
    pub const ZERO: Load = Load { force: DVec3::ZERO, torque: DVec3::ZERO };

    /// The load on the other tile of a pair: force and torque are balanced. `offset` is the vector
    /// from the centre of the other tile to that of this one.
    pub fn reaction(self, offset: DVec3) -> Load {
        Load { force: -self.force, torque: -self.torque - offset.cross(self.force) }
    }
}

impl Add for Load {
    type Output = Load;

    fn add(self, other: Load) -> Load {
        Load { force: self.force + other.force, torque: self.torque + other.torque }
    }
}

impl AddAssign for Load {
    fn add_assign(&mut self, other: Load) {
        *self = *self + other;
    }
}

impl Neg for Load {
    type Output = Load;

    fn neg(self) -> Load {
        Load { force: -self.force, torque: -self.torque }
    }
}

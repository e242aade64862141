//! Force and torque on a tile.

use std::ops::{Add, AddAssign, Neg};

use glam::DVec3;

/// Force on a tile, and torque about its centre.
///
/// # Units
/// With lengths in metres, the force is in newtons and the torque in newton metres. With lengths in
/// another unit L, multiply the force by (L / m)^2 and the torque by (L / m)^3. For millimetres, a
/// factor of 1e-6 converts the force to N, and the torque to N mm.
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

    /// The load on the other tile of a pair, which balances force and torque. `offset` is the
    /// vector from the centre of the other tile to the centre of this tile.
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

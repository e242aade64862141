//! Magnets with a linear recoil line.

use glam::{DMat3, DVec3};
use magsplice_magnet::{Permeability, Tile};

/// A tile with its polarization J_r at H = 0, and its recoil permeability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecoilTile {
    /// The tile with its polarization J_r.
    pub tile: Tile,
    /// The permeability.
    pub permeability: Permeability,
}

impl RecoilTile {
    /// The susceptibility tensor chi in the frame of the scene: J = J_r + chi mu0 H.
    pub fn susceptibility(&self) -> DMat3 {
        self.function_of_susceptibility(|chi| chi)
    }

    /// The square root of the susceptibility.
    pub(crate) fn root_of_susceptibility(&self) -> DMat3 {
        self.function_of_susceptibility(f64::sqrt)
    }

    /// The direction of J_r in the frame of the scene; `None` without polarization.
    pub fn easy_axis(&self) -> Option<DVec3> {
        self.tile.scene_polarization_t().try_normalize()
    }

    fn function_of_susceptibility(&self, function: impl Fn(f64) -> f64) -> DMat3 {
        let (along, across) = (function(self.permeability.along() - 1.0), function(self.permeability.across() - 1.0));
        let isotropic = DMat3::from_diagonal(DVec3::splat(across));
        match self.easy_axis() {
            Some(easy) if along != across => {
                let outer = DMat3::from_cols(easy * easy.x, easy * easy.y, easy * easy.z);
                isotropic + outer * (along - across)
            }
            _ => isotropic,
        }
    }
}

//! Magnets with a linear recoil line.

use std::error::Error;
use std::fmt;

use glam::{DMat3, DVec3};
use magsplice_magnet::Tile;

/// Largest recoil permeability. The solver needs about its square root in iterations.
pub const MAX_PERMEABILITY: f64 = 1e4;

/// The relative recoil permeability mu_r of a magnet, along its easy axis and across it.
///
/// The easy axis is the direction of the polarization of the tile. A tile without polarization has none:
/// the permeability across applies in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Permeability {
    along: f64,
    across: f64,
}

/// A permeability that is not between 1 and [`MAX_PERMEABILITY`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvalidPermeability(pub f64);

impl fmt::Display for InvalidPermeability {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "recoil permeability = {}, must be between 1 and {MAX_PERMEABILITY:e}", self.0)
    }
}

impl Error for InvalidPermeability {}

impl Permeability {
    /// The same permeability in all directions.
    ///
    /// # Errors
    /// If it is not between 1 and [`MAX_PERMEABILITY`].
    pub fn isotropic(mu_r: f64) -> Result<Permeability, InvalidPermeability> {
        Permeability::along_and_across(mu_r, mu_r)
    }

    /// Permeabilities along the easy axis and across it.
    ///
    /// # Errors
    /// If one is not between 1 and [`MAX_PERMEABILITY`].
    pub fn along_and_across(along: f64, across: f64) -> Result<Permeability, InvalidPermeability> {
        for mu_r in [along, across] {
            if !(1.0..=MAX_PERMEABILITY).contains(&mu_r) {
                return Err(InvalidPermeability(mu_r));
            }
        }
        Ok(Permeability { along, across })
    }

    /// Permeability along the easy axis.
    pub fn along(self) -> f64 {
        self.along
    }

    /// Permeability across the easy axis.
    pub fn across(self) -> f64 {
        self.across
    }
}

/// A tile whose polarization is that at H = 0, J_r, and its recoil permeability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecoilTile {
    /// The tile with its polarization J_r.
    pub tile: Tile,
    /// Its permeability.
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
        let (along, across) = (function(self.permeability.along - 1.0), function(self.permeability.across - 1.0));
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

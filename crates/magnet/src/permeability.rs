//! The recoil permeability of magnets.

use std::error::Error;
use std::fmt;

/// Largest recoil permeability. Magnets have at most 5.
pub const MAX_PERMEABILITY: f64 = 1e4;

/// The relative recoil permeability mu_r of a magnet, along its easy axis and across it.
///
/// The easy axis is the direction of the polarization of the tile. In a tile without polarization
/// the permeability across applies in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Permeability {
    along: f64,
    across: f64,
}

/// A permeability outside the range from 1 to [`MAX_PERMEABILITY`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvalidPermeability(pub f64);

impl fmt::Display for InvalidPermeability {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "recoil permeability = {}, must be between 1 and {MAX_PERMEABILITY:e}", self.0)
    }
}

impl Error for InvalidPermeability {}

impl Permeability {
    /// A rigid polarization, which no field changes: 1 in all directions.
    pub const RIGID: Permeability = Permeability { along: 1.0, across: 1.0 };

    /// The same permeability in all directions.
    ///
    /// # Errors
    /// If `mu_r` is not between 1 and [`MAX_PERMEABILITY`].
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

    /// Whether the polarization is rigid.
    pub fn is_rigid(self) -> bool {
        self == Permeability::RIGID
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

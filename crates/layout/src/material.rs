//! The material of the tiles.

use magsplice_magnet::Permeability;

/// Default share of the largest change of B by recoil that its error may have. The estimate of the
/// error is far above the error itself (docs/recoil.md), and the permeability of a magnet is known
/// to 0.01 at best, for 1.05 a fifth of the change. Films need the least level at which an error is
/// known.
const RECOIL_ERROR: f64 = 0.3;

/// The material of the tiles. The default is a magnet whose polarization no field changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// The relative recoil permeability of tiles that have none of their own.
    pub permeability: Permeability,
    /// Largest error of what recoil changes in B, as a share of its largest change.
    pub recoil_error: f64,
    /// mu0 times the magnitude of H at the knee of the demagnetization curve, in tesla. `None` if
    /// it is not stated.
    pub knee_field_t: Option<f64>,
    /// Relative change of the strength of all tiles per kelvin. `None` if it is not stated.
    pub strength_per_k: Option<f64>,
}

impl Default for Material {
    fn default() -> Material {
        Material {
            permeability: Permeability::RIGID,
            recoil_error: RECOIL_ERROR,
            knee_field_t: None,
            strength_per_k: None,
        }
    }
}

//! The table `[material]`, and the key `recoil_permeability` of tiles and kinds.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The material of the tiles.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Material")]
pub(crate) struct MaterialTable {
    /// Relative recoil permeability of tiles that have none of their own. Default: 1, no field
    /// changes the polarization.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) recoil_permeability: Option<RecoilPermeability>,
    /// Largest error of what recoil changes in B, as a share of its largest change. Smaller errors
    /// need more cells. Default: 0.3.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) recoil_error: Option<f64>,
    /// mu0 times the magnitude of H at the knee of the demagnetization curve, in T. Tiles beyond it
    /// are reported. Default: not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) knee_field_t: Option<f64>,
    /// Relative change of the strength of all tiles per kelvin, a fraction: -0.0012 is -0.12 % per
    /// kelvin. [tolerance.temperature] takes it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) strength_per_k: Option<f64>,
}

/// A relative recoil permeability: a number, or one along the direction of the polarization and one
/// across it.
#[derive(Clone, Copy, Deserialize, JsonSchema, Serialize)]
#[serde(untagged)]
pub(crate) enum RecoilPermeability {
    /// The same in all directions.
    Isotropic(f64),
    /// Along the polarization and across it.
    Axes(AlongAndAcross),
}

/// Relative recoil permeabilities along the direction of the polarization and across it.
#[derive(Clone, Copy, Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
#[schemars(extend("example" = "{ along = 1.05, across = 1.15 }"))]
pub(crate) struct AlongAndAcross {
    /// Along the polarization, the easy axis.
    pub(crate) along: f64,
    /// Across the polarization.
    pub(crate) across: f64,
}

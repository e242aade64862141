//! The table `[ideal]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The sinusoidal film of Dai 2024, Eq. 1, to compare with.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct IdealTable {
    /// Wavelength of the sinusoidal polarization, in mm.
    #[schemars(extend("example" = "10.0"))]
    pub(crate) wavelength_mm: f64,
    /// Thickness of the film, in mm.
    #[schemars(extend("example" = "1.0"))]
    pub(crate) thickness_mm: f64,
    /// Amplitude m0 of each component of the polarization, in T.
    #[schemars(extend("example" = "0.12"))]
    pub(crate) amplitude_t: f64,
}

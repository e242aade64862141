//! The table `[ideal]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The sinusoidal film of Dai 2024, Eq. 1, to compare with.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct IdealTable {
    /// Wavelength of the sinusoidal polarization, in mm.
    pub(crate) wavelength_mm: f64,
    /// Thickness of the film, in mm.
    pub(crate) thickness_mm: f64,
    /// Amplitude m0 of each component of the polarization, in T.
    pub(crate) amplitude_t: f64,
}

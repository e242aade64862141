//! The table `[material]`, and the key `recoil_permeability` of tiles and kinds.

use std::fmt;

use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

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
#[derive(Clone, Copy, JsonSchema, Serialize)]
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
pub(crate) struct AlongAndAcross {
    /// Along the polarization, the easy axis.
    pub(crate) along: f64,
    /// Across the polarization.
    pub(crate) across: f64,
}

impl<'de> Deserialize<'de> for RecoilPermeability {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OfNumberOrTable;
        impl<'de> Visitor<'de> for OfNumberOrTable {
            type Value = RecoilPermeability;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a number such as 1.05, or a table such as { along = 1.05, across = 1.15 }")
            }

            fn visit_f64<E>(self, value: f64) -> Result<Self::Value, E> {
                Ok(RecoilPermeability::Isotropic(value))
            }

            fn visit_i64<E>(self, value: i64) -> Result<Self::Value, E> {
                Ok(RecoilPermeability::Isotropic(value as f64))
            }

            fn visit_u64<E>(self, value: u64) -> Result<Self::Value, E> {
                Ok(RecoilPermeability::Isotropic(value as f64))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
                AlongAndAcross::deserialize(MapAccessDeserializer::new(map)).map(RecoilPermeability::Axes)
            }
        }
        deserializer.deserialize_any(OfNumberOrTable)
    }
}

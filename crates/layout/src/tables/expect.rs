//! The table `[expect]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use crate::expectations::ExpectedField;

/// Requirements on the film over its working volume.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ExpectTable {
    /// Upper bounds of the uniformity RMSE.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) uniformity_rmse: Option<UniformityBounds>,
    /// Upper bounds of the RMSE of the displacement, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) displacement_rmse_mm: Option<DisplacementBounds>,
    /// Lower bound of the amplitude: the best-fit factor of B against the ideal film.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "{ min = 0.8 }"))]
    pub(crate) amplitude: Option<LowerBound>,
    /// A baseline that the field must reproduce.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) field: Option<ExpectedField>,
    /// Lower bound of the distance between the tiles and the working volume, in mm. The distance is
    /// negative where a tile reaches into the volume.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "{ min = 3.0 }"))]
    pub(crate) clearance_mm: Option<LowerBound>,
    /// Requirements on the films that are made with the errors of [tolerance].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<MadeTable>")]
    pub(crate) made: Option<Spanned<MadeTable>>,
}

/// Requirements on a percentile of the films that are made with the errors of [tolerance], at least
/// one.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MadeTable {
    /// Per cent of the films that must keep each bound. Default: 95.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) percentile: Option<f64>,
    /// Upper bounds of the uniformity RMSE at the percentile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) uniformity_rmse: Option<UniformityBounds>,
    /// Upper bounds of the RMSE of the displacement at the percentile, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) displacement_rmse_mm: Option<DisplacementBounds>,
    /// Lower bound of the amplitude at 100 minus the percentile.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "{ min = 0.8 }"))]
    pub(crate) amplitude: Option<LowerBound>,
    /// Number of films that are evaluated. Default: the samples of [tolerance].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) samples: Option<u64>,
    /// Confidence with which the films that were evaluated must exclude that the bound is kept,
    /// before it counts as broken: a fraction. Default: 0.95.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) confidence: Option<f64>,
}

/// Upper bounds of the uniformity RMSE, at least one.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
#[schemars(extend("example" = "{ r_x = 0.065, r_y = 0.065, s_z = 0.042 }"))]
pub(crate) struct UniformityBounds {
    /// Upper bound for R_x, in radians.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) r_x: Option<f64>,
    /// Upper bound for R_y, in radians.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) r_y: Option<f64>,
    /// Upper bound for S_z, dimensionless.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) s_z: Option<f64>,
}

/// Upper bounds of the displacement RMSE, at least one.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
#[schemars(extend("example" = "{ x = 0.25, y = 0.25, z = 0.32 }"))]
pub(crate) struct DisplacementBounds {
    /// Upper bound along x, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) x: Option<f64>,
    /// Upper bound along y, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) y: Option<f64>,
    /// Upper bound along z, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) z: Option<f64>,
}

/// A lower bound.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LowerBound {
    /// The smallest value allowed.
    pub(crate) min: f64,
}

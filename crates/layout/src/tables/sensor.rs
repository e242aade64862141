//! The tables `[sensor]` and `[elastomer]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::tables::rotation::RotationTable;

/// The three-axis Hall sensor below the film. Without this table it is perfect: points without
/// errors, noise or limits.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Sensor")]
pub(crate) struct SensorTable {
    /// A part with known numbers: MLX90393, TLV493D, LIS3MDL or MMC5983MA. The keys beside it
    /// replace its numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) part: Option<String>,
    /// Standard deviation of the noise of a reading, in microtesla: one for all axes, or three.
    /// Default: 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) noise_ut: Option<PerAxis>,
    /// Flux density of one count, in microtesla: one for all axes, or three. Default: 0, readings
    /// are not rounded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) count_ut: Option<PerAxis>,
    /// Largest flux density that is read, in millitesla: one for all axes, or three. Default: no
    /// limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) range_mt: Option<PerAxis>,
    /// Readings per second. Default: not stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) rate_hz: Option<f64>,
    /// Reading over flux density: one for all axes, or three. Default: 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) gain: Option<PerAxis>,
    /// Reading without a field, in microtesla: one for all axes, or three. Default: 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) offset_ut: Option<PerAxis>,
    /// Rotation of the sensor in the frame of the film. Default: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) rotation: Option<RotationTable>,
    /// Sides of the rectangle along x and y of the sensor that a plate averages over, in mm.
    /// Default: points.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "[0.1, 0.1]"))]
    pub(crate) active_area_mm: Option<[f64; 2]>,
    /// Centres of the plates in the frame of the sensor. Default: all at its position.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "{ z = [0.0, 0.0, -0.1] }"))]
    pub(crate) plates_mm: Option<PlatesTable>,
}

/// Centres of the plates that read x, y and z, in the frame of the sensor, in mm. Default: its
/// position.
#[derive(Clone, Copy, Default, Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlatesTable {
    /// Centre of the plate that reads B_x.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "[0.0, 0.0, -0.1]"))]
    pub(crate) x: Option<[f64; 3]>,
    /// Centre of the plate that reads B_y.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "[0.0, 0.0, -0.1]"))]
    pub(crate) y: Option<[f64; 3]>,
    /// Centre of the plate that reads B_z.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "[0.0, 0.0, -0.1]"))]
    pub(crate) z: Option<[f64; 3]>,
}

/// One number for all axes, or one for each.
#[derive(Clone, Copy, Deserialize, JsonSchema, Serialize)]
#[serde(untagged)]
pub(crate) enum PerAxis {
    /// The same for all.
    Same(f64),
    /// Along x, y, z.
    Each([f64; 3]),
}

impl PerAxis {
    pub(crate) fn values(self) -> [f64; 3] {
        match self {
            PerAxis::Same(value) => [value; 3],
            PerAxis::Each(values) => values,
        }
    }
}

/// The elastic layer between film and sensor (Dai 2024, Eqs. 16 and 17).
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ElastomerTable {
    /// Contact area, in mm^2.
    pub(crate) area_mm2: f64,
    /// Thickness without load, in mm.
    pub(crate) thickness_mm: f64,
    /// Young's modulus, in MPa.
    pub(crate) youngs_modulus_mpa: f64,
    /// Poisson ratio: above -1, and at most 0.5.
    pub(crate) poisson_ratio: f64,
    /// Calibrated stiffness over that of Eqs. 16 and 17 along x, y, z: the coefficients a_1 to a_3.
    /// Default: 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) scale: Option<PerAxis>,
    /// Calibrated force without displacement along x, y, z, in N: the coefficients b_1 to b_3.
    /// Default: 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) force_at_rest_n: Option<PerAxis>,
}

//! The table `[volume]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The region in which the sensor moves, sampled on a regular grid.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct VolumeTable {
    /// Lower and upper end along x, in mm.
    #[schemars(extend("example" = "[-2.0, 2.0]"))]
    pub(crate) x_mm: [f64; 2],
    /// Lower and upper end along y, in mm.
    #[schemars(extend("example" = "[-2.0, 2.0]"))]
    pub(crate) y_mm: [f64; 2],
    /// Lower and upper end along z, in mm. Below the film z is negative.
    #[schemars(extend("example" = "[-5.0, -3.0]"))]
    pub(crate) z_mm: [f64; 2],
    /// Distance between neighbouring points, in mm: one number, or one each along x, y, z.
    #[schemars(extend("example" = "0.5"))]
    pub(crate) step_mm: Step,
    /// The point from which changes of the field are measured, in mm, on the film's axis. Default:
    /// the middle of x and y at the lowest z.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "[0.0, 0.0, -5.0]"))]
    pub(crate) reference_mm: Option<[f64; 3]>,
}

#[derive(Clone, Copy, Deserialize, JsonSchema, Serialize)]
#[serde(untagged)]
pub(crate) enum Step {
    /// The same step along x, y and z.
    Same(f64),
    /// One step each along x, y, z.
    PerAxis([f64; 3]),
}

//! The table `[volume]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::tables::exact_list::{exactly, some_exactly};

/// The region in which the sensor moves, sampled on a regular grid.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct VolumeTable {
    /// Lower and upper end along x, in mm.
    #[serde(deserialize_with = "exactly")]
    pub(crate) x_mm: [f64; 2],
    /// Lower and upper end along y, in mm.
    #[serde(deserialize_with = "exactly")]
    pub(crate) y_mm: [f64; 2],
    /// Lower and upper end along z, in mm. Below the film z is negative.
    #[serde(deserialize_with = "exactly")]
    pub(crate) z_mm: [f64; 2],
    /// Distance between neighbouring points, in mm: one number, or one each along x, y, z.
    pub(crate) step_mm: Step,
    /// The point from which changes of the field are measured, in mm, on the film's axis. Default:
    /// the middle of x and y at the lowest z.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[serde(default, deserialize_with = "some_exactly")]
    pub(crate) reference_mm: Option<[f64; 3]>,
}

#[derive(Clone, Copy, Deserialize, JsonSchema, Serialize)]
#[serde(
    untagged,
    expecting = "step_mm is one number in mm, or a list of three, one along each axis, as in `step_mm = 0.5`"
)]
pub(crate) enum Step {
    /// The same step along x, y and z.
    Same(f64),
    /// One step each along x, y, z.
    PerAxis([f64; 3]),
}

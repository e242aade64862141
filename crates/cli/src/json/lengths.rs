//! Lengths along x, y, z as an object.

use magsplice::prelude::DVec3;
use serde::Serialize;

/// Lengths along x, y, z.
#[derive(Serialize)]
pub(crate) struct LengthsJson {
    x: f64,
    y: f64,
    z: f64,
}

impl From<DVec3> for LengthsJson {
    fn from(v: DVec3) -> LengthsJson {
        LengthsJson { x: v.x, y: v.y, z: v.z }
    }
}

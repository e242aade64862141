//! Values along x, y and z: one number for all axes, or a list of three.

use std::fmt;

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::{Rule, TableFaults};

/// One number for all axes, or one for each.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(untagged)]
pub(crate) enum OneOrThree {
    /// The same for all.
    Same(f64),
    /// Along x, y, z.
    Each([f64; 3]),
}

impl OneOrThree {
    /// Requires a rule of each number.
    pub(crate) fn check(self, key: &str, rule: Rule, faults: &mut TableFaults) {
        match self {
            OneOrThree::Same(value) => faults.number(key, value, rule),
            OneOrThree::Each(values) => faults.numbers(key, &values, rule),
        }
    }
}

impl From<OneOrThree> for DVec3 {
    fn from(values: OneOrThree) -> DVec3 {
        match values {
            OneOrThree::Same(value) => DVec3::splat(value),
            OneOrThree::Each(values) => DVec3::from(values),
        }
    }
}

impl From<DVec3> for OneOrThree {
    fn from(values: DVec3) -> OneOrThree {
        let is_same = values.x == values.y && values.x == values.z;
        if is_same { OneOrThree::Same(values.x) } else { OneOrThree::Each(values.to_array()) }
    }
}

impl fmt::Display for OneOrThree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OneOrThree::Same(value) => write!(f, "{value}"),
            OneOrThree::Each(values) => write!(f, "{values:?}"),
        }
    }
}

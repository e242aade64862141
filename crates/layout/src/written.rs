//! A layout as it is written in TOML: every key with its unit, unknown keys refused, nothing checked yet.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LayoutFile {
    pub(crate) format: Spanned<i64>,
    pub(crate) name: String,
    pub(crate) description: Option<String>,
    pub(crate) ideal: Option<Spanned<Ideal>>,
    pub(crate) volume: Option<Spanned<Volume>>,
    pub(crate) expect: Option<Spanned<Expect>>,
    #[serde(default)]
    pub(crate) kind: BTreeMap<String, Spanned<Kind>>,
    #[serde(default)]
    pub(crate) tile: Vec<Spanned<TileEntry>>,
    #[serde(default)]
    pub(crate) lattice: Vec<Spanned<Lattice>>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Ideal {
    pub(crate) wavelength_mm: f64,
    pub(crate) thickness_mm: f64,
    pub(crate) amplitude_t: f64,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Volume {
    pub(crate) x_mm: [f64; 2],
    pub(crate) y_mm: [f64; 2],
    pub(crate) z_mm: [f64; 2],
    pub(crate) step_mm: Step,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) reference_mm: Option<[f64; 3]>,
}

#[derive(Clone, Copy, Deserialize, Serialize)]
#[serde(untagged, expecting = "expected a number or an array of three numbers")]
pub(crate) enum Step {
    Same(f64),
    PerAxis([f64; 3]),
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Expect {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) uniformity_rmse: Option<UniformityBounds>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) amplitude: Option<Least>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) field: Option<FieldBaseline>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) clearance_mm: Option<Least>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct UniformityBounds {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) r_x: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) r_y: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) s_z: Option<f64>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Least {
    pub(crate) min: f64,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FieldBaseline {
    pub(crate) file: String,
    pub(crate) within: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Kind {
    pub(crate) size_mm: [f64; 3],
    pub(crate) strength_t: Option<f64>,
    pub(crate) polarization_t: Option<[f64; 3]>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TileEntry {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) kind: Option<String>,
    pub(crate) position_mm: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) size_mm: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) polarization_t: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) strength_t: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) direction: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) rotation: Option<Rotation>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) grid: Option<Repeat>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) mirror: Option<Mirror>,
}

/// A rotation about the tile's centre, from the tile's own frame to the scene's.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Rotation {
    /// Axis of rotation; any length but zero.
    pub axis: [f64; 3],
    /// Angle, right-handed about the axis, in degrees.
    pub angle_deg: f64,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Repeat {
    pub(crate) count: [usize; 3],
    pub(crate) pitch_mm: [f64; 3],
    #[serde(default)]
    pub(crate) alternate: Vec<Axis>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Mirror {
    pub(crate) axes: Vec<Axis>,
    #[serde(default)]
    pub(crate) at_mm: [f64; 3],
    #[serde(default)]
    pub(crate) polarization: Reflection,
}

#[derive(Clone, Copy, Default, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Reflection {
    /// Reflected like an arrow drawn on the tile: the component normal to the mirror changes sign.
    #[default]
    Reflect,
    /// Reflected like a magnetization, which is a pseudovector: the components in the mirror change sign.
    Axial,
    /// Not changed.
    Keep,
}

#[derive(Clone, Copy, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Axis {
    X,
    Y,
    Z,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Lattice {
    pub(crate) name: Option<String>,
    pub(crate) start_mm: [f64; 3],
    pub(crate) height_mm: f64,
    pub(crate) strength_t: Option<f64>,
    pub(crate) component_t: Option<f64>,
    pub(crate) x: Vec<Stretch>,
    pub(crate) y: Option<Vec<Stretch>>,
}

/// Consecutive cells along one axis of a lattice.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Stretch {
    pub(crate) widths_mm: Vec<f64>,
    pub(crate) pattern: Vec<f64>,
    pub(crate) times: Option<usize>,
}

//! The table `rotation` of a tile.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::rotation::Rotation;

/// A rotation about the tile's centre, from the tile's own frame to the film's. It is given once:
/// as axis and angle_deg, as quaternion, as euler_deg and order, or as matrix.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Rotation")]
#[schemars(extend("example" = "{ axis = [0, 0, 1], angle_deg = 30 }"))]
pub(crate) struct RotationTable {
    /// Axis of rotation, a vector of any length but zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "[0, 0, 1]"))]
    pub(crate) axis: Option<[f64; 3]>,
    /// Angle, right-handed about the axis, in degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) angle_deg: Option<f64>,
    /// Quaternion x, y, z, w of any norm but zero; w is the scalar part.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "[0.0, 0.0, 0.5, 0.866]"))]
    pub(crate) quaternion: Option<[f64; 4]>,
    /// Angles of three successive rotations, in degrees, in the order of their axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "[10.0, 20.0, 30.0]"))]
    pub(crate) euler_deg: Option<[f64; 3]>,
    /// Axes of these rotations: "xyz" about the film's axes (extrinsic), "XYZ" about the axes of
    /// the turned tile (intrinsic).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) order: Option<String>,
    /// Rows of the matrix that takes vectors from the tile's own frame to the film's.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("example" = "[[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]"))]
    pub(crate) matrix: Option<[[f64; 3]; 3]>,
}

impl From<Rotation> for RotationTable {
    fn from(rotation: Rotation) -> RotationTable {
        let none = RotationTable::default();
        match rotation {
            Rotation::AxisAngle { axis, angle_deg } => {
                RotationTable { axis: Some(axis), angle_deg: Some(angle_deg), ..none }
            }
            Rotation::Quaternion(xyzw) => RotationTable { quaternion: Some(xyzw), ..none },
            Rotation::Euler { angles_deg, order } => {
                RotationTable { euler_deg: Some(angles_deg), order: Some(order.to_string()), ..none }
            }
            Rotation::Matrix(rows) => RotationTable { matrix: Some(rows), ..none },
        }
    }
}

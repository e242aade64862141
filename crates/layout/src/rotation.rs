//! Rotations in every form of the file, and the quaternions that they are.

use std::fmt;

use glam::{DMat3, DQuat, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, de};
use thiserror::Error;

use crate::faults::{Faults, TableFaults};
use crate::names::shown;
use crate::units::{rotation_from_degrees, unit_vector};

/// Largest deviation of a matrix from orthogonality: of any element of its product with its
/// transpose from the unit matrix. Elements with six decimals stay below it.
pub const ORTHOGONALITY_TOLERANCE: f64 = 1e-5;

/// Largest deviation from 1 of the norm of a quaternion that is taken as it is. Normalizing it
/// would only change the last digit.
const NORM_ROUNDING: f64 = 2.0 * f64::EPSILON;

/// Steps to the nearest orthogonal matrix. Each squares the deviation: 1e-5, 1e-10, 1e-20.
const ORTHOGONALIZATIONS: usize = 2;

/// A rotation about the tile's centre as written, from the tile's own frame to the scene's.
///
/// [`Rotation::checked`] checks the numbers. Without it they may have no meaning, and
/// [`Rotation::quaternion`] then is not a rotation.
///
/// # Example
/// ```
/// use magsplice_layout::{EulerOrder, Rotation};
///
/// let about_z = Rotation::AxisAngle { axis: [0.0, 0.0, 1.0], angle_deg: 30.0 }.checked()?;
/// let order: EulerOrder = "zyx".parse()?;
/// let euler = Rotation::Euler { angles_deg: [30.0, 0.0, 0.0], order }.checked()?;
/// assert_eq!(about_z.quaternion(), euler.quaternion());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Rotation {
    /// About an axis.
    AxisAngle {
        /// Axis of rotation, a vector of any length but zero.
        axis: [f64; 3],
        /// Angle, right-handed about the axis, in degrees.
        angle_deg: f64,
    },
    /// A quaternion x, y, z, w of any norm but zero; w is the scalar part.
    Quaternion([f64; 4]),
    /// Three rotations one after the other.
    Euler {
        /// The angles in degrees, in the order of the axes.
        angles_deg: [f64; 3],
        /// The axes.
        order: EulerOrder,
    },
    /// The rows of a matrix that takes vectors from the tile's own frame to the scene's.
    Matrix([[f64; 3]; 3]),
}

/// The axes of three successive rotations, as the letters of `scipy.spatial.transform.Rotation`:
/// `"xyz"` about the fixed axes of the scene (extrinsic), `"XYZ"` about the axes of the turned tile
/// (intrinsic).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EulerOrder {
    /// 0, 1, 2 for x, y, z.
    axes: [usize; 3],
    intrinsic: bool,
}

/// Why numbers are not a rotation: for each fault the key with its value, then the rule.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{}", .0.join("; "))]
pub struct RotationFaults(pub Vec<String>);

/// A text that is no order of Euler angles.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error(
    "must be three letters, no two equal ones side by side: xyz for rotations about the fixed axes, in this order \
     (extrinsic), XYZ for rotations about the axes of the turned tile (intrinsic)"
)]
pub struct InvalidEulerOrder;

impl Rotation {
    /// The rotation, if its numbers are one. A matrix stands for the nearest rotation, because
    /// decimals are rounded. The norms of an axis and of a quaternion do not matter.
    ///
    /// # Errors
    /// All faults: an axis or a quaternion that is zero, a number that is not finite, and a matrix
    /// that is a reflection or deviates by more than [`ORTHOGONALITY_TOLERANCE`] from
    /// orthogonality.
    pub fn checked(self) -> Result<Rotation, RotationFaults> {
        let rules = match self {
            Rotation::AxisAngle { axis, angle_deg } => vec![
                (unit_vector(axis).is_some(), format!("axis = {axis:?}, must be finite and not zero")),
                (angle_deg.is_finite(), format!("angle_deg = {angle_deg}, must be a finite number")),
            ],
            Rotation::Quaternion(xyzw) => {
                let is_kept = xyzw.iter().all(|c| c.is_finite()) && xyzw != [0.0; 4];
                vec![(is_kept, format!("quaternion = {xyzw:?}, must be finite and not zero"))]
            }
            Rotation::Euler { angles_deg, .. } => {
                let is_kept = angles_deg.iter().all(|angle| angle.is_finite());
                vec![(is_kept, format!("euler_deg = {angles_deg:?}, must be three finite numbers"))]
            }
            Rotation::Matrix(rows) => {
                let (are_finite, matrix) = (rows.iter().flatten().all(|element| element.is_finite()), matrix(rows));
                let product = matrix * matrix.transpose() - DMat3::IDENTITY;
                let deviation = product.to_cols_array().iter().fold(0.0, |largest: f64, e| largest.max(e.abs()));
                // False for NaN, from elements that overflow.
                let is_orthogonal = are_finite && deviation <= ORTHOGONALITY_TOLERANCE;
                let deviates = format!(
                    "matrix times its transpose deviates by {deviation:.1e} from the unit matrix, must be at most \
                     {ORTHOGONALITY_TOLERANCE:e}"
                );
                let reflects = "matrix has the determinant -1, a reflection, must be a rotation with 1".to_owned();
                vec![
                    (are_finite, format!("matrix = {rows:?}, must be nine finite numbers")),
                    (is_orthogonal || !are_finite, deviates),
                    (matrix.determinant() >= 0.0 || !is_orthogonal, reflects),
                ]
            }
        };
        let broken: Vec<String> = rules.into_iter().filter(|(is_kept, _)| !is_kept).map(|(_, rule)| rule).collect();
        if broken.is_empty() { Ok(self) } else { Err(RotationFaults(broken)) }
    }

    /// The unit quaternion of the rotation. Angles are first reduced to one turn, which is exact.
    ///
    /// # Accuracy
    /// Components are right to a few units of round-off. A quaternion of norm 1 keeps its digits.
    pub fn quaternion(&self) -> DQuat {
        match *self {
            Rotation::AxisAngle { axis, angle_deg } => {
                rotation_from_degrees(unit_vector(axis).unwrap_or(DVec3::Z), angle_deg)
            }
            Rotation::Quaternion(xyzw) => {
                let given = DQuat::from_array(xyzw);
                if (given.length() - 1.0).abs() <= NORM_ROUNDING {
                    return given;
                }
                // Scaled first, so that squares neither overflow nor underflow.
                let largest = xyzw.iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
                DQuat::from_array(xyzw.map(|c| c / largest)).normalize()
            }
            Rotation::Euler { angles_deg, order } => {
                let [first, second, third] =
                    [0, 1, 2].map(|i| rotation_from_degrees(DVec3::AXES[order.axes[i]], angles_deg[i]));
                let product = if order.intrinsic { first * second * third } else { third * second * first };
                product.normalize()
            }
            Rotation::Matrix(rows) => {
                let mut matrix = matrix(rows);
                for _ in 0..ORTHOGONALIZATIONS {
                    matrix = (matrix + matrix.inverse().transpose()) * 0.5;
                }
                DQuat::from_mat3(&matrix).normalize()
            }
        }
    }

    /// The same rotation seen in a mirror normal to an axis: M R M, with M the mirror.
    pub(crate) fn mirrored(&self, normal: usize) -> Rotation {
        let sign = |axis: usize| if axis == normal { -1.0 } else { 1.0 };
        match *self {
            Rotation::AxisAngle { axis, angle_deg } => {
                Rotation::AxisAngle { axis: [0, 1, 2].map(|i| sign(i) * axis[i]), angle_deg: -angle_deg }
            }
            Rotation::Quaternion([x, y, z, w]) => Rotation::Quaternion([-sign(0) * x, -sign(1) * y, -sign(2) * z, w]),
            Rotation::Euler { angles_deg, order } => {
                let angles_deg = [0, 1, 2].map(|i| -sign(order.axes[i]) * angles_deg[i]);
                Rotation::Euler { angles_deg, order }
            }
            Rotation::Matrix(rows) => {
                Rotation::Matrix([0, 1, 2].map(|i| [0, 1, 2].map(|j| sign(i) * sign(j) * rows[i][j])))
            }
        }
    }
}

/// A rotation about the tile's centre, from the tile's own frame to the film's. It is given once:
/// as axis and angle_deg, as quaternion, as euler_deg and order, or as matrix.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(rename = "Rotation")]
#[schemars(extend("example" = "{ axis = [0, 0, 1], angle_deg = 30 }"))]
pub(crate) struct RotationTable {
    /// Axis of rotation, a vector of any length but zero.
    #[schemars(extend("example" = "[0, 0, 1]"))]
    axis: Option<[f64; 3]>,
    /// Angle, right-handed about the axis, in degrees.
    angle_deg: Option<f64>,
    /// Quaternion x, y, z, w of any norm but zero; w is the scalar part.
    #[schemars(extend("example" = "[0.0, 0.0, 0.5, 0.866]"))]
    quaternion: Option<[f64; 4]>,
    /// Angles of three successive rotations, in degrees, in the order of their axes.
    #[schemars(extend("example" = "[10.0, 20.0, 30.0]"))]
    euler_deg: Option<[f64; 3]>,
    /// Axes of these rotations: "xyz" about the film's axes (extrinsic), "XYZ" about the axes of
    /// the turned tile (intrinsic).
    order: Option<String>,
    /// Rows of the matrix that takes vectors from the tile's own frame to the film's.
    #[schemars(extend("example" = "[[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]"))]
    matrix: Option<[[f64; 3]; 3]>,
}

impl RotationTable {
    /// The rotation, or `None` after adding its faults.
    pub(crate) fn resolve(&self, faults: &mut TableFaults) -> Option<Rotation> {
        let RotationTable { axis, angle_deg, quaternion, euler_deg, order, matrix } = self;
        let forms = [
            ("axis and angle_deg", axis.is_some() || angle_deg.is_some()),
            ("quaternion", quaternion.is_some()),
            ("euler_deg and order", euler_deg.is_some() || order.is_some()),
            ("matrix", matrix.is_some()),
        ];
        faults.only_one("rotation", &forms)?;
        let rotation = match (*axis, *angle_deg, *quaternion, *euler_deg, order, *matrix) {
            (Some(axis), Some(angle_deg), ..) => Rotation::AxisAngle { axis, angle_deg },
            (_, _, Some(quaternion), ..) => Rotation::Quaternion(quaternion),
            (_, _, _, Some(angles_deg), Some(order), _) => match order.parse() {
                Ok(order) => Rotation::Euler { angles_deg, order },
                Err(InvalidEulerOrder) => {
                    return faults.refuse(format!("rotation.order = \"{}\", {InvalidEulerOrder}", shown(order)));
                }
            },
            (.., Some(rows)) => Rotation::Matrix(rows),
            (Some(_), ..) => return faults.refuse("rotation has axis without an angle_deg"),
            (_, Some(_), ..) => return faults.refuse("rotation has angle_deg without an axis"),
            (_, _, _, Some(_), ..) => {
                return faults.refuse("rotation has euler_deg without an order, such as \"xyz\"");
            }
            _ => return faults.refuse("rotation has order without euler_deg"),
        };
        let add = |fault: String| faults.add(format!("rotation.{fault}"));
        rotation.checked().map_err(|broken| broken.0.into_iter().for_each(add)).ok()
    }

    /// The keys with angles, and the angles in degrees.
    pub(crate) fn angles_deg(&self) -> impl Iterator<Item = (String, f64)> {
        let angle = self.angle_deg.map(|angle| ("rotation.angle_deg".to_owned(), angle));
        let euler = self.euler_deg.into_iter().flatten().enumerate();
        angle.into_iter().chain(euler.map(|(index, angle)| (format!("rotation.euler_deg[{index}]"), angle)))
    }
}

/// With the keys of `rotation` in a layout file.
impl<'de> Deserialize<'de> for Rotation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Rotation, D::Error> {
        let table = RotationTable::deserialize(deserializer)?;
        let mut faults = Faults::new("");
        let found = table.resolve(&mut faults.at(0, "rotation"));
        found.ok_or_else(|| {
            let messages: Vec<String> = faults.into_sorted().into_iter().map(|fault| fault.message).collect();
            de::Error::custom(messages.join("; "))
        })
    }
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

fn matrix(rows: [[f64; 3]; 3]) -> DMat3 {
    DMat3::from_cols_array_2d(&rows).transpose()
}

impl EulerOrder {
    /// The axes in the order of the rotations: 0, 1, 2 for x, y, z.
    pub fn axes(&self) -> [usize; 3] {
        self.axes
    }
}

impl std::str::FromStr for EulerOrder {
    type Err = InvalidEulerOrder;

    fn from_str(text: &str) -> Result<EulerOrder, InvalidEulerOrder> {
        let letters: [char; 3] = text.chars().collect::<Vec<_>>().try_into().map_err(|_| InvalidEulerOrder)?;
        let intrinsic = letters[0].is_ascii_uppercase();
        let alphabet = if intrinsic { ['X', 'Y', 'Z'] } else { ['x', 'y', 'z'] };
        let mut axes = [0; 3];
        for (axis, letter) in axes.iter_mut().zip(letters) {
            *axis = alphabet.iter().position(|known| *known == letter).ok_or(InvalidEulerOrder)?;
        }
        let distinct = axes[0] != axes[1] && axes[1] != axes[2];
        distinct.then_some(EulerOrder { axes, intrinsic }).ok_or(InvalidEulerOrder)
    }
}

impl fmt::Display for EulerOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let letters = if self.intrinsic { ["X", "Y", "Z"] } else { ["x", "y", "z"] };
        self.axes.iter().try_for_each(|axis| f.write_str(letters[*axis]))
    }
}

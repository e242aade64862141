//! Random tiles and points for property tests, near and on faces, edges, corners and their
//! extensions.

use glam::{DQuat, DVec3};
use magsplice_field::Tile;
use proptest::prelude::*;

/// A component of J in tesla: zero, up to 1, between 1e-3 and 1 of either sign, or between 1e-30
/// and 1e-15 like the round-off of zero.
fn component() -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => (-30.0..-15.0_f64).prop_map(|d| 10_f64.powf(d)),
        1 => Just(0.0),
        2 => -1.0..1.0_f64,
        1 => (-3.0..0.0_f64, any::<bool>()).prop_map(|(d, n)| signed(n) * 10_f64.powf(d)),
    ]
}

fn signed(negative: bool) -> f64 {
    if negative { -1.0 } else { 1.0 }
}

/// Any polarization but zero, in tesla.
pub fn polarization() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(component()).prop_map(DVec3::from).prop_filter("J is not zero", |j| *j != DVec3::ZERO)
}

/// An unrotated tile whose sides differ by up to `decades` decades, at the origin or away from it.
pub fn tile(decades: f64) -> impl Strategy<Value = Tile> {
    let half = 0.5 * decades;
    let side = (-half..half).prop_map(|d| 10_f64.powf(d));
    let position = prop_oneof![1 => Just([0.0; 3]), 1 => prop::array::uniform3(-10.0..10.0_f64)];
    (position, prop::array::uniform3(side), polarization())
        .prop_map(|(position, size, j)| Tile::new(position.into(), size.into(), j).expect("a valid tile"))
}

/// Any rotation: the identity, quarter turns about an axis, and all others.
pub fn rotation() -> impl Strategy<Value = DQuat> {
    let axis = prop::array::uniform3(-1.0..1.0_f64).prop_filter("an axis", |a| DVec3::from(*a).length() > 0.1);
    let any = (axis, -4.0..4.0_f64).prop_map(|(a, angle)| DQuat::from_axis_angle(DVec3::from(a).normalize(), angle));
    let quarter = (0..3_usize, 1..4_i32)
        .prop_map(|(axis, n)| DQuat::from_axis_angle(DVec3::AXES[axis], f64::from(n) * std::f64::consts::FRAC_PI_2));
    prop_oneof![Just(DQuat::IDENTITY), quarter, any]
}

/// The position of a coordinate relative to the two faces of a tile along one axis.
#[derive(Clone, Copy, Debug)]
pub enum FaceOffset {
    /// Exactly on the lower (false) or upper (true) face.
    Face(bool),
    /// Beside a face, on its inside or outside, by a fraction of half the size.
    Beside {
        /// Whether the face is the upper one.
        upper: bool,
        /// Whether the coordinate is outside.
        outside: bool,
        /// Distance from the face in half sizes, 1e-16 to 1.
        fraction: f64,
    },
    /// Halfway between the faces.
    Middle,
    /// Between the faces, from -1 at the lower to 1 at the upper face.
    Between(f64),
    /// Outside, at this multiple of half the size from the middle.
    Away(f64),
}

impl FaceOffset {
    /// The coordinate for a tile of this position and size along the axis.
    pub fn coordinate(self, position: f64, size: f64) -> f64 {
        let half = 0.5 * size;
        position
            + match self {
                FaceOffset::Face(upper) => signed(!upper) * half,
                FaceOffset::Beside { upper, outside, fraction } => {
                    signed(!upper) * half * (1.0 + signed(!outside) * fraction)
                }
                FaceOffset::Middle => 0.0,
                FaceOffset::Between(f) => f * half,
                FaceOffset::Away(factor) => factor * half,
            }
    }
}

fn face_offset() -> impl Strategy<Value = FaceOffset> {
    let beside = (any::<bool>(), any::<bool>(), 0.0..16.0_f64)
        .prop_map(|(upper, outside, decades)| FaceOffset::Beside { upper, outside, fraction: 10_f64.powf(-decades) });
    prop_oneof![
        1 => any::<bool>().prop_map(FaceOffset::Face),
        4 => beside,
        1 => Just(FaceOffset::Middle),
        3 => (-1.0..1.0_f64).prop_map(FaceOffset::Between),
        3 => (0.0..4.0_f64, any::<bool>()).prop_map(|(d, n)| FaceOffset::Away(signed(n) * 10_f64.powf(d))),
    ]
}

/// Offsets along the three axes of a tile.
pub fn face_offsets() -> impl Strategy<Value = [FaceOffset; 3]> {
    prop::array::uniform3(face_offset())
}

/// The point at these offsets of an unrotated tile.
pub fn point(tile: &Tile, offsets: [FaceOffset; 3]) -> DVec3 {
    DVec3::from([0, 1, 2].map(|axis: usize| offsets[axis].coordinate(tile.position()[axis], tile.size()[axis])))
}

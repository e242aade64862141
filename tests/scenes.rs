//! Random tiles and points for property tests, on purpose near and on faces, edges, corners and their extensions.

use glam::{DQuat, DVec3};
use magsplice_field::Tile;
use proptest::prelude::*;

/// A component of J: zero often enough, of any size between 1e-3 and 1 T, and what round-off leaves of zero.
fn component() -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => (-30.0..-15.0_f64).prop_map(|d| 10_f64.powf(d)),
1 => Just(0.0), 2 => -1.0..1.0_f64, 1 => (-3.0..0.0_f64, any::<bool>()).prop_map(|(d, n)| signed(n) * 10_f64.powf(d))]
}

fn signed(negative: bool) -> f64 {
    if negative { -1.0 } else { 1.0 }
}

/// Any polarization but zero.
pub fn polarization() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(component()).prop_map(DVec3::from).prop_filter("J is not zero", |j| *j != DVec3::ZERO)
}

/// An unrotated tile: sides up to `decades` decades apart, at the origin or off it.
pub fn tile(decades: f64) -> impl Strategy<Value = Tile> {
    let half = 0.5 * decades;
    let side = (-half..half).prop_map(|d| 10_f64.powf(d));
    let position = prop_oneof![1 => Just([0.0; 3]), 1 => prop::array::uniform3(-10.0..10.0_f64)];
    (position, prop::array::uniform3(side), polarization())
        .prop_map(|(position, size, j)| Tile::new(position.into(), size.into(), j).expect("a valid tile"))
}

/// Any rotation: none, quarter turns, and all others.
pub fn rotation() -> impl Strategy<Value = DQuat> {
    let axis = prop::array::uniform3(-1.0..1.0_f64).prop_filter("an axis", |a| DVec3::from(*a).length() > 0.1);
    let any = (axis, -4.0..4.0_f64).prop_map(|(a, angle)| DQuat::from_axis_angle(DVec3::from(a).normalize(), angle));
    let quarter = (0..3_usize, 1..4_i32)
        .prop_map(|(axis, n)| DQuat::from_axis_angle(DVec3::AXES[axis], f64::from(n) * std::f64::consts::FRAC_PI_2));
    prop_oneof![Just(DQuat::IDENTITY), quarter, any]
}

/// Where a coordinate is, relative to the two faces of a tile.
#[derive(Clone, Copy, Debug)]
pub enum Place {
    /// Exactly on the lower (false) or upper (true) face.
    Face(bool),
    /// This side of a face, on the inside or the outside, by this fraction of half the size.
    Beside {
        /// Which face.
        upper: bool,
        /// Which side of it.
        outside: bool,
        /// 1e-16 to 1.
        fraction: f64,
    },
    /// Half-way between the faces.
    Middle,
    /// Between the faces, -1 to 1.
    Between(f64),
    /// Outside, by this factor.
    Away(f64),
}

impl Place {
    /// The coordinate for a tile of this position and size.
    pub fn coordinate(self, position: f64, size: f64) -> f64 {
        let half = 0.5 * size;
        position
            + match self {
                Place::Face(upper) => signed(!upper) * half,
                Place::Beside { upper, outside, fraction } => {
                    signed(!upper) * half * (1.0 + signed(!outside) * fraction)
                }
                Place::Middle => 0.0,
                Place::Between(f) => f * half,
                Place::Away(factor) => factor * half,
            }
    }
}

fn place() -> impl Strategy<Value = Place> {
    let beside = (any::<bool>(), any::<bool>(), 0.0..16.0_f64).prop_map(|(upper, outside, decades)| Place::Beside {
        upper,
        outside,
        fraction: 10_f64.powf(-decades),
    });
    prop_oneof![
        1 => any::<bool>().prop_map(Place::Face),
        4 => beside,
        1 => Just(Place::Middle),
        3 => (-1.0..1.0_f64).prop_map(Place::Between),
        3 => (0.0..4.0_f64, any::<bool>()).prop_map(|(d, n)| Place::Away(signed(n) * 10_f64.powf(d))),
    ]
}

/// Places along the three axes of a tile.
pub fn places() -> impl Strategy<Value = [Place; 3]> {
    prop::array::uniform3(place())
}

/// The point at these places of an unrotated tile.
pub fn point(tile: &Tile, places: [Place; 3]) -> DVec3 {
    DVec3::from([0, 1, 2].map(|axis: usize| places[axis].coordinate(tile.position()[axis], tile.size()[axis])))
}

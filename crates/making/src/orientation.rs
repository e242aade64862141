//! The ways in which a cuboid fits an upright box.

use glam::{DMat3, DVec3};

/// A rotation that maps axes onto axes: one of 24. It turns vectors of a tile as it was measured into the
/// frame of its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Orientation {
    /// The axis of the measured tile that lies along each axis of the place.
    order: [u8; 3],
    /// Whether it points the other way.
    reversed: [bool; 3],
}

impl Orientation {
    /// As measured.
    pub const AS_MEASURED: Orientation = Orientation { order: [0, 1, 2], reversed: [false; 3] };

    /// All 24, as measured first, then those that leave the upper side up.
    pub fn all() -> Vec<Orientation> {
        const ORDERS: [[u8; 3]; 6] = [[0, 1, 2], [1, 0, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0]];
        let mut all: Vec<Orientation> = ORDERS
            .into_iter()
            .flat_map(|order| (0..8_u8).map(move |signs| (order, [0, 1, 2].map(|axis| signs >> axis & 1 == 1))))
            .map(|(order, reversed)| Orientation { order, reversed })
            .filter(|orientation| orientation.matrix().determinant() > 0.0)
            .collect();
        all.sort_by_key(|orientation| !orientation.keeps_upper_side());
        all
    }

    /// A vector of the measured tile in the frame of its place.
    pub fn apply(&self, v: DVec3) -> DVec3 {
        DVec3::from([0, 1, 2].map(|axis| {
            let component = v[usize::from(self.order[axis])];
            if self.reversed[axis] { -component } else { component }
        }))
    }

    /// Sides of the measured tile along the axes of its place.
    pub fn sides(&self, size: DVec3) -> DVec3 {
        self.apply(size).abs()
    }

    /// Whether the upper side of the measured tile is the upper side at its place.
    pub fn keeps_upper_side(&self) -> bool {
        self.order[2] == 2 && !self.reversed[2]
    }

    /// The angle about z by which the tile is turned after it was turned over about its x axis, if it was:
    /// 0, 90, 180 or 270 degrees. `None` for a tile that stands on another side.
    pub fn turn_deg(&self) -> Option<u16> {
        if self.order[2] != 2 {
            return None;
        }
        // Where the x axis of the tile points, which turning over about it leaves.
        let x = self.apply(DVec3::X);
        Some(match (x.x > 0.5, x.y > 0.5, x.x < -0.5) {
            (true, ..) => 0,
            (_, true, _) => 90,
            (.., true) => 180,
            _ => 270,
        })
    }

    fn matrix(&self) -> DMat3 {
        DMat3::from_cols(self.apply(DVec3::X), self.apply(DVec3::Y), self.apply(DVec3::Z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_24_rotations_four_of_which_leave_the_upper_side_up() {
        let all = Orientation::all();
        assert_eq!((all.len(), all[0]), (24, Orientation::AS_MEASURED));
        for (n, one) in all.iter().enumerate() {
            assert!(all[..n].iter().all(|other| other != one));
            let turned = one.apply(DVec3::X).cross(one.apply(DVec3::Y));
            assert_eq!(turned, one.apply(DVec3::Z));
        }
        assert_eq!(all.iter().filter(|orientation| orientation.keeps_upper_side()).count(), 4);
    }

    /// Turning over about x, then about z by the angle, is the orientation.
    #[test]
    fn flat_orientations_are_turns() {
        let flat: Vec<Orientation> = Orientation::all().into_iter().filter(|o| o.turn_deg().is_some()).collect();
        assert_eq!(flat.len(), 8);
        for orientation in flat {
            let angle = f64::from(orientation.turn_deg().unwrap()).to_radians();
            for v in DVec3::AXES {
                let over = if orientation.keeps_upper_side() { v } else { DVec3::new(v.x, -v.y, -v.z) };
                let turned = DMat3::from_rotation_z(angle) * over;
                assert!((turned - orientation.apply(v)).length() < 1e-15, "{orientation:?}");
            }
        }
    }
}

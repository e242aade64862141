//! The orientations of a cuboid in an upright box.

use glam::{DMat3, DVec3};
use magsplice_magnet::Tile;

/// Largest relative difference of sides and directions of one sort of pieces, which agree to nine
/// digits.
const ALIKE: f64 = 1e-8;

/// One of the 24 rotations that map axes onto axes. It maps vectors from the frame of a measured
/// tile to the frame of its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Orientation {
    /// The axis of the measured tile along each axis of the place.
    order: [u8; 3],
    /// Whether that axis is reversed.
    reversed: [bool; 3],
}

impl Orientation {
    /// The orientation as measured.
    pub const AS_MEASURED: Orientation = Orientation { order: [0, 1, 2], reversed: [false; 3] };

    /// All 24 orientations: as measured, then the others that keep the upper side up, then the
    /// rest.
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

    /// The first orientation in which a piece with this unit direction of the polarization and
    /// these sides is the piece of a place. `None` if no orientation gives both, such as for a
    /// reversed polarization along no axis of symmetry.
    pub fn between(direction: DVec3, sides: DVec3, place: &Tile) -> Option<Orientation> {
        let at_place = place.polarization_t().normalize_or_zero();
        let is_alike = |a: DVec3, b: DVec3| a.distance(b) <= ALIKE * b.length();
        let fits = |orientation: &Orientation| {
            is_alike(orientation.sides(sides), place.size()) && is_alike(orientation.apply(direction), at_place)
        };
        Orientation::all().into_iter().find(fits)
    }

    /// Maps a vector of the measured tile to the frame of its place.
    pub fn apply(&self, v: DVec3) -> DVec3 {
        DVec3::from([0, 1, 2].map(|axis| {
            let component = v[usize::from(self.order[axis])];
            if self.reversed[axis] { -component } else { component }
        }))
    }

    /// Maps a vector in the frame of the place to the frame of the measured tile.
    pub fn undo(&self, v: DVec3) -> DVec3 {
        let mut own = DVec3::ZERO;
        for axis in 0..3 {
            own[usize::from(self.order[axis])] = if self.reversed[axis] { -v[axis] } else { v[axis] };
        }
        own
    }

    /// Sides of the measured tile along the axes of its place.
    pub fn sides(&self, size: DVec3) -> DVec3 {
        self.apply(size).abs()
    }

    /// Whether the upper side of the measured tile is the upper side at its place.
    pub fn keeps_upper_side(&self) -> bool {
        self.order[2] == 2 && !self.reversed[2]
    }

    /// The axis of the measured tile, 0 to 2, that points up at its place, and whether it points
    /// down instead.
    pub fn upper_side(&self) -> (usize, bool) {
        (usize::from(self.order[2]), self.reversed[2])
    }

    /// The name of the upward side of the measured tile, such as `+z`.
    pub fn upper_side_name(&self) -> &'static str {
        let (axis, is_down) = self.upper_side();
        [["+x", "-x"], ["+y", "-y"], ["+z", "-z"]][axis][usize::from(is_down)]
    }

    /// The direction of a tile's mark at a place, in degrees from the x axis of the film towards
    /// its y axis, from 0 to below 360.
    pub fn mark_deg(&self, place: &Tile) -> f64 {
        let along = place.rotation() * self.mark_direction();
        along.y.atan2(along.x).to_degrees().rem_euclid(360.0)
    }

    /// The axis of the measured tile along its mark: x, or y if x is upright.
    pub fn mark_axis(&self) -> usize {
        usize::from(self.order[2] == 0)
    }

    /// The direction of the mark's axis at the place: along x or y, or against them.
    pub fn mark_direction(&self) -> DVec3 {
        self.apply(DVec3::AXES[self.mark_axis()])
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
            let vector = DVec3::new(1.0, -2.0, 3.0);
            assert_eq!(one.undo(one.apply(vector)), vector);
            let turned = one.apply(DVec3::X).cross(one.apply(DVec3::Y));
            assert_eq!(turned, one.apply(DVec3::Z));
        }
        assert_eq!(all.iter().filter(|orientation| orientation.keeps_upper_side()).count(), 4);
    }

    /// A piece with J at 45 degrees is laid at its place in the orientation of the place.
    #[test]
    fn a_piece_is_turned_to_its_place() {
        let sides = DVec3::new(3.0, 3.0, 1.0);
        let diagonal = DVec3::new(1.0, 1.0, 0.0).normalize();
        let place = |j_t| Tile::new(DVec3::ZERO, sides, j_t).unwrap();
        let turned = |j_t| Orientation::between(diagonal, sides, &place(j_t)).map(|found| found.mark_deg(&place(j_t)));
        assert_eq!(turned(DVec3::new(0.2, 0.2, 0.0)), Some(0.0));
        assert_eq!(turned(DVec3::new(-0.2, -0.2, 0.0)), Some(180.0));
        assert_eq!(turned(DVec3::new(-0.2, 0.2, 0.0)), Some(90.0));
        assert_eq!(turned(DVec3::X), None);
        assert_eq!(Orientation::between(diagonal, DVec3::new(3.0, 2.0, 1.0), &place(DVec3::X)), None);
    }

    /// The upward side and the direction of the mark distinguish all orientations.
    #[test]
    fn orientations_are_told_by_their_upper_side_and_mark() {
        let all = Orientation::all();
        for one in &all {
            let (axis, is_down) = one.upper_side();
            let up = one.apply(DVec3::AXES[axis]);
            assert_eq!(up, if is_down { -DVec3::Z } else { DVec3::Z });
            assert_eq!(one.mark_direction().z, 0.0);
            assert_ne!(axis, one.mark_axis());
            let told = |other: &&Orientation| {
                (other.upper_side(), other.mark_direction()) == (one.upper_side(), one.mark_direction())
            };
            assert_eq!(all.iter().filter(told).count(), 1);
        }
    }
}

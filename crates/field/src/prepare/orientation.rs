//! Rotations that share a frame: rotations that are equal up to quarter turns.
//!
//! A cuboid turned by a multiple of 90 degrees is a cuboid with permuted sizes. Tiles whose
//! rotations differ by quarter turns therefore share a frame. Frames with a common axis, such as
//! those of tiles turned about z, share the coordinates along it, so that faces of touching tiles
//! can be compared and seams between them found.

use glam::{DMat3, DQuat, DVec3};
use rustc_hash::FxHashMap;

use magsplice_magnet::tolerances::SAME_ROTATION;

use crate::tolerances::DIRECTION_CELL;

/// A rotation that maps axes onto axes: own axis `c` points along `sign[c]` times frame axis
/// `axis[c]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct QuarterTurn {
    axis: [usize; 3],
    sign: [f64; 3],
}

impl QuarterTurn {
    /// A vector of the tile's own frame in the shared frame, without rounding.
    pub(crate) fn vector(&self, own: DVec3) -> DVec3 {
        let mut turned = DVec3::ZERO;
        for c in 0..3 {
            turned[self.axis[c]] = self.sign[c] * own[c];
        }
        turned
    }

    /// Side lengths of the tile along the axes of the shared frame.
    pub(crate) fn size(&self, own: DVec3) -> DVec3 {
        self.vector(own).abs()
    }
}

/// The directions and frames of a scene.
pub(crate) struct Orientations {
    /// Directions of all axes, each towards +x, or +y if its x component is zero, or +z. The first
    /// three are x, y, z.
    pub(crate) directions: Vec<DVec3>,
    /// Indices of the three directions of each frame. The first frame is that of the scene.
    pub(crate) frames: Vec<[usize; 3]>,
    /// Frame of each rotation, and its quarter turn within the frame.
    pub(crate) members: Vec<(usize, QuarterTurn)>,
}

impl Orientations {
    pub(crate) fn new(rotations: &[DQuat]) -> Orientations {
        let mut directions = Directions::default();
        for axis in DVec3::AXES {
            directions.index_and_sign(axis);
        }
        let mut frames = vec![[0, 1, 2]];
        let mut known = FxHashMap::from_iter([([0, 1, 2], 0)]);
        let mut members = Vec::with_capacity(rotations.len());
        for rotation in rotations {
            let matrix = DMat3::from_quat(*rotation);
            let own = [0, 1, 2].map(|axis| directions.index_and_sign(matrix.col(axis)));
            let mut axes = own.map(|(index, _)| index);
            axes.sort_unstable();
            let frame = *known.entry(axes).or_insert_with(|| {
                frames.push(axes);
                frames.len() - 1
            });
            let place = |index: usize| axes.iter().position(|&axis| axis == index).expect("the frame has this axis");
            let turn = QuarterTurn { axis: own.map(|(index, _)| place(index)), sign: own.map(|(_, sign)| sign) };
            members.push((frame, turn));
        }
        Orientations { directions: directions.found, frames, members }
    }

    /// Matrix from the frame to the scene. Its columns need not be right-handed.
    pub(crate) fn matrix(&self, frame: usize) -> DMat3 {
        let [x, y, z] = self.frames[frame].map(|axis| self.directions[axis]);
        DMat3::from_cols(x, y, z)
    }
}

/// Directions found so far, with a lookup by their components.
#[derive(Default)]
struct Directions {
    found: Vec<DVec3>,
    by_cell: FxHashMap<[i64; 3], Vec<usize>>,
}

impl Directions {
    /// Index of a direction or its opposite, and which of the two it is. An unknown direction is
    /// added.
    fn index_and_sign(&mut self, axis: DVec3) -> (usize, f64) {
        let leading = axis.to_array().into_iter().find(|c| c.abs() > SAME_ROTATION).unwrap_or(1.0);
        let sign = leading.signum();
        let direction = axis * sign;
        let close = |i: &&usize| (self.found[**i] - direction).abs().max_element() <= SAME_ROTATION;
        // A direction is filed under the cell of its components. A direction equal up to round-off
        // may lie in a neighbouring cell.
        let [low, high] = [-SAME_ROTATION, SAME_ROTATION].map(|shift| cell(direction + DVec3::splat(shift)));
        for corner in 0..8_usize {
            let key = [0, 1, 2].map(|axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] });
            if let Some(&known) = self.by_cell.get(&key).and_then(|near| near.iter().find(close)) {
                return (known, sign);
            }
        }
        self.found.push(direction);
        self.by_cell.entry(cell(direction)).or_default().push(self.found.len() - 1);
        (self.found.len() - 1, sign)
    }
}

fn cell(direction: DVec3) -> [i64; 3] {
    direction.to_array().map(|c| (c / DIRECTION_CELL).floor() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_rotations_share_a_frame_up_to_quarter_turns() {
        let oblique = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
        let other = DQuat::from_rotation_z(1e-6);
        let half = DQuat::from_rotation_x(std::f64::consts::PI);
        let eighth = DQuat::from_rotation_y(std::f64::consts::FRAC_PI_4);
        let rotations = [half, oblique, other, oblique * half, eighth, eighth.inverse(), oblique * other];
        let found = Orientations::new(&rotations);
        let frame = |i: usize| found.members[i].0;
        assert_eq!(frame(0), 0);
        assert_eq!(frame(1), frame(3));
        assert_eq!(frame(4), frame(5));
        assert_eq!(found.frames.len(), 5);
        assert_eq!(found.members[0].1.vector(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(1.0, -2.0, -3.0));
        assert_eq!(found.frames[0], [0, 1, 2]);
    }

    /// Rotations closer than, about, and further than what counts as one.
    #[test]
    fn nearly_equal_rotations() {
        let axis = DVec3::new(1.0, 2.0, 3.0).normalize();
        let mut rotations = Vec::new();
        for n in 0..400 {
            rotations.push(DQuat::from_axis_angle(axis, 0.5 + 1e-16 * f64::from(n)));
        }
        let step = DQuat::from_axis_angle(axis, 10_f64.to_radians());
        let mut turned = DQuat::IDENTITY;
        for _ in 0..360 {
            turned = (turned * step).normalize();
            rotations.push(turned);
        }
        let found = Orientations::new(&rotations);
        for (rotation, (frame, turn)) in rotations.iter().zip(&found.members) {
            let own = DVec3::new(0.3, -0.4, 0.5);
            let error = found.matrix(*frame) * turn.vector(own) - *rotation * own;
            assert!(error.abs().max_element() <= 2.0 * SAME_ROTATION);
        }
    }

    #[test]
    fn frames_turned_about_one_axis_share_it() {
        let about_z = [0.3, -1.9, 2.5].map(DQuat::from_rotation_z);
        let upside_down = DQuat::from_rotation_z(0.8) * DQuat::from_rotation_x(std::f64::consts::PI);
        let found = Orientations::new(&[about_z[0], about_z[1], about_z[2], upside_down]);
        assert!(found.members.iter().all(|(frame, _)| found.frames[*frame].contains(&2)));
        assert_eq!(found.directions.len(), 3 + 4 * 2);
        assert!(found.directions.iter().all(|d| d.x > 0.0 || (d.x == 0.0 && (d.y > 0.0 || (d.y == 0.0 && d.z > 0.0)))));
    }
}

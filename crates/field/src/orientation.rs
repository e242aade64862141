//! Which tiles share a frame: equal rotations, up to quarter turns.
//!
//! A cuboid turned by a multiple of 90 degrees is a cuboid with permuted sizes, so tiles whose rotations differ by quarter
//! turns are computed in one frame. Frames that have an axis in common, such as those of tiles turned about z, share the numbers
//! along it. So faces of touching tiles can be compared, and a seam between them found.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::{DMat3, DQuat, DVec3};

use crate::tolerances::SAME_ROTATION;

/// A rotation that maps axes onto axes: own axis `c` points along `sign[c]` times frame axis `axis[c]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct QuarterTurn {
    axis: [usize; 3],
    sign: [f64; 3],
}

impl QuarterTurn {
    /// The quarter turn nearest to `matrix`, if it is one up to round-off.
    fn of(matrix: DMat3) -> Option<QuarterTurn> {
        let mut turn = QuarterTurn { axis: [0; 3], sign: [1.0; 3] };
        for own in 0..3 {
            let column = matrix.col(own);
            let axis = (0..3).find(|&row| (column[row].abs() - 1.0).abs() <= SAME_ROTATION)?;
            if (0..3).any(|row| row != axis && column[row].abs() > SAME_ROTATION) {
                return None;
            }
            turn.axis[own] = axis;
            turn.sign[own] = column[axis].signum();
        }
        Some(turn)
    }

    /// A vector of the tile's own frame in the shared frame, exactly.
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
    /// Directions of all axes, each pointing towards +x, or +y if it has no x part, or +z. The first three are x, y, z.
    pub(crate) directions: Vec<DVec3>,
    /// Indices of the three directions of each frame. The first frame is the scene's own.
    pub(crate) frames: Vec<[usize; 3]>,
    /// For each rotation its frame and its turn within.
    pub(crate) members: Vec<(usize, QuarterTurn)>,
}

impl Orientations {
    pub(crate) fn of(rotations: &[DQuat]) -> Orientations {
        let mut found = Orientations {
            directions: DVec3::AXES.to_vec(),
            frames: vec![[0, 1, 2]],
            members: vec![(0, QuarterTurn { axis: [0; 3], sign: [1.0; 3] }); rotations.len()],
        };
        let mut by_x = vec![2, 1, 0];
        let turns = quarter_turns();
        // The angle to the nearest quarter turn is the same for all members of a frame; sorting by it keeps the search short.
        let nearness = |q: DQuat| turns.iter().map(|t| q.dot(*t).abs()).fold(0.0, f64::max);
        let mut order: Vec<(f64, usize)> = rotations.iter().map(|q| nearness(*q)).zip(0..).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut recent: Vec<(f64, usize)> = Vec::new();
        for (near, index) in order {
            let matrix = DMat3::from_quat(rotations[index]);
            recent.retain(|&(other, _)| near - other <= SAME_ROTATION);
            let candidates = std::iter::once(0).chain(recent.iter().map(|&(_, frame)| frame));
            let turn_in = |frame: usize| QuarterTurn::of(found.matrix(frame).transpose() * matrix);
            let known = candidates.filter_map(|frame| Some((frame, turn_in(frame)?))).next();
            found.members[index] = known.unwrap_or_else(|| {
                let axes = [0, 1, 2].map(|own| found.direction(matrix.col(own), &mut by_x));
                found.frames.push(axes);
                let frame = found.frames.len() - 1;
                recent.push((near, frame));
                let turn = QuarterTurn::of(found.matrix(frame).transpose() * matrix);
                (frame, turn.expect("the frame was made of these axes"))
            });
        }
        found
    }

    /// From the frame to the scene. Its columns need not be right-handed.
    pub(crate) fn matrix(&self, frame: usize) -> DMat3 {
        let [x, y, z] = self.frames[frame].map(|axis| self.directions[axis]);
        DMat3::from_cols(x, y, z)
    }

    /// The index of a direction or its opposite, known or new. `by_x` holds all indices ordered by x.
    fn direction(&mut self, axis: DVec3, by_x: &mut Vec<usize>) -> usize {
        let leading = axis.to_array().into_iter().find(|c| c.abs() > SAME_ROTATION).unwrap_or(1.0);
        let direction = axis * leading.signum();
        let first = by_x.partition_point(|&i| self.directions[i].x < direction.x - SAME_ROTATION);
        let near = by_x[first..].iter().take_while(|&&i| self.directions[i].x <= direction.x + SAME_ROTATION);
        let close = |i: &&usize| (self.directions[**i] - direction).abs().max_element() <= SAME_ROTATION;
        if let Some(&known) = near.clone().find(close) {
            return known;
        }
        self.directions.push(direction);
        let place = by_x.partition_point(|&i| self.directions[i].x < direction.x);
        by_x.insert(place, self.directions.len() - 1);
        self.directions.len() - 1
    }
}

/// The 24 rotations of a cube.
fn quarter_turns() -> Vec<DQuat> {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let quarter = |axis: DVec3| {
        DQuat::from_xyzw(axis.x * FRAC_1_SQRT_2, axis.y * FRAC_1_SQRT_2, axis.z * FRAC_1_SQRT_2, FRAC_1_SQRT_2)
    };
    let mut turns = Vec::new();
    for to_top in [DQuat::IDENTITY, quarter(x), quarter(x) * quarter(x), quarter(-x), quarter(y), quarter(-y)] {
        let mut spin = DQuat::IDENTITY;
        for _ in 0..4 {
            turns.push(to_top * spin);
            spin *= quarter(z);
        }
    }
    turns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_has_24_different_turns() {
        let turns = quarter_turns();
        let matrices: std::collections::BTreeSet<String> =
            turns.iter().map(|q| format!("{:?}", QuarterTurn::of(DMat3::from_quat(*q)).unwrap())).collect();
        assert_eq!((turns.len(), matrices.len()), (24, 24));
    }

    #[test]
    fn equal_rotations_share_a_frame_up_to_quarter_turns() {
        let oblique = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
        let other = DQuat::from_rotation_z(1e-6);
        let half = DQuat::from_rotation_x(std::f64::consts::PI);
        let eighth = DQuat::from_rotation_y(std::f64::consts::FRAC_PI_4);
        let rotations = [half, oblique, other, oblique * half, eighth, eighth.inverse(), oblique * other];
        let found = Orientations::of(&rotations);
        let frame = |i: usize| found.members[i].0;
        assert_eq!(frame(0), 0);
        assert_eq!(frame(1), frame(3));
        assert_eq!(frame(4), frame(5));
        assert_eq!(found.frames.len(), 5);
        assert_eq!(found.members[0].1.vector(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(1.0, -2.0, -3.0));
    }

    #[test]
    fn frames_turned_about_one_axis_share_it() {
        let about_z = [0.3, -1.9, 2.5].map(DQuat::from_rotation_z);
        let upside_down = DQuat::from_rotation_z(0.8) * DQuat::from_rotation_x(std::f64::consts::PI);
        let found = Orientations::of(&[about_z[0], about_z[1], about_z[2], upside_down]);
        assert!(found.members.iter().all(|(frame, _)| found.frames[*frame].contains(&2)));
        assert_eq!(found.directions.len(), 3 + 4 * 2);
        assert!(found.directions.iter().all(|d| d.x > 0.0 || (d.x == 0.0 && (d.y > 0.0 || (d.y == 0.0 && d.z > 0.0)))));
    }
}

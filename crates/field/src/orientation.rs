//! Which tiles share a frame: equal rotations, up to quarter turns.
//!
//! A cuboid turned by a multiple of 90 degrees is a cuboid with permuted sizes, so tiles whose rotations differ by quarter
//! turns are computed in one frame. There their faces can be compared, and a seam between them found.

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

/// For each rotation, the index of its frame and its turn within; and the frames, the first of them the scene's own.
pub(crate) fn frames(rotations: &[DQuat]) -> (Vec<(usize, QuarterTurn)>, Vec<DMat3>) {
    let mut frames = vec![DMat3::IDENTITY];
    let turns = quarter_turns();
    // The angle to the nearest quarter turn is the same for all members of a frame; sorting by it keeps the search short.
    let nearness = |q: DQuat| turns.iter().map(|t| q.dot(*t).abs()).fold(0.0, f64::max);
    let mut order: Vec<(f64, usize)> = rotations.iter().map(|q| nearness(*q)).zip(0..).collect();
    order.sort_by(|a, b| a.partial_cmp(b).expect("norms are finite"));
    let mut members = vec![None; rotations.len()];
    let mut open: Vec<(f64, usize)> = Vec::new();
    for (near, index) in order {
        let matrix = DMat3::from_quat(rotations[index]);
        open.retain(|&(other, _)| near - other <= SAME_ROTATION);
        let candidates = std::iter::once(0).chain(open.iter().map(|&(_, frame)| frame));
        let found =
            candidates.filter_map(|frame| Some((frame, QuarterTurn::of(frames[frame].transpose() * matrix)?))).next();
        members[index] = Some(found.unwrap_or_else(|| {
            frames.push(matrix);
            open.push((near, frames.len() - 1));
            (frames.len() - 1, QuarterTurn { axis: [0, 1, 2], sign: [1.0; 3] })
        }));
    }
    (members.into_iter().map(|m| m.expect("every index is in the order once")).collect(), frames)
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
        let (members, frames) = frames(&rotations);
        let of = |i: usize| members[i].0;
        assert_eq!(of(0), 0);
        assert_eq!(of(1), of(3));
        assert_eq!(of(4), of(5));
        assert_eq!(frames.len(), 5);
        assert_eq!(members[0].1.vector(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(1.0, -2.0, -3.0));
    }
}

//! Second derivatives of B with respect to the positions of the faces of a tile.
//!
//! The first derivatives are sums over the twelve edges (docs/physics.md, section 6.1). Each edge
//! depends on the four faces that bound it, through its ends and its distance from the point, so
//! the second derivatives are sums over the same edges.

use std::f64::consts::PI;

use glam::{DMat3, DQuat, DVec3};
use magsplice_magnet::Tile;

use crate::face_derivatives::segment;

/// The second derivatives of B at a point with respect to the positions of the faces of a tile.
/// They are linear in the polarization.
///
/// # Units
/// Tesla per square of the unit of length, in the frame of the scene. The faces are normal to the
/// tile's own axes.
///
/// # Accuracy
/// The error is at most 64 units of round-off of the sum of the contributions of the twelve edges.
/// Far away the edges cancel: at a distance of r sizes the error is about r units of round-off of
/// the largest second derivative.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use magsplice_cuboid::FaceHessian;
/// use magsplice_magnet::Tile;
///
/// let tile = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::Z).unwrap();
/// let hessian = FaceHessian::new(&tile, DVec3::new(0.0, 0.0, 2.0)).unwrap();
/// // A wider tile has more field, so a near pole that comes nearer adds more to it.
/// assert!(hessian.get([2, 1], [0, 1]).z > 0.0);
/// // The order of derivatives does not matter.
/// assert!((hessian.get([2, 1], [0, 1]) - hessian.get([0, 1], [2, 1])).length() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceHessian {
    /// The derivatives by two faces, each with the index 2 axis + side.
    second: [[DVec3; 6]; 6],
}

impl FaceHessian {
    /// The derivatives at a point; `None` on an edge of the tile, where they are unbounded, and
    /// where they overflow.
    pub fn new(tile: &Tile, point: DVec3) -> Option<FaceHessian> {
        let unrotated = tile.rotation() == DQuat::IDENTITY;
        let from_centre = point - tile.position();
        let local = if unrotated { from_centre } else { tile.rotation().inverse() * from_centre };
        // In units of the largest, so that no power overflows.
        let half = 0.5 * tile.size();
        let to_faces = [-half - local, half - local];
        let unit = to_faces[0].abs().max_element().max(to_faces[1].abs().max_element());
        let mut second = of_edges(&to_faces.map(|to| to / unit), tile.polarization_t())?;
        let factor = 1.0 / (4.0 * PI * unit * unit);
        let turn = DMat3::from_quat(tile.rotation());
        for value in second.iter_mut().flatten() {
            *value *= factor;
            if !unrotated {
                *value = turn * *value;
            }
        }
        second.iter().flatten().all(|value| value.is_finite()).then_some(FaceHessian { second })
    }

    /// The derivative with respect to two faces, each given by its normal axis and its side: 0 for
    /// the lower, 1 for the upper face.
    ///
    /// # Panics
    /// If an axis is above 2 or a side above 1.
    pub fn get(&self, [axis, side]: [usize; 2], [other_axis, other_side]: [usize; 2]) -> DVec3 {
        assert!(side < 2 && other_side < 2, "a face is the lower or the upper one");
        self.second[2 * axis + side][2 * other_axis + other_side]
    }
}

/// 4 pi times the second derivatives, from the vectors to the lower and upper faces.
fn of_edges(to_faces: &[DVec3; 2], j: DVec3) -> Option<[[DVec3; 6]; 6]> {
    let mut second = [[DVec3::ZERO; 6]; 6];
    for axis in 0..3 {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        for (i, k) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let sign = if i == k { 1.0 } else { -1.0 };
            let ends = to_faces.map(|to| to[axis]);
            let (y, z) = (to_faces[i][next], to_faces[k][last]);
            let edge = EdgeMoments::new(ends, y * y + z * z)?;
            // The edge depends on these faces.
            let faces = [2 * axis, 2 * axis + 1, 2 * next + i, 2 * last + k];
            let by_across = edge.across_derivatives(y, z);
            let by_lengthwise = edge.lengthwise_derivatives(ends, y, z);
            let (across, j_next, j_last) = (edge.across, sign * j[next], sign * j[last]);
            for (number, &face) in faces.iter().enumerate() {
                let (dy, dz) = (f64::from(number == 2), f64::from(number == 3));
                let (d_across, d_lengthwise) = (by_across[number], by_lengthwise[number]);
                // Both faces that meet in the edge: the current of one is the charge of the other.
                let along = (j_next * y + j_last * z) * d_across + (j_next * dy + j_last * dz) * across;
                let around = (j_next * z - j_last * y) * d_across + (j_next * dz - j_last * dy) * across;
                let of_next = &mut second[2 * next + i][face];
                of_next[axis] -= j_last * d_lengthwise;
                of_next[next] += around;
                of_next[last] -= along;
                let of_last = &mut second[2 * last + k][face];
                of_last[axis] -= j_next * d_lengthwise;
                of_last[next] -= along;
                of_last[last] -= around;
            }
        }
    }
    Some(second)
}

/// Integrals over an edge, and the integrand at its ends.
struct EdgeMoments {
    /// Integral of 1 / r^3.
    across: f64,
    /// Integral of 1 / r^5.
    fifth: f64,
    /// Integral of t / r^5.
    fifth_lengthwise: f64,
    /// 1 / r^3 at the ends.
    at_ends: [f64; 2],
}

impl EdgeMoments {
    /// The integrals over t between the ends, r^2 = t^2 + rho^2, without cancellation (Eqs. P32,
    /// P63 and P64); `None` where they are unbounded.
    fn new([from, to]: [f64; 2], rho_squared: f64) -> Option<EdgeMoments> {
        let (across, _) = segment([from, to], rho_squared)?;
        let [from_squared, to_squared] = [from, to].map(|t| t * t + rho_squared);
        let (r_from, r_to) = (from_squared.sqrt(), to_squared.sqrt());
        let product = r_from * r_to;
        let middle = if from * to > 0.0 {
            (rho_squared + from * from + to * to) / (product * (product + from * to))
        } else {
            (1.0 - from * to / product) / rho_squared
        };
        let fifth = across / 3.0 * (1.0 / from_squared + 1.0 / to_squared + middle);
        let step = (to - from) * (to + from) / (r_from + r_to);
        let cube = product * product * product;
        let fifth_lengthwise = step * (from_squared + product + to_squared) / (3.0 * cube);
        let at_ends = [1.0 / (from_squared * r_from), 1.0 / (to_squared * r_to)];
        (fifth.is_finite() && fifth_lengthwise.is_finite() && at_ends.iter().all(|value| value.is_finite()))
            .then_some(EdgeMoments { across, fifth, fifth_lengthwise, at_ends })
    }

    /// Derivatives of the integral of 1 / r^3 by the ends, y and z.
    fn across_derivatives(&self, y: f64, z: f64) -> [f64; 4] {
        let [from, to] = self.at_ends;
        [-from, to, -3.0 * y * self.fifth, -3.0 * z * self.fifth]
    }

    /// Derivatives of the integral of t / r^3 by the ends, y and z.
    fn lengthwise_derivatives(&self, ends: [f64; 2], y: f64, z: f64) -> [f64; 4] {
        let [from, to] = self.at_ends;
        [-ends[0] * from, ends[1] * to, -3.0 * y * self.fifth_lengthwise, -3.0 * z * self.fifth_lengthwise]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::face_derivatives::FaceDerivatives;

    /// A tile in any rotation, and points beside edges, inside, on extensions of edges and far
    /// away.
    fn cases() -> Vec<(Tile, DVec3)> {
        let size = DVec3::new(3.0, 2.0, 1.0);
        let turns = [DQuat::IDENTITY, DQuat::from_scaled_axis(DVec3::new(0.3, -0.5, 0.2))];
        let points = [
            DVec3::new(0.3, -0.2, -3.0),
            DVec3::new(2.0, 1.1, -0.8),
            DVec3::new(0.2, 0.1, 0.3),
            DVec3::new(4.0, 1.0, 0.5),
            DVec3::new(-9.0, 7.0, -5.0),
            DVec3::new(300.0, -200.0, 100.0),
        ];
        let tile = |turn: DQuat| {
            let tile = Tile::new(DVec3::new(0.1, 0.2, 0.3), size, DVec3::new(0.12, -0.07, 0.05));
            tile.and_then(|tile| tile.rotated(turn)).expect("valid")
        };
        let at = |turn: DQuat| points.map(|point| (tile(turn), tile(turn).position() + turn * point));
        turns.into_iter().flat_map(at).collect()
    }

    fn faces() -> impl Iterator<Item = [usize; 2]> {
        (0..3).flat_map(|axis| [[axis, 0], [axis, 1]])
    }

    fn largest(hessian: &FaceHessian) -> f64 {
        hessian.second.iter().flatten().map(|value| value.length()).fold(0.0, f64::max)
    }

    /// Distance in units of the longest side, at least 1: the factor by which the edges cancel.
    fn distance(tile: &Tile, point: DVec3) -> f64 {
        1.0_f64.max(point.distance(tile.position()) / tile.size().max_element())
    }

    fn with_face_moved(tile: &Tile, [axis, side]: [usize; 2], by: f64) -> Tile {
        let normal = DVec3::AXES[axis];
        let outwards = if side == 0 { -by } else { by };
        let position = tile.position() + tile.rotation() * normal * (0.5 * by);
        let moved = Tile::new(position, tile.size() + normal * outwards, tile.polarization_t());
        moved.and_then(|moved| moved.rotated(tile.rotation())).expect("valid")
    }

    /// With steps h of 1e-4, the error of four-point differences is the fifth derivative times h^4
    /// / 30, plus the round-off of the first derivatives (32 units for each edge at most, times the
    /// square of the distance) over h. The nearest edge is 0.58 away, so the truncation error is
    /// below 1e-14 times 5! / 0.58^4 of the second derivatives.
    #[test]
    fn second_derivatives_agree_with_differences_of_the_first() {
        let h = 1e-4;
        for (tile, point) in cases() {
            let hessian = FaceHessian::new(&tile, point).expect("off the edges");
            let round_off = 32.0 * f64::EPSILON / h * distance(&tile, point).powi(3);
            for other in faces() {
                let at =
                    |by: f64| FaceDerivatives::new(&with_face_moved(&tile, other, by), point).expect("off the edges");
                let [one, two] = [1.0, 2.0].map(|steps: f64| {
                    let (above, below) = (at(steps * h), at(-steps * h));
                    let difference = |above: DMat3, below: DMat3| (above - below) * (0.5 / (steps * h));
                    [difference(above.lower, below.lower), difference(above.upper, below.upper)]
                });
                for [axis, side] in faces() {
                    let difference = (4.0 * one[side].col(axis) - two[side].col(axis)) / 3.0;
                    let found = hessian.get([axis, side], other);
                    let error = difference.distance(found) / largest(&hessian);
                    assert!(error < 2e-11 + round_off, "{point}: {found} is not {difference}: {error:e}");
                }
            }
        }
    }

    /// Three laws hold to round-off. Derivatives commute; the field of a moved tile obeys Laplace's
    /// equation; B does not change with scale, so the second derivatives times the positions of the
    /// faces are minus the first derivatives.
    #[test]
    fn laws_hold_to_round_off() {
        for (tile, point) in cases() {
            let hessian = FaceHessian::new(&tile, point).expect("off the edges");
            let far = distance(&tile, point);
            let allowed = 64.0 * f64::EPSILON * far * largest(&hessian);
            for (one, other) in faces().flat_map(|one| faces().map(move |other| (one, other))) {
                let error = hessian.get(one, other).distance(hessian.get(other, one));
                assert!(error <= allowed, "{point}: order of {one:?} and {other:?}: {error:e}");
            }
            let moved = |axis: usize| {
                let sides = [[0, 0], [0, 1], [1, 0], [1, 1]];
                sides.map(|[one, other]| hessian.get([axis, one], [axis, other])).into_iter().sum::<DVec3>()
            };
            let laplacian = (0..3).map(moved).sum::<DVec3>().length();
            assert!(laplacian <= 4.0 * allowed, "{point}: {laplacian:e}");
            let first = FaceDerivatives::new(&tile, point).expect("off the edges");
            let local = tile.rotation().inverse() * (point - tile.position());
            let to_faces = [-0.5 * tile.size() - local, 0.5 * tile.size() - local];
            for [axis, side] in faces() {
                let scaled: DVec3 =
                    faces().map(|[by, end]| to_faces[end][by] * hessian.get([axis, side], [by, end])).sum();
                let first = [first.lower, first.upper][side].col(axis);
                let error = (scaled + first).length();
                let size = to_faces[0].abs().max_element().max(to_faces[1].abs().max_element());
                assert!(error <= 6.0 * size * allowed, "{point}: scale by {axis}, {side}: {error:e}");
            }
        }
    }

    #[test]
    fn there_are_none_on_an_edge() {
        let tile = Tile::new(DVec3::ZERO, DVec3::splat(2.0), DVec3::X).expect("valid");
        assert!(FaceHessian::new(&tile, DVec3::new(1.0, 1.0, 0.3)).is_none());
        assert!(FaceHessian::new(&tile, DVec3::new(1.0, 1.0, 1.0)).is_none());
        assert!(FaceHessian::new(&tile, DVec3::new(1.0, 1.0, 1.5)).is_some(), "on the extension of an edge");
    }
}

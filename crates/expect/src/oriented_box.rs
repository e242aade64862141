//! The distance of two cuboids in any orientation.

use glam::{DMat3, DVec3};
use magsplice_magnet::Tile;

/// A box with its own axes.
pub(crate) struct OrientedBox {
    centre: DVec3,
    half: DVec3,
    axes: DMat3,
}

impl OrientedBox {
    pub(crate) fn from_tile(tile: &Tile) -> OrientedBox {
        OrientedBox { centre: tile.position(), half: 0.5 * tile.size(), axes: DMat3::from_quat(tile.rotation()) }
    }

    pub(crate) fn between(lower: DVec3, upper: DVec3) -> OrientedBox {
        OrientedBox { centre: 0.5 * (lower + upper), half: 0.5 * (upper - lower), axes: DMat3::IDENTITY }
    }

    /// Whether the circumscribed spheres, and therefore the boxes, are at least this far apart.
    pub(crate) fn certainly_beyond(&self, other: &OrientedBox, distance: f64) -> bool {
        self.centre.distance(other.centre) - self.half.length() - other.half.length() >= distance
    }

    /// The distance of two disjoint boxes.
    ///
    /// The nearest points of two such convex bodies are a corner of one and a point of the other,
    /// or points on an edge of each.
    pub(crate) fn distance(&self, other: &OrientedBox) -> f64 {
        if self.axes == other.axes {
            let shift = self.axes.transpose() * (other.centre - self.centre);
            return (shift.abs() - (self.half + other.half)).max(DVec3::ZERO).length();
        }
        let corners = self.corners().map(|c| other.distance_to(c));
        let other_corners = other.corners().map(|c| self.distance_to(c));
        let other_edges = other.edges();
        let edges = self.edges().into_iter().flat_map(|a| other_edges.map(|b| a.distance(&b)));
        corners.into_iter().chain(other_corners).chain(edges).fold(f64::INFINITY, f64::min)
    }

    fn distance_to(&self, point: DVec3) -> f64 {
        let own = self.axes.transpose() * (point - self.centre);
        (own.abs() - self.half).max(DVec3::ZERO).length()
    }

    /// The corners. Corner `n` is at the upper end of axis `a` if bit `a` of `n` is set.
    fn corners(&self) -> [DVec3; 8] {
        [0, 1, 2, 3, 4, 5, 6, 7].map(|n: usize| {
            let sign = |axis: usize| if n >> axis & 1 == 1 { 1.0 } else { -1.0 };
            self.centre + self.axes * (self.half * DVec3::new(sign(0), sign(1), sign(2)))
        })
    }

    fn edges(&self) -> [BoxEdge; 12] {
        let corners = self.corners();
        std::array::from_fn(|n| {
            // Four edges along each axis begin at the corners at its lower end.
            let (axis, rest) = (n / 4, n % 4);
            let low = (rest & ((1 << axis) - 1)) | (rest >> axis << (axis + 1));
            BoxEdge { start: corners[low], along: corners[low | 1 << axis] - corners[low] }
        })
    }
}

#[derive(Clone, Copy)]
struct BoxEdge {
    start: DVec3,
    along: DVec3,
}

impl BoxEdge {
    /// The distance of two segments (Ericson, Real-Time Collision Detection, 5.1.9).
    fn distance(&self, other: &BoxEdge) -> f64 {
        let between = self.start - other.start;
        let (a, e) = (self.along.length_squared(), other.along.length_squared());
        let (c, f) = (self.along.dot(between), other.along.dot(between));
        let b = self.along.dot(other.along);
        let denominator = a * e - b * b;
        // Nearest points of parallel edges are anywhere along their common part, so the search may
        // begin at the start.
        let s = if denominator > 0.0 { ((b * f - c * e) / denominator).clamp(0.0, 1.0) } else { 0.0 };
        let t = ((b * s + f) / e).clamp(0.0, 1.0);
        let s = ((b * t - c) / a).clamp(0.0, 1.0);
        (between + s * self.along - t * other.along).length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;
    use proptest::prelude::*;

    fn oriented_box(size: DVec3, centre: DVec3, turn: DQuat) -> OrientedBox {
        OrientedBox { centre, half: 0.5 * size, axes: DMat3::from_quat(turn) }
    }

    #[test]
    fn twelve_edges_have_the_lengths_of_the_sides() {
        let c = oriented_box(DVec3::new(1.0, 2.0, 3.0), DVec3::ZERO, DQuat::IDENTITY);
        let mut lengths = c.edges().map(|e| e.along.length());
        lengths.sort_by(f64::total_cmp);
        assert_eq!(lengths, [1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 3.0]);
        let mut starts: Vec<String> = c.edges().iter().map(|e| format!("{} {}", e.start, e.along)).collect();
        starts.sort();
        starts.dedup();
        assert_eq!(starts.len(), 12);
    }

    /// The distance by alternating projection, which converges from above for convex bodies.
    fn by_projection(a: &OrientedBox, b: &OrientedBox) -> f64 {
        let onto = |c: &OrientedBox, p: DVec3| {
            c.centre + c.axes * (c.axes.transpose() * (p - c.centre)).clamp(-c.half, c.half)
        };
        let mut p = a.centre;
        for _ in 0..20_000 {
            p = onto(a, onto(b, p));
        }
        p.distance(onto(b, p))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]
        #[test]
        fn distance_agrees_with_alternating_projection(
            size in prop::array::uniform3(0.1..3.0_f64),
            way in prop::array::uniform3(-1.0..1.0_f64),
            angles in prop::array::uniform3(-3.0..3.0_f64),
        ) {
            let turn = DQuat::from_euler(glam::EulerRot::XYZ, angles[0], angles[1], angles[2]);
            let way = DVec3::from(way);
            prop_assume!(way.length() > 0.1);
            let a = oriented_box(DVec3::new(4.0, 4.0, 2.0), DVec3::ZERO, DQuat::IDENTITY);
            // The centre is far enough away for disjoint boxes.
            let b = oriented_box(size.into(), way.normalize() * 5.7, turn);
            let (found, projected) = (a.distance(&b), by_projection(&a, &b));
            // The distance is at most the distance of the two found points, minus at most the gain
            // of further projections.
            prop_assert!(found <= projected + 1e-13 && found >= projected - 1e-3, "{} and {}", found, projected);
        }
    }
}

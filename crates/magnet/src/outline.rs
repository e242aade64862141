//! Corners and outlines of cuboids.

use glam::{DVec2, DVec3};

use crate::tile::Tile;

impl Tile {
    /// The corners in the film's frame, in millimetres. Bits 0, 1 and 2 of the index choose the
    /// upper end along the x, y and z axis of the tile.
    pub fn corners_mm(&self) -> [DVec3; 8] {
        std::array::from_fn(|index| {
            let side = DVec3::from([0, 1, 2].map(|axis| if index >> axis & 1 == 1 { 0.5 } else { -0.5 }));
            self.position() + self.rotation() * (side * self.size())
        })
    }
}

/// The convex hull of points in a plane, counter-clockwise (Andrew's monotone chain). Three points
/// are on a line if twice the area between them is at most `slack`.
pub fn convex_hull(mut points: Vec<DVec2>, slack: f64) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(point - b) <= slack
            {
                chain.pop();
            }
            chain.push(point);
        }
        // The last point is the first of the other half.
        chain.pop();
        chain
    };
    let mut hull = half(&mut points.iter().copied());
    hull.extend(half(&mut points.iter().rev().copied()));
    hull
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;

    #[test]
    fn hull_of_the_corners_from_above_is_the_outline() {
        let tile = Tile::new(DVec3::new(1.0, 2.0, 0.5), DVec3::new(3.0, 2.0, 1.0), DVec3::X).unwrap();
        let from_above =
            |tile: Tile, slack| convex_hull(tile.corners_mm().map(|corner| corner.truncate()).to_vec(), slack);
        let corners = [(-0.5, 1.0), (2.5, 1.0), (2.5, 3.0), (-0.5, 3.0)].map(|(x, y)| DVec2::new(x, y));
        assert_eq!(from_above(tile, 0.0), corners);
        let turned = from_above(tile.rotated(DQuat::from_rotation_z(0.5)).unwrap(), 1e-9);
        assert_eq!(turned.len(), 4, "{turned:?}");
    }
}

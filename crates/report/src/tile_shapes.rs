//! Outlines of tiles: from above, and in the section by a plane.

use glam::{DVec2, DVec3};
use magsplice::magnet::{Tile, convex_hull};

/// The axis-aligned bounding box of all tiles: lower and upper corner. `None` without tiles.
pub(crate) fn bounds<'a>(tiles: impl Iterator<Item = &'a Tile>) -> Option<[DVec3; 2]> {
    tiles.flat_map(Tile::corners_mm).map(|c| [c, c]).reduce(|[low, high], [c, _]| [low.min(c), high.max(c)])
}

/// The outline of a tile from above, counter-clockwise, in the unit of its lengths.
pub fn from_above(tile: &Tile) -> Vec<DVec2> {
    convex_hull(tile.corners_mm().map(|corner| corner.truncate()).to_vec(), 0.0)
}

/// The section by the plane where coordinate `normal` is `at`, in the two other coordinates,
/// counter-clockwise. It has fewer than three corners if the plane misses the tile.
pub(crate) fn section(tile: &Tile, normal: usize, at: f64) -> Vec<DVec2> {
    let corners = tile.corners_mm();
    let [u, v] = in_plane(normal);
    let mut points = Vec::new();
    for from in 0..8 {
        for axis in 0..3 {
            let to = from | 1 << axis;
            let (a, b) = (corners[from], corners[to]);
            if to == from || (a[normal] - at) * (b[normal] - at) > 0.0 {
                continue;
            }
            let length = b[normal] - a[normal];
            // An edge that lies in the plane contributes both of its ends.
            for t in if length == 0.0 { [0.0, 1.0] } else { [(at - a[normal]) / length; 2] } {
                let point = a + t * (b - a);
                points.push(DVec2::new(point[u], point[v]));
            }
        }
    }
    convex_hull(points, 0.0)
}

/// The two axes other than `normal`, in ascending order.
pub(crate) fn in_plane(normal: usize) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][normal]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    fn area(polygon: &[DVec2]) -> f64 {
        let next = polygon.iter().cycle().skip(1);
        0.5 * polygon.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
    }

    #[test]
    fn outlines_and_sections_have_the_expected_area() {
        let tile = Tile::new(DVec3::new(1.0, 2.0, 0.5), DVec3::new(3.0, 2.0, 1.0), DVec3::X).unwrap();
        assert_eq!(from_above(&tile).len(), 4);
        assert!((area(&from_above(&tile)) - 6.0).abs() < 1e-12);
        assert!((area(&section(&tile, 1, 2.5)) - 3.0).abs() < 1e-12);
        assert!(section(&tile, 1, 3.5).len() < 3);
        let turned = tile.rotated(DQuat::from_rotation_z(0.5)).unwrap();
        assert!((area(&from_above(&turned)) - 6.0).abs() < 1e-12);
        // The section through the centre of a cube that stands on a corner is a hexagon.
        let cube = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::X).unwrap();
        let up = DQuat::from_rotation_arc(DVec3::ONE.normalize(), DVec3::Z);
        let hexagon = section(&cube.rotated(up).unwrap(), 2, 0.0);
        assert!((area(&hexagon) - 0.75 * 3.0_f64.sqrt()).abs() < 1e-12, "{hexagon:?}");
    }
}

//! Pairs of tiles that share volume.

use std::error::Error;
use std::fmt;

use glam::{DMat3, DVec3};
use rstar::{AABB, RTree, RTreeObject};

use crate::tile::Tile;
use crate::tolerances::{PARALLEL_EDGES, ROTATED_SEAM_ROUNDINGS, SAME_ROTATION, SEAM_ROUNDINGS, UNIT_ROUNDOFF};

/// Two tiles that share volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Index of the first tile.
    pub first: usize,
    /// Index of the second tile, greater than `first`.
    pub second: usize,
    /// The shortest move of one tile that ends the overlap, in the unit of the tiles.
    pub depth: f64,
    /// Unit vector along which the second tile must move.
    pub direction: DVec3,
}

/// The depth of the overlap of two tiles and the unit vector along which the second must move to
/// end it. `None` if they touch or overlap by no more than round-off.
pub fn overlap(first: &Tile, second: &Tile) -> Option<(f64, DVec3)> {
    Oriented::from_tile(first).penetration(&Oriented::from_tile(second))
}

/// All pairs of tiles that overlap by more than round-off, ordered by index, found lazily.
///
/// Candidates come from an R-tree over bounding boxes, so that the cost is about N log N for N
/// tiles that hardly overlap.
pub fn overlaps(tiles: &[Tile]) -> impl Iterator<Item = Overlap> {
    overlaps_among(tiles, usize::MAX).flatten()
}

/// [`overlaps`] that ends with an error after examining `most` pairs whose bounding boxes meet.
/// Disjoint tiles can form many such pairs: for example, long bars side by side, oblique to the
/// axes.
pub fn overlaps_among(tiles: &[Tile], most: usize) -> impl Iterator<Item = Result<Overlap, TooManyPairs>> {
    let boxes: Vec<Oriented> = tiles.iter().map(Oriented::from_tile).collect();
    let bounds = boxes.iter().enumerate().map(|(index, b)| IndexedBounds { low: b.low, high: b.high, index });
    let tree = RTree::bulk_load(bounds.collect());
    let mut left = Some(most);
    let pairs = (0..boxes.len()).map_while(move |first| {
        let own = &boxes[first];
        let envelope = AABB::from_corners(own.low.to_array(), own.high.to_array());
        let near = tree.locate_in_envelope_intersecting(envelope).map(|b| b.index);
        let mut later: Vec<usize> = near.filter(|&second| second > first).collect();
        left = left?.checked_sub(later.len());
        if left.is_none() {
            return Some(vec![Err(TooManyPairs)]);
        }
        later.sort_unstable();
        let found = later.into_iter().filter_map(|second| {
            let (depth, direction) = own.penetration(&boxes[second])?;
            Some(Ok(Overlap { first, second, depth, direction }))
        });
        Some(found.collect::<Vec<_>>())
    });
    pairs.flatten()
}

/// The limit of examined pairs was reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooManyPairs;

impl fmt::Display for TooManyPairs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("too many pairs of tiles may overlap")
    }
}

impl Error for TooManyPairs {}

/// A tile's bounds in the tree.
struct IndexedBounds {
    low: DVec3,
    high: DVec3,
    index: usize,
}

impl RTreeObject for IndexedBounds {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> AABB<[f64; 3]> {
        AABB::from_corners(self.low.to_array(), self.high.to_array())
    }
}

/// A tile as an oriented box with its bounds along x, y, z.
struct Oriented {
    centre: DVec3,
    axes: [DVec3; 3],
    half: DVec3,
    rotated: bool,
    low: DVec3,
    high: DVec3,
}

impl Oriented {
    fn from_tile(tile: &Tile) -> Oriented {
        let rotation = DMat3::from_quat(tile.rotation());
        let half = 0.5 * tile.size();
        let axes = [rotation.x_axis, rotation.y_axis, rotation.z_axis];
        let reach = axes[0].abs() * half.x + axes[1].abs() * half.y + axes[2].abs() * half.z;
        let centre = tile.position();
        // Quarter turns cause no round-off.
        let rotated = axes
            .iter()
            .any(|axis| axis.abs().to_array().iter().any(|c| (SAME_ROTATION..=1.0 - SAME_ROTATION).contains(c)));
        Oriented { centre, axes, half, rotated, low: centre - reach, high: centre + reach }
    }

    fn reach(&self, direction: DVec3) -> f64 {
        (0..3).map(|i| self.half[i] * self.axes[i].dot(direction).abs()).sum()
    }

    /// Depth and direction of the overlap by the separating-axis theorem (Gottschalk, Lin, Manocha
    /// 1996).
    fn penetration(&self, other: &Oriented) -> Option<(f64, DVec3)> {
        let shift = other.centre - self.centre;
        let crosses = self.axes.iter().flat_map(|a| other.axes.iter().map(move |b| a.cross(*b)));
        let candidates = self.axes.iter().chain(&other.axes).copied().chain(crosses);
        // Half the round-off that joins faces: touching faces of a pair that passes here are
        // joined.
        let reach = |o: &Oriented, d: DVec3| o.centre.dot(d).abs() + o.reach(d);
        let roundings = if self.rotated || other.rotated { ROTATED_SEAM_ROUNDINGS } else { SEAM_ROUNDINGS };
        let mut least: Option<(f64, DVec3)> = None;
        // Parallel edges have no common normal of their own; the face normals cover that case.
        for direction in candidates.filter(|d| d.length() > PARALLEL_EDGES).map(DVec3::normalize) {
            let along = shift.dot(direction);
            let depth = self.reach(direction) + other.reach(direction) - along.abs();
            if depth <= 0.5 * roundings * UNIT_ROUNDOFF * reach(self, direction).max(reach(other, direction)) {
                return None;
            }
            if least.is_none_or(|(d, _)| depth < d) {
                least = Some((depth, if along < 0.0 { -direction } else { direction }));
            }
        }
        least
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use glam::DQuat;
    fn overlaps(tiles: &[Tile]) -> Vec<Overlap> {
        super::overlaps(tiles).collect()
    }

    fn cube(x: f64, y: f64, angle_deg: f64) -> Tile {
        let tile = Tile::new(DVec3::new(x, y, 0.0), DVec3::ONE, DVec3::Z).unwrap();
        tile.rotated(DQuat::from_rotation_z(angle_deg.to_radians())).unwrap()
    }

    #[test]
    fn touching_tiles_do_not_overlap() {
        assert_eq!(
            overlaps(&[cube(0.1, 0.0, 0.0), cube(1.1, 0.0, 0.0), cube(0.1, 1.0, 90.0), cube(3.0, 0.0, 0.0)]),
            []
        );
    }

    /// Coordinates are rounded to 1e-16, so an overlap of 1e-12 is a mistake in the layout.
    #[test]
    fn only_round_off_is_forgiven() {
        for angle_deg in [0.0, 30.0] {
            let turned = |x: f64| {
                let [sin, cos] = [f64::sin, f64::cos].map(|f| f(f64::to_radians(angle_deg)));
                cube(x * cos, x * sin, angle_deg)
            };
            assert_eq!(overlaps(&[turned(0.0), turned(1.0 - 1e-16)]), []);
            assert_eq!(overlaps(&[turned(0.0), turned(1.0 - 1e-12)]).len(), 1, "{angle_deg}");
        }
    }

    #[test]
    fn depth_and_direction() {
        let found = overlaps(&[cube(5.0, 0.0, 0.0), cube(0.0, 0.0, 0.0), cube(-0.9, 0.2, 0.0)]);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].first, found[0].second), (1, 2));
        assert_relative_eq!(found[0].depth, 0.1, epsilon = 1e-15);
        assert_eq!(found[0].direction, -DVec3::X);
    }

    #[test]
    fn search_ends_when_too_many_boxes_meet() {
        // Parallel bars at 45 degrees: every bounding box meets every other.
        let bars = (0..30).map(|i| {
            let centre = DVec3::new(0.5_f64.sqrt(), -0.5_f64.sqrt(), 0.0) * f64::from(i);
            let bar = Tile::new(centre, DVec3::new(100.0, 0.5, 0.5), DVec3::Z).unwrap();
            bar.rotated(DQuat::from_rotation_z(45_f64.to_radians())).unwrap()
        });
        let bars: Vec<Tile> = bars.collect();
        assert_eq!(overlaps_among(&bars, 30 * 29 / 2).collect::<Vec<_>>(), []);
        assert_eq!(overlaps_among(&bars, 30 * 29 / 2 - 1).collect::<Vec<_>>(), [Err(TooManyPairs)]);
    }

    #[test]
    fn a_corner_against_a_face() {
        // The corner of a cube turned by 45 degrees reaches sqrt(1/2) beyond its centre.
        let reach = 0.5_f64.sqrt() + 0.5;
        assert_eq!(overlaps(&[cube(0.0, 0.0, 0.0), cube(reach, 0.0, 45.0)]), []);
        let found = overlaps(&[cube(0.0, 0.0, 0.0), cube(reach - 0.01, 0.0, 45.0)]);
        assert_relative_eq!(found[0].depth, 0.01, epsilon = 1e-15);
        // Bounding boxes meet, the cubes do not.
        assert_eq!(overlaps(&[cube(0.0, 0.0, 45.0), cube(1.0, 1.0, 45.0)]), []);
    }
}

//! Pairs of tiles that share volume.

use std::error::Error;
use std::fmt;

use glam::{DMat3, DVec3};
use rstar::{AABB, RTree, RTreeObject};

use crate::tile::Tile;
use crate::tolerances::{DEEPEST_ROUND_OFF, OVERLAP_ROUNDINGS, PARALLEL_EDGES, UNIT_ROUNDOFF};

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
/// end it. `None` if they touch or overlap by no more than the round-off of their own coordinates;
/// see [`OVERLAP_ROUNDINGS`].
pub fn overlap(first: &Tile, second: &Tile) -> Option<(f64, DVec3)> {
    let [first, second] = [first, second].map(Oriented::from_tile);
    first.penetration(&second, first.extent.max(second.extent))
}

/// [`overlap`] of the box between two corners with a tile, which must move along the direction. The
/// box may be a rectangle, a line or a point: it then overlaps the tiles that it enters.
pub fn box_overlap(lower: DVec3, upper: DVec3, tile: &Tile) -> Option<(f64, DVec3)> {
    let half = 0.5 * (upper - lower);
    let region = Oriented::new(lower + half, DMat3::IDENTITY, half, f64::INFINITY);
    let tile = Oriented::from_tile(tile);
    region.penetration(&tile, region.extent.max(tile.extent))
}

/// All pairs of tiles that overlap by more than round-off, ordered by index, found lazily.
///
/// The round-off of a position grows with the largest coordinate of all tiles: the coordinates of a
/// row about the origin are differences of lengths of the row. [`OVERLAP_ROUNDINGS`] derives the
/// bound.
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
    let extent = boxes.iter().map(|tile| tile.extent).fold(0.0, f64::max);
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
            let (depth, direction) = own.penetration(&boxes[second], extent)?;
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
    /// The shortest side of a tile; infinite for a region, whose thickness is no measure of depths.
    thinnest: f64,
    /// No point of the tile is farther from the origin.
    extent: f64,
    low: DVec3,
    high: DVec3,
}

impl Oriented {
    fn from_tile(tile: &Tile) -> Oriented {
        let half = 0.5 * tile.size();
        Oriented::new(tile.position(), DMat3::from_quat(tile.rotation()), half, tile.size().min_element())
    }

    fn new(centre: DVec3, rotation: DMat3, half: DVec3, thinnest: f64) -> Oriented {
        let axes = [rotation.x_axis, rotation.y_axis, rotation.z_axis];
        let reach = axes[0].abs() * half.x + axes[1].abs() * half.y + axes[2].abs() * half.z;
        let extent = centre.abs().element_sum() + half.element_sum();
        Oriented { centre, axes, half, thinnest, extent, low: centre - reach, high: centre + reach }
    }

    fn reach(&self, direction: DVec3) -> f64 {
        (0..3).map(|i| self.half[i] * self.axes[i].dot(direction).abs()).sum()
    }

    /// Depth and direction of the overlap by the separating-axis theorem (Gottschalk, Lin, Manocha
    /// 1996), for tiles whose positions come from lengths of up to `extent`.
    fn penetration(&self, other: &Oriented, extent: f64) -> Option<(f64, DVec3)> {
        let shift = other.centre - self.centre;
        let crosses = self.axes.iter().flat_map(|a| other.axes.iter().map(move |b| a.cross(*b)));
        let candidates = self.axes.iter().chain(&other.axes).copied().chain(crosses);
        let thinnest = self.thinnest.min(other.thinnest);
        let round_off = (OVERLAP_ROUNDINGS * UNIT_ROUNDOFF * extent).min(DEEPEST_ROUND_OFF * thinnest);
        let mut least: Option<(f64, DVec3)> = None;
        // Parallel edges have no common normal of their own; the face normals cover that case.
        for direction in candidates.filter(|d| d.length() > PARALLEL_EDGES).map(DVec3::normalize) {
            let along = shift.dot(direction);
            let depth = self.reach(direction) + other.reach(direction) - along.abs();
            if depth <= round_off {
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

    /// Rotations of the blocks of a ring of `count`, and its centres, in the ways in which users
    /// compute them. `radius` is the distance of the centres from the axis.
    fn rings(count: u32, radius: f64) -> Vec<Vec<(DVec3, DQuat)>> {
        let pitch_deg = 360.0 / f64::from(count);
        let by_angle = |rad: f64| {
            let (sin, cos) = rad.sin_cos();
            (DVec3::new(radius * cos, radius * sin, 0.0), DQuat::from_rotation_z(rad))
        };
        let from_degrees = (0..count).map(|block| by_angle((f64::from(block) * pitch_deg).to_radians())).collect();
        let parts_of_a_turn =
            (0..count).map(|block| by_angle(std::f64::consts::TAU * f64::from(block) / f64::from(count))).collect();
        let sum_of_angles = (0..count)
            .scan(0.0, |sum_deg, _| Some(std::mem::replace(sum_deg, *sum_deg + pitch_deg)))
            .map(|deg: f64| by_angle(deg.to_radians()));
        let step = DQuat::from_rotation_z(pitch_deg.to_radians());
        let turned_by_steps = (0..count).scan((DVec3::X * radius, DQuat::IDENTITY), |block, _| {
            Some(std::mem::replace(block, (step * block.0, (step * block.1).normalize())))
        });
        let tilt = DQuat::from_euler(glam::EulerRot::XYZ, 0.6, -0.4, 1.3);
        let moved = DVec3::new(1234.5, -77.7, 3.0);
        let flat: Vec<(DVec3, DQuat)> = parts_of_a_turn;
        let tilted = flat.iter().map(|(centre, rotation)| (tilt * *centre + moved, tilt * *rotation)).collect();
        vec![from_degrees, sum_of_angles.collect(), turned_by_steps.collect(), tilted, flat]
    }

    /// Blocks of a ring touch at their inner edges.
    #[test]
    fn rings_touch_and_smaller_rings_overlap() {
        let sizes = [DVec3::splat(10.0), DVec3::new(1.7, 3.3, 1.0), DVec3::new(8.1, 1.0 / 3.0, 0.2)];
        for count in 2..=256_u32 {
            let size = sizes[count as usize % 3];
            let inner = if count == 2 { 0.0 } else { 0.5 * size.y / (std::f64::consts::PI / f64::from(count)).tan() };
            for [shrink, overlapping] in [[0.0, 0.0], [1e-6 * size.x, 1.0]] {
                for (way, ring) in rings(count, inner + 0.5 * size.x - shrink).into_iter().enumerate() {
                    let block = |(centre, rotation): (DVec3, DQuat)| {
                        Tile::new(centre, size, DVec3::X).unwrap().rotated(rotation).unwrap()
                    };
                    let blocks: Vec<Tile> = ring.into_iter().map(block).collect();
                    let pairs = if count == 2 { 1 } else { blocks.len() };
                    let found = overlaps(&blocks);
                    assert_eq!(found.len(), overlapping as usize * pairs, "{count} blocks, {way}: {:?}", found.first());
                }
            }
        }
    }

    /// The coordinates of a row about the origin are differences of lengths of the row.
    #[test]
    fn rows_touch_wherever_they_are() {
        for angle_deg in [0.0, 30.0, 90.0] {
            let along = DVec3::new(f64::cos(f64::to_radians(angle_deg)), f64::sin(f64::to_radians(angle_deg)), 0.0);
            for pitch in [25.4 / 3.0, 0.1, 1.0 / 3.0] {
                for start in [-127.5 * pitch, 1e4, -3e3 - 0.7] {
                    let across = DVec3::new(-along.y, along.x, 0.0) * 1e4;
                    let block = |index: i32| {
                        let centre = (start + f64::from(index) * pitch) * along + across;
                        let tile = Tile::new(centre, DVec3::splat(pitch), DVec3::Z).unwrap();
                        tile.rotated(DQuat::from_rotation_z(angle_deg.to_radians())).unwrap()
                    };
                    let row: Vec<Tile> = (0..256).map(block).collect();
                    assert_eq!(overlaps(&row).first(), None, "{angle_deg}, {pitch}, {start}");
                }
            }
        }
    }

    /// A tile at the end of the world allows no deep overlap of others.
    #[test]
    fn round_off_is_a_small_part_of_the_thinnest_side() {
        let far = cube(1e12, 0.0, 0.0);
        assert_eq!(overlaps(&[cube(0.0, 0.0, 0.0), cube(1.0 - 1e-7, 0.0, 0.0), far]), []);
        assert_eq!(overlaps(&[cube(0.0, 0.0, 0.0), cube(1.0 - 1e-5, 0.0, 0.0), far]).len(), 1);
    }

    /// Rectangles, lines and points enter a tile or touch it.
    #[test]
    fn boxes_without_extent_overlap_the_tiles_that_they_enter() {
        let tile = cube(0.1, 0.0, 30.0);
        for (lower, upper, depth) in [
            ([-2.0, -2.0, 0.2], [2.0, 2.0, 0.2], Some(0.3)),
            ([-2.0, -2.0, 0.5], [2.0, 2.0, 0.5], None),
            ([0.1, -2.0, 0.0], [0.1, 2.0, 0.0], Some(0.5)),
            ([0.1, 0.0, 0.1], [0.1, 0.0, 0.1], Some(0.4)),
            ([2.0, 0.0, 0.0], [2.0, 0.0, 0.0], None),
            ([-2.0, -2.0, 0.4], [2.0, 2.0, 3.0], Some(0.1)),
        ] {
            let found = box_overlap(DVec3::from(lower), DVec3::from(upper), &tile).map(|(depth, _)| depth);
            let error = found.unwrap_or_default() - depth.unwrap_or_default();
            assert!(found.is_some() == depth.is_some() && error.abs() < 1e-15, "{lower:?} {upper:?}: {found:?}");
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

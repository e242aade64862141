//! Clearance: the distance of tiles from the working volume.

use glam::DVec3;
use magsplice_magnet::{Tile, box_overlap};

use crate::oriented_box::OrientedBox;

/// The smallest distance between a box and tiles.
///
/// ```
/// use glam::DVec3;
/// use magsplice_expect::Clearance;
/// use magsplice_magnet::Tile;
///
/// let tile = Tile::new(DVec3::new(0.0, 0.0, 0.5), DVec3::ONE, DVec3::X).unwrap();
/// let [lower, upper] = [DVec3::new(-2.0, -2.0, -5.0), DVec3::new(2.0, 2.0, -3.0)];
/// let clearance = Clearance::from_tiles(&[tile], lower, upper).unwrap();
/// assert_eq!(clearance.distance, 3.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Clearance {
    /// The smallest distance between a point of the box and a point of a tile, in the unit of the
    /// tiles. If a tile penetrates the box, minus the shortest displacement by which the tile
    /// leaves it.
    pub distance: f64,
    /// Index of the nearest tile.
    pub tile: usize,
}

impl Clearance {
    /// The clearance of tiles from the box between the corners `lower` and `upper`, which may be a
    /// rectangle, a line or a point. `None` if there are no tiles.
    ///
    /// # Accuracy
    /// A few units of round-off of the coordinates.
    pub fn from_tiles(tiles: &[Tile], lower: DVec3, upper: DVec3) -> Option<Clearance> {
        let region = OrientedBox::between(lower, upper);
        let mut least: Option<Clearance> = None;
        for (index, tile) in tiles.iter().enumerate() {
            let own = OrientedBox::from_tile(tile);
            if least.is_some_and(|l| region.certainly_beyond(&own, l.distance)) {
                continue;
            }
            let depth = box_overlap(lower, upper, tile).map(|(depth, _)| depth);
            let distance = depth.map_or_else(|| region.distance(&own), |depth| -depth);
            if least.is_none_or(|l| distance < l.distance) {
                least = Some(Clearance { distance, tile: index });
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
    use proptest::prelude::*;

    const LOWER: DVec3 = DVec3::new(-2.0, -2.0, -5.0);
    const UPPER: DVec3 = DVec3::new(2.0, 2.0, -3.0);

    fn tile(position: [f64; 3]) -> Tile {
        Tile::new(position.into(), DVec3::new(3.3, 1.7, 1.0), DVec3::X).unwrap()
    }

    fn clearance(tiles: &[Tile]) -> Clearance {
        Clearance::from_tiles(tiles, LOWER, UPPER).unwrap()
    }

    #[test]
    fn distances_from_a_face_a_side_and_a_corner() {
        assert_eq!(clearance(&[tile([0.0, 0.0, 0.5])]), Clearance { distance: 3.0, tile: 0 });
        assert_relative_eq!(clearance(&[tile([0.0, 4.0, -4.0])]).distance, 4.0 - 0.85 - 2.0);
        // The offset of the nearest corner is (3, 4, 12).
        let off = [2.0 + 3.0 + 1.65, 2.0 + 4.0 + 0.85, -3.0 + 12.0 + 0.5];
        assert_relative_eq!(clearance(&[tile(off)]).distance, 13.0, max_relative = 1e-15);
        assert_eq!(Clearance::from_tiles(&[], LOWER, UPPER), None);
    }

    #[test]
    fn touching_tile_has_distance_zero_and_overlap_is_negative() {
        assert_eq!(clearance(&[tile([0.0, 0.0, -2.5])]).distance, 0.0);
        let found = clearance(&[tile([0.0, 0.0, 0.5]), tile([0.0, 0.0, -2.75])]);
        assert_eq!((found.distance, found.tile), (-0.25, 1));
    }

    #[test]
    fn nearest_tile_is_found_in_any_order() {
        let mut tiles: Vec<Tile> = (0..20).map(|i| tile([4.0 * f64::from(i) - 40.0, 0.0, 0.5])).collect();
        assert_relative_eq!(clearance(&tiles).distance, 3.0);
        tiles.push(tile([0.0, 0.0, -1.5]));
        assert_eq!(clearance(&tiles), Clearance { distance: 1.0, tile: 20 });
        tiles.reverse();
        assert_eq!(clearance(&tiles), Clearance { distance: 1.0, tile: 0 });
        // The first of tiles at the same distance is reported.
        tiles.push(tile([0.0, 0.0, -1.5]));
        assert_eq!(clearance(&tiles), Clearance { distance: 1.0, tile: 0 });
    }

    #[test]
    fn rotated_tile_is_nearest_with_its_edge() {
        // At 45 degrees about x, the edge between the sides 1.7 and 1 points down by (1.7 + 1) / 2
        // / sqrt 2.
        let turned = tile([0.0, 0.0, 0.5]).rotated(DQuat::from_rotation_x(45_f64.to_radians())).unwrap();
        assert_relative_eq!(clearance(&[turned]).distance, 3.5 - 1.35 / 2_f64.sqrt(), max_relative = 1e-14);
    }

    proptest! {
        /// Only tiles that are certainly farther are skipped, for volumes of any size.
        #[test]
        fn clearance_of_many_tiles_is_the_least_of_single_ones(
            tiles in prop::collection::vec((prop::array::uniform3(-15.0..15.0_f64), -3.0..3.0_f64), 2..20),
            volume_size in 0.01..1.0_f64,
        ) {
            let turned = |(at, angle): ([f64; 3], f64)| tile(at).rotated(DQuat::from_rotation_x(angle)).unwrap();
            let tiles: Vec<Tile> = tiles.into_iter().map(turned).collect();
            let clearance = |tiles: &[Tile]| Clearance::from_tiles(tiles, volume_size * LOWER, volume_size * UPPER).unwrap();
            let alone = tiles.iter().map(|t| clearance(&[*t]).distance).fold(f64::INFINITY, f64::min);
            prop_assert_eq!(clearance(&tiles).distance, alone);
        }
    }
}

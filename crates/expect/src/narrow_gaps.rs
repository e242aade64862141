//! Tiles that almost touch.

use magsplice_magnet::{BoundingBox, Tile};
use rstar::{AABB, RTree, RTreeObject};

use crate::oriented_box::OrientedBox;

/// Gap, as a fraction of the largest coordinate, below which tiles touch. It is a thousand times
/// the rounding of a coordinate, and far below the digits of layouts.
const TOUCHING: f64 = 1e-12;

/// The pairs of tiles with a narrow gap between them.
///
/// ```
/// use glam::DVec3;
/// use magsplice_expect::NarrowGaps;
/// use magsplice_magnet::Tile;
///
/// let cube = |x| Tile::new(DVec3::new(x, 0.0, 0.0), DVec3::ONE, DVec3::X).unwrap();
/// // The first two touch, the gap between the next two is 0.0005.
/// let gaps = NarrowGaps::below(0.01, &[cube(0.0), cube(1.0), cube(2.0005), cube(4.0)]).unwrap();
/// assert_eq!(gaps.pairs, 1);
/// assert!((gaps.smallest - 0.0005).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NarrowGaps {
    /// Number of such pairs.
    pub pairs: usize,
    /// The smallest gap, in the unit of the tiles.
    pub smallest: f64,
}

impl NarrowGaps {
    /// The pairs of tiles less than `limit` apart that do not touch. `None` without such pairs. The
    /// time is about N log N for N tiles with few neighbours each.
    ///
    /// # Accuracy
    /// A few units of round-off of the coordinates. Tiles whose gap is below 1e-12 of the largest
    /// coordinate touch.
    pub fn below(limit: f64, tiles: &[Tile]) -> Option<NarrowGaps> {
        let bounds: Vec<Bounds> = tiles
            .iter()
            .enumerate()
            .map(|(index, tile)| Bounds { bounds: BoundingBox::from_tile(tile), index })
            .collect();
        let corners = bounds.iter().flat_map(|b| [b.bounds.lower, b.bounds.upper]);
        let touching = TOUCHING * corners.map(|corner| corner.abs().max_element()).fold(0.0, f64::max);
        let searched: Vec<AABB<[f64; 3]>> = bounds
            .iter()
            .map(|b| AABB::from_corners((b.bounds.lower - limit).to_array(), (b.bounds.upper + limit).to_array()))
            .collect();
        let tree = RTree::bulk_load(bounds);
        let mut found: Option<NarrowGaps> = None;
        for (first, envelope) in searched.into_iter().enumerate() {
            let own = OrientedBox::from_tile(&tiles[first]);
            for near in tree.locate_in_envelope_intersecting(envelope).filter(|near| near.index > first) {
                let gap = own.distance(&OrientedBox::from_tile(&tiles[near.index]));
                // A gap equal to the limit up to round-off is not below it.
                if gap > touching && gap < limit - touching {
                    let earlier = found.unwrap_or(NarrowGaps { pairs: 0, smallest: gap });
                    found = Some(NarrowGaps { pairs: earlier.pairs + 1, smallest: earlier.smallest.min(gap) });
                }
            }
        }
        found
    }
}

/// A tile's bounds in the tree.
struct Bounds {
    bounds: BoundingBox,
    index: usize,
}

impl RTreeObject for Bounds {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> AABB<[f64; 3]> {
        AABB::from_corners(self.bounds.lower.to_array(), self.bounds.upper.to_array())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use glam::{DQuat, DVec3};

    fn cube(x: f64, angle_deg: f64) -> Tile {
        let tile = Tile::new(DVec3::new(x, 0.0, 0.0), DVec3::ONE, DVec3::X).unwrap();
        tile.rotated(DQuat::from_rotation_z(angle_deg.to_radians())).unwrap()
    }

    #[test]
    fn touching_and_distant_tiles_have_no_narrow_gap() {
        assert_eq!(NarrowGaps::below(0.01, &[cube(0.1, 0.0), cube(1.1, 0.0), cube(2.2, 0.0)]), None);
        assert_eq!(NarrowGaps::below(0.01, &[]), None);
    }

    #[test]
    fn gap_to_the_corner_of_a_turned_tile_is_found() {
        let reach = 0.5_f64.sqrt() + 0.5;
        assert_eq!(NarrowGaps::below(0.01, &[cube(0.0, 0.0), cube(reach, 45.0)]), None);
        let found = NarrowGaps::below(0.01, &[cube(0.0, 0.0), cube(reach + 0.004, 45.0)]).unwrap();
        assert_eq!(found.pairs, 1);
        assert_relative_eq!(found.smallest, 0.004, epsilon = 1e-12);
    }
}

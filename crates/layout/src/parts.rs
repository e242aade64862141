//! The bill of materials: how many identical pieces of magnet a layout needs of each sort.

use std::collections::BTreeMap;

use glam::DVec3;
use magsplice_magnet::Tile;

use crate::layout::Layout;

/// Significant digits to which sizes, strengths and directions of two pieces must agree.
/// Differences beyond them are round-off.
const SAME_DIGITS: i32 = 9;

/// One sort of identical pieces: tiles that differ only in position and orientation.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Number of such pieces in the layout.
    pub count: usize,
    /// Side lengths in millimetres. The third is the z side of the first such tile; of the other
    /// two the longer comes first.
    pub size_mm: DVec3,
    /// Magnitude of the polarization, in tesla.
    pub strength_t: f64,
    /// Unit vector of the polarization along these sides, or zero without polarization.
    pub direction: DVec3,
    /// Name of the first such tile.
    pub example: String,
    /// Indices of all such tiles in the layout, in ascending order.
    pub tiles: Vec<usize>,
}

impl Layout {
    /// The bill of materials, largest pieces first.
    ///
    /// Two tiles are the same part if a rotation maps one onto the other, polarization included. A
    /// tile turned upside down to reverse its polarization is therefore the same part, and its
    /// mirror image is another one.
    ///
    /// # Example
    /// ```
    /// use magsplice_layout::{COMMENTED_LAYOUT, Layout};
    ///
    /// let parts = Layout::parse(COMMENTED_LAYOUT, "commented")?.parts();
    /// let counts: Vec<usize> = parts.iter().map(|part| part.count).collect();
    /// assert_eq!(counts, [16, 24, 16]); // squares, strips, narrow strips at the rim
    /// # Ok::<(), magsplice_layout::LayoutError>(())
    /// ```
    pub fn parts(&self) -> Vec<Part> {
        // The tiles of each piece.
        let mut parts: BTreeMap<CanonicalPiece, Vec<usize>> = BTreeMap::new();
        for (index, named) in self.tiles.iter().enumerate() {
            let piece = CanonicalPiece::from_tile(&named.tile).least_of(quarter_turns());
            parts.entry(piece).or_default().push(index);
        }
        let part = |tiles: Vec<usize>| {
            let named = &self.tiles[tiles[0]];
            let flat = quarter_turns().filter(|turn| turn(DVec3::Z).z != 0.0);
            let CanonicalPiece([x, y, z, strength, u, v, w]) = CanonicalPiece::from_tile(&named.tile).least_of(flat);
            Part {
                count: tiles.len(),
                size_mm: DVec3::new(x.0, y.0, z.0),
                strength_t: strength.0,
                direction: DVec3::new(u.0, v.0, w.0).normalize_or_zero(),
                example: named.name.clone(),
                tiles,
            }
        };
        parts.into_values().map(part).collect()
    }
}

impl Part {
    /// Angle of the polarization in the plane of the first two sides, from the first towards the
    /// second, and out of this plane towards the third, in degrees. `None` without polarization.
    ///
    /// The angles have six decimals, because directions of parts have nine digits.
    pub fn angles_deg(&self) -> Option<[f64; 2]> {
        let DVec3 { x, y, z } = self.direction;
        let in_degrees = |angle: f64| rounded(angle.to_degrees(), ANGLE_DECIMALS) + 0.0;
        (self.direction != DVec3::ZERO).then(|| [in_degrees(y.atan2(x)), in_degrees(z.atan2(x.hypot(y)))])
    }
}

/// Decimals of angles of parts, in degrees.
const ANGLE_DECIMALS: i32 = 6;

/// Size (3), strength (1) and direction (3) of a tile in one orientation, rounded to
/// [`SAME_DIGITS`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct CanonicalPiece([Descending; 7]);

impl CanonicalPiece {
    fn from_tile(tile: &Tile) -> CanonicalPiece {
        let polarization = tile.polarization_t();
        // Scaled, so that squares neither overflow nor underflow.
        let largest = polarization.abs().max_element();
        let scaled = if largest > 0.0 { polarization / largest } else { DVec3::ZERO };
        let direction = scaled.normalize_or_zero().map(|c| rounded(c, SAME_DIGITS));
        CanonicalPiece::new(tile.size().map(to_digits), to_digits(largest * scaled.length()), direction)
    }

    fn new(size: DVec3, strength: f64, direction: DVec3) -> CanonicalPiece {
        // Adding zero turns -0 into 0.
        let direction = direction + DVec3::ZERO;
        CanonicalPiece([size.x, size.y, size.z, strength, direction.x, direction.y, direction.z].map(Descending))
    }

    /// The least of the orientations that these turns give: sides in descending order, then the
    /// largest components of the direction first.
    fn least_of(self, turns: impl Iterator<Item = impl Fn(DVec3) -> DVec3>) -> CanonicalPiece {
        let CanonicalPiece([x, y, z, strength, u, v, w]) = self;
        let (size, direction) = (DVec3::new(x.0, y.0, z.0), DVec3::new(u.0, v.0, w.0));
        turns.map(|turn| CanonicalPiece::new(turn(size).abs(), strength.0, turn(direction))).min().unwrap_or(self)
    }
}

/// The 24 rotations that map axes onto axes.
fn quarter_turns() -> impl Iterator<Item = impl Fn(DVec3) -> DVec3> {
    const ORDERS: [([usize; 3], bool); 6] = [
        ([0, 1, 2], false),
        ([1, 2, 0], false),
        ([2, 0, 1], false),
        ([0, 2, 1], true),
        ([2, 1, 0], true),
        ([1, 0, 2], true),
    ];
    let all = ORDERS.into_iter().flat_map(|order| (0..8_u32).map(move |signs| (order, signs)));
    // An exchange of two axes and a reflection each reverse handedness, so a rotation has an even
    // number of them.
    all.filter(|((_, exchange), signs)| (signs.count_ones() % 2 == 1) == *exchange).map(|((order, _), signs)| {
        move |v: DVec3| {
            let component = |axis: usize| if signs >> axis & 1 == 1 { -v[order[axis]] } else { v[order[axis]] };
            DVec3::new(component(0), component(1), component(2))
        }
    })
}

/// The value rounded to [`SAME_DIGITS`] significant digits.
fn to_digits(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { rounded(value, SAME_DIGITS - 1 - value.abs().log10().floor() as i32) }
}

fn rounded(value: f64, decimals: i32) -> f64 {
    // Through decimal text, so that 3.3 stays 3.3. Very large numbers keep all digits.
    match usize::try_from(decimals) {
        Ok(decimals) => format!("{value:.decimals$}").parse().unwrap_or(value),
        Err(_) => value,
    }
}

/// A number that sorts in descending order.
#[derive(Clone, Copy, PartialEq)]
struct Descending(f64);

impl Eq for Descending {}

impl Ord for Descending {
    fn cmp(&self, other: &Descending) -> std::cmp::Ordering {
        other.0.total_cmp(&self.0)
    }
}

impl PartialOrd for Descending {
    fn partial_cmp(&self, other: &Descending) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(tiles: &str) -> Vec<Part> {
        let text = format!("format = 1\nname = \"test\"\n{tiles}");
        Layout::parse(&text, "test").unwrap_or_else(|e| panic!("{e}")).parts()
    }

    fn tile(place: i32, size: &str, polarization: &str) -> String {
        format!("[[tile]]\nposition_mm = [{place}, 0, 0]\nsize_mm = [{size}]\npolarization_t = [{polarization}]\n")
    }

    #[test]
    fn quarter_turns_are_the_24_rotations_of_the_axes() {
        let axes = DVec3::AXES;
        let mut seen: Vec<[DVec3; 3]> = quarter_turns().map(|turn| axes.map(&turn)).collect();
        assert!(seen.iter().all(|[x, y, z]| x.cross(*y) == *z));
        assert_eq!(seen.len(), 24);
        seen.sort_by_key(|[x, y, z]| format!("{x}{y}{z}").replace("-0,", "0,"));
        seen.dedup();
        assert_eq!(seen.len(), 24);
    }

    #[test]
    fn rotated_tiles_are_one_part() {
        let same =
            [tile(0, "3, 2, 1", "0.1, 0, 0"), tile(9, "2, 3, 1", "0, -0.1, 0"), tile(18, "1, 2, 3", "0, 0, 0.1")];
        let found = parts(&same.concat());
        assert_eq!(found.len(), 1, "{found:?}");
        let Part { count, size_mm, strength_t, direction, example, tiles } = &found[0];
        assert_eq!(tiles[..], [0, 1, 2]);
        assert_eq!((*count, *size_mm, *strength_t), (3, DVec3::new(3.0, 2.0, 1.0), 0.1));
        assert_eq!((*direction, example.as_str()), (DVec3::X, "tile-1"));
    }

    #[test]
    fn parts_differ_by_size_strength_direction_and_handedness() {
        let others = [
            tile(0, "3, 2, 1", "0.1, 0, 0"),
            tile(9, "3, 2, 1", "0, 0.1, 0"),
            tile(18, "3, 2, 1", "0.2, 0, 0"),
            tile(27, "3, 2, 1.5", "0.1, 0, 0"),
            tile(36, "3, 2, 1", "0.1, 0.2, 0.3"),
            tile(45, "3, 2, 1", "0.1, 0.2, -0.3"),
            tile(54, "3, 2, 1", "0, 0, 0"),
        ];
        assert_eq!(parts(&others.concat()).len(), others.len());
        // A cuboid polarized in a plane of symmetry is its own mirror image.
        assert_eq!(parts(&[tile(0, "3, 2, 1", "1, 2, 0"), tile(9, "3, 2, 1", "1, -2, 0")].concat()).len(), 1);
    }

    #[test]
    fn round_off_does_not_make_new_parts() {
        let near =
            [tile(0, "3.3, 1, 1", "0.3, 0, 0"), tile(9, "3.3000000000000003, 1, 1", "0.30000000000000004, 0, 0")];
        assert_eq!(parts(&near.concat()).len(), 1);
        let tiny = [tile(0, "1e-20, 1e-20, 1e-20", "1e-200, 0, 0"), tile(9, "2e-20, 1e-20, 1e-20", "1e-200, 0, 0")];
        assert_eq!(parts(&tiny.concat()).len(), 2);
    }

    #[test]
    fn parts_without_polarization_have_strength_0() {
        let found = parts(&tile(0, "3, 2, 1", "0, 0, 0"));
        assert_eq!((found[0].strength_t, found[0].direction), (0.0, DVec3::ZERO));
    }

    #[test]
    fn numbers_keep_their_first_digits() {
        for value in [1.0 / 3.0, 2e3 / 3.0, 1e-5 / 7.0, -22.0 / 7.0, 1e9 / 7.0, 1.0, 0.0] {
            let digits = SAME_DIGITS as usize - 1;
            assert_eq!(to_digits(value), format!("{value:.digits$e}").parse::<f64>().expect("a number"));
        }
        assert!(Descending(2.0) < Descending(1.0));
    }
}

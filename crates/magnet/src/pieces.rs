//! The sorts of identical pieces among tiles.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use glam::DVec3;

use crate::tile::Tile;

/// Significant digits to which sizes, strengths and directions of identical pieces agree. Further
/// digits are round-off.
const SAME_DIGITS: i32 = 9;

/// One sort of identical pieces: tiles that differ only in position and orientation.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Side lengths: first the longer and the shorter of the x and y sides of the first such tile,
    /// then its z side.
    pub size: DVec3,
    /// Magnitude of the polarization, in tesla.
    pub strength_t: f64,
    /// Unit vector of the polarization along these sides, or zero without polarization.
    pub direction: DVec3,
    /// Indices of the tiles, in ascending order.
    pub tiles: Vec<usize>,
}

/// The sorts of pieces among tiles, largest pieces first.
///
/// Two tiles are the same sort of piece if a rotation maps one onto the other with its
/// polarization. A tile turned upside down to reverse its polarization is therefore the same sort,
/// and its mirror image is another sort. Sizes, strengths and directions agree to nine digits.
pub fn pieces(tiles: &[Tile]) -> Vec<Piece> {
    let mut sorts: BTreeMap<CanonicalPiece, Vec<usize>> = BTreeMap::new();
    for (index, tile) in tiles.iter().enumerate() {
        sorts.entry(CanonicalPiece::from_tile(tile).least_of(quarter_turns())).or_default().push(index);
    }
    let piece = |of_sort: Vec<usize>| {
        let flat = quarter_turns().filter(|turn| turn(DVec3::Z).z != 0.0);
        let CanonicalPiece(all) = CanonicalPiece::from_tile(&tiles[of_sort[0]]).least_of(flat);
        let [x, y, z, strength_t, u, v, w] = all.map(|Descending(value)| value);
        let direction = DVec3::new(u, v, w).normalize_or_zero();
        Piece { size: DVec3::new(x, y, z), strength_t, direction, tiles: of_sort }
    };
    sorts.into_values().map(piece).collect()
}

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

    /// The first orientation after these turns: sides in descending order, then the largest
    /// components of the direction first.
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
    // Exchanging two axes or reflecting one reverses handedness, so a rotation has an even number
    // of both together.
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
    // Rounding to decimals keeps 3.3 as 3.3. Very large numbers keep all digits.
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
    fn cmp(&self, other: &Descending) -> Ordering {
        other.0.total_cmp(&self.0)
    }
}

impl PartialOrd for Descending {
    fn partial_cmp(&self, other: &Descending) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn numbers_keep_their_first_digits() {
        for value in [1.0 / 3.0, 2e3 / 3.0, 1e-5 / 7.0, -22.0 / 7.0, 1e9 / 7.0, 1.0, 0.0] {
            let digits = SAME_DIGITS as usize - 1;
            assert_eq!(to_digits(value), format!("{value:.digits$e}").parse::<f64>().expect("a number"));
        }
        assert!(Descending(2.0) < Descending(1.0));
    }
}

//! The rule that tiles do not overlap. Touching tiles are allowed.

use std::ops::Range;

use glam::DVec3;
use magsplice_magnet::{Tile, overlaps_among};

use crate::layout::NamedTile;
use crate::limits::{MAX_LISTED, PAIRS_PER_TILE, SPARE_PAIRS};
use crate::read::faults::Faults;

/// Adds a fault for each pair of tiles that overlap by more than round-off. `spans` says where in
/// the text each tile stands.
pub(crate) fn check(tiles: &[NamedTile], spans: &[Range<usize>], faults: &mut Faults) {
    let bare: Vec<Tile> = tiles.iter().map(|named| named.tile).collect();
    let most = PAIRS_PER_TILE * tiles.len() + SPARE_PAIRS;
    let mut pairs = overlaps_among(&bare, most);
    for pair in pairs.by_ref().take(MAX_LISTED - 1) {
        let Ok(pair) = pair else {
            faults.add_to_layout(format!(
                "more than {most} pairs of tiles may overlap, too many to examine: many tiles are in one place, for \
                 example beyond the digits of numbers, or next to each other and rotated"
            ));
            return;
        };
        let (first, second) = (&tiles[pair.first].name, &tiles[pair.second].name);
        let d = pair.direction;
        let depth_mm = three_digits_up(pair.depth);
        faults.at(&spans[pair.second], format!("tile \"{second}\"")).add(format!(
            "overlaps tile \"{first}\" before it by {depth_mm} mm, must not overlap: move \"{second}\" that far along {}",
            direction(d)
        ));
    }
    if pairs.next().is_some() {
        faults.add_to_layout("more pairs of tiles overlap");
    }
}

/// Three significant digits, rounded up, so that a move by that much ends the overlap.
fn three_digits_up(depth: f64) -> f64 {
    let digit = 10_f64.powf(depth.log10().floor() - 2.0);
    // Through decimal text, which removes the round-off of the product. A depth is often a decimal
    // number with round-off, which must not be rounded up by a whole digit.
    let rounded = ((depth / digit) * (1.0 - DECIMAL_ROUNDING)).ceil() * digit;
    format!("{rounded:.2e}").parse().unwrap_or(depth)
}

/// Round-off of sums and differences of a few decimal numbers.
const DECIMAL_ROUNDING: f64 = 1e-9;

/// An axis by its name, any other direction by its components.
fn direction(d: DVec3) -> String {
    for (axis, name) in DVec3::AXES.into_iter().zip(["x", "y", "z"]) {
        if d.dot(axis).abs() > 1.0 - DECIMAL_ROUNDING {
            return format!("{}{name}", if d.dot(axis) > 0.0 { '+' } else { '-' });
        }
    }
    format!("({:.3}, {:.3}, {:.3})", d.x, d.y, d.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_are_rounded_up_to_three_digits() {
        for (depth, shown) in
            [(0.25, 0.25), (0.1 + 0.2, 0.3), (0.250_1, 0.251), (1.0, 1.0), (999.5, 1000.0), (3.0, 3.0), (1e-9, 1e-9)]
        {
            assert_eq!(three_digits_up(depth), shown, "{depth}");
        }
    }

    #[test]
    fn directions_along_axes_have_names() {
        assert_eq!((direction(DVec3::X), direction(-DVec3::Z)), ("+x".to_owned(), "-z".to_owned()));
        assert_eq!(direction(DVec3::new(0.6, -0.8, 0.0)), "(0.600, -0.800, 0.000)");
    }
}

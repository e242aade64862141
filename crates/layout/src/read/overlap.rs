//! The rule that tiles do not overlap. Touching tiles are allowed.

use std::ops::Range;

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
        faults.at(&spans[pair.second], format!("tiles \"{first}\" and \"{second}\"")).add(format!(
            "overlap by {} mm, must not overlap: move \"{second}\" that far along ({:.3}, {:.3}, {:.3})",
            pair.depth, d.x, d.y, d.z
        ));
    }
    if pairs.next().is_some() {
        faults.add_to_layout("more pairs of tiles overlap");
    }
}

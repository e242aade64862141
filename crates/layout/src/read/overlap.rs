//! The rule that tiles do not overlap. Touching tiles are allowed.

use std::ops::Range;

use magsplice_magnet::{Tile, overlaps};

use crate::layout::NamedTile;
use crate::limits::MAX_LISTED;
use crate::read::faults::Faults;

/// Adds a fault for each pair of tiles that overlap by more than round-off. `spans` says where in
/// the text each tile stands.
pub(crate) fn check(tiles: &[NamedTile], spans: &[Range<usize>], faults: &mut Faults) {
    let bare: Vec<Tile> = tiles.iter().map(|named| named.tile).collect();
    let mut pairs = overlaps(&bare);
    for pair in pairs.by_ref().take(MAX_LISTED) {
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

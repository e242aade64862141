//! The rule that tile names are unique.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::layout::NamedTile;
use crate::limits::MAX_LISTED;
use crate::read::faults::Faults;

/// Adds a fault for each name that several tiles have. `spans` says where in the text each tile
/// stands.
pub(crate) fn check(tiles: &[NamedTile], spans: &[Range<usize>], faults: &mut Faults) {
    let mut seen: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for (index, tile) in tiles.iter().enumerate() {
        let (count, last) = seen.entry(tile.name.as_str()).or_default();
        (*count, *last) = (*count + 1, index);
    }
    let repeated: Vec<_> = seen.into_iter().filter(|(_, (count, _))| *count > 1).collect();
    for (name, (count, last)) in repeated.iter().take(MAX_LISTED) {
        faults
            .at(&spans[*last], format!("tile \"{name}\""))
            .add(format!("{count} tiles have this name, names must be unique"));
    }
    if repeated.len() > MAX_LISTED {
        faults.add_to_layout(format!("{} more names are not unique", repeated.len() - MAX_LISTED));
    }
}

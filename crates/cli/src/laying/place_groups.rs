//! The places that take the same part.

use magsplice::layout::{Layout, Part};
use magsplice::making::PlaceGroup;

/// The places of each part of a layout, without tiles.
pub(crate) fn place_groups(layout: &Layout) -> Vec<PlaceGroup> {
    let group = |part: Part| PlaceGroup {
        size_mm: part.size_mm,
        polarization_t: part.strength_t * part.direction,
        places: part.tiles,
        tiles: Vec::new(),
    };
    layout.parts().into_iter().map(group).collect()
}

//! Findings: properties of a layout that are allowed but usually a mistake.

use glam::DVec3;
use magsplice_magnet::{Tile, overlap};

use crate::layout::{NamedTile, WorkingVolume};
use crate::limits::MAX_LISTED;

/// Findings about tiles without polarization and tiles that reach into the working volume.
pub(crate) fn about_tiles(tiles: &[NamedTile], volume: Option<&WorkingVolume>) -> Vec<String> {
    let without = tiles.iter().filter(|named| named.tile.polarization_t() == DVec3::ZERO);
    let of_tile = |finding: &'static str| move |named: &NamedTile| format!("tile \"{}\" {finding}", named.name);
    let mut findings = listed(without, of_tile("has no polarization, so no field"), "tiles");
    let region =
        volume.and_then(|v| Tile::new(0.5 * (v.lower_mm + v.upper_mm), v.upper_mm - v.lower_mm, DVec3::ZERO).ok());
    if let Some(region) = region {
        let reaching = tiles.iter().filter(|named| overlap(&region, &named.tile).is_some());
        findings.extend(listed(reaching, of_tile("reaches into the working volume"), "tiles"));
    }
    findings
}

/// One finding for each item: the first [`MAX_LISTED`] by name, the others as one count.
pub(crate) fn listed<T>(mut items: impl Iterator<Item = T>, finding: impl Fn(T) -> String, sort: &str) -> Vec<String> {
    let mut found: Vec<String> = items.by_ref().take(MAX_LISTED).map(&finding).collect();
    if let Some(next) = items.next() {
        found.push(format!("{} more {sort}, such as: {}", 1 + items.count(), finding(next)));
    }
    found
}

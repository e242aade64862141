//! Findings: properties of a layout that are allowed but usually a mistake.

use glam::DVec3;
use magsplice_magnet::{Tile, overlap};

use crate::layout::{NamedTile, WorkingVolume};
use crate::limits::MAX_LISTED;

/// Findings about tiles without polarization and tiles that reach into the working volume.
pub(crate) fn about_tiles(tiles: &[NamedTile], volume: Option<&WorkingVolume>) -> Vec<String> {
    let without = tiles.iter().filter(|named| named.tile.polarization_t() == DVec3::ZERO);
    let mut findings = listed(without, "has no polarization, so no field");
    let region =
        volume.and_then(|v| Tile::new(0.5 * (v.lower_mm + v.upper_mm), v.upper_mm - v.lower_mm, DVec3::ZERO).ok());
    if let Some(region) = region {
        let reaching = tiles.iter().filter(|named| overlap(&region, &named.tile).is_some());
        findings.extend(listed(reaching, "reaches into the working volume"));
    }
    findings
}

/// One finding for each tile: the first [`MAX_LISTED`] by name, the others as one count.
fn listed<'a>(tiles: impl Iterator<Item = &'a NamedTile>, finding: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut more = 0;
    for tile in tiles {
        if found.len() < MAX_LISTED {
            found.push(format!("tile \"{}\" {finding}", tile.name));
        } else {
            more += 1;
        }
    }
    if more > 0 {
        found.push(format!("and {more} more tiles: {finding}"));
    }
    found
}

//! What is allowed in a layout but rarely meant.

use glam::DVec3;
use magsplice_field::{Tile, overlap};

use crate::layout::{NamedTile, WorkingVolume};

/// At most this many tiles are named for one reason.
const NAMED_TILES: usize = 20;

/// Tiles without polarization, and tiles that reach into the working volume.
pub(crate) fn of_tiles(tiles: &[NamedTile], volume: Option<&WorkingVolume>) -> Vec<String> {
    let idle = tiles.iter().filter(|named| named.tile.polarization_t() == DVec3::ZERO);
    let mut findings = some(idle, "has no polarization, so no field");
    let region =
        volume.and_then(|v| Tile::new(0.5 * (v.lower_mm + v.upper_mm), v.upper_mm - v.lower_mm, DVec3::ZERO).ok());
    if let Some(region) = region {
        let reaching = tiles.iter().filter(|named| overlap(&region, &named.tile).is_some());
        findings.extend(some(reaching, "reaches into the working volume"));
    }
    findings
}

/// One finding for each tile, the first few by name and the rest by number.
fn some<'a>(tiles: impl Iterator<Item = &'a NamedTile>, what: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut more = 0;
    for tile in tiles {
        if found.len() < NAMED_TILES {
            found.push(format!("tile \"{}\" {what}", tile.name));
        } else {
            more += 1;
        }
    }
    if more > 0 {
        found.push(format!("and {more} more tiles: {what}"));
    }
    found
}

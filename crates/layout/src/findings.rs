//! What is allowed in a layout but rarely meant.

use glam::DVec3;
use magsplice_field::{Tile, overlaps};

use crate::layout::{NamedTile, WorkingVolume};

/// Tiles without polarization, and tiles that reach into the working volume.
pub(crate) fn of_tiles(tiles: &[NamedTile], volume: Option<&WorkingVolume>) -> Vec<String> {
    let idle = tiles.iter().filter(|named| named.tile.polarization_t() == DVec3::ZERO);
    let mut findings: Vec<String> =
        idle.map(|t| format!("tile \"{}\" has no polarization, so no field", t.name)).collect();
    let region =
        volume.and_then(|v| Tile::new(0.5 * (v.lower_mm + v.upper_mm), v.upper_mm - v.lower_mm, DVec3::ZERO).ok());
    if let Some(region) = region {
        let reaching = tiles.iter().filter(|named| !overlaps(&[region, named.tile]).is_empty());
        findings.extend(reaching.map(|t| format!("tile \"{}\" reaches into the working volume", t.name)));
    }
    findings
}

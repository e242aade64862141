//! Properties of tiles that are allowed but usually a mistake.

/// Findings about lengths: tiles, ideal film and volume beside each other.
pub(crate) mod lengths;

use glam::DVec3;
use magsplice_magnet::{Tile, overlap};

use crate::finding::{Finding, FindingSubject, listed};
use crate::layout::NamedTile;
use crate::plausible::{STRONGEST_MAGNET_T, doubt, short};
use crate::volume::WorkingVolume;

/// Round-off of a magnitude that is computed from three components.
const MAGNITUDE_ROUNDING: f64 = 1e-12;

/// Findings about tiles without polarization, stronger than any magnet, and in the working volume.
pub(crate) fn about_tiles(tiles: &[NamedTile], volume: Option<&WorkingVolume>) -> Vec<Finding> {
    let without = tiles.iter().filter(|named| named.tile.polarization_t() == DVec3::ZERO);
    let of_tile = |finding: &'static str| move |named: &NamedTile| format!("tile \"{}\" {finding}", named.name);
    let mut findings = listed(without, FindingSubject::Tiles, of_tile("has no polarization, so no field"), "tiles");
    let magnitude = |named: &NamedTile| named.tile.polarization_t().length();
    let strong = tiles.iter().filter(|named| magnitude(named) > STRONGEST_MAGNET_T * (1.0 + MAGNITUDE_ROUNDING));
    let beyond = |named: &NamedTile| {
        let subject = format!("tile \"{}\": a polarization", named.name);
        doubt(&subject, short(magnitude(named))).unwrap_or(subject)
    };
    findings.extend(listed(strong, FindingSubject::Tiles, beyond, "tiles"));
    let region =
        volume.and_then(|v| Tile::new(0.5 * (v.lower_mm + v.upper_mm), v.upper_mm - v.lower_mm, DVec3::ZERO).ok());
    if let Some(region) = region {
        let reaching = tiles.iter().filter(|named| overlap(&region, &named.tile).is_some());
        let reaches = of_tile("reaches into the working volume");
        findings.extend(listed(reaching, FindingSubject::Volume, reaches, "tiles"));
    }
    findings
}

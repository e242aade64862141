//! Properties of tiles that are allowed but usually a mistake.

/// Findings about lengths: tiles, ideal film and volume beside each other.
pub(crate) mod lengths;

use glam::DVec3;
use magsplice_magnet::box_overlap;

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
    if let Some(volume) = volume {
        let is_in_volume = |named: &&NamedTile| box_overlap(volume.lower_mm, volume.upper_mm, &named.tile).is_some();
        let reaching = tiles.iter().filter(is_in_volume);
        let reaches = of_tile("reaches into the working volume");
        findings.extend(listed(reaching, FindingSubject::Volume, reaches, "tiles"));
    }
    findings
}

//! Findings: properties of a layout that are allowed but usually a mistake.

use std::f64::consts::PI;

use glam::DVec3;
use magsplice_magnet::{Tile, overlap};

use crate::expectations::Expectations;
use crate::finding::{Finding, FindingSubject};
use crate::layout::{NamedTile, WorkingVolume};
use crate::limits::MAX_LISTED;
use crate::plausible::{STRONGEST_MAGNET_T, short};
use crate::read::strength_rules::doubt;

/// Fraction of |B| from which on a tolerance of a baseline was probably meant in another unit.
const LARGEST_WITHIN: f64 = 0.1;

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

/// Findings about expectations that every film meets.
pub(crate) fn about_expectations(expected: &Expectations) -> Vec<Finding> {
    let mut messages = Vec::new();
    // R_x and R_y are angles between -pi and pi, so that they do not deviate more from their mean.
    for (key, bound) in ["r_x", "r_y"].into_iter().zip(expected.uniformity_rmse) {
        if let Some(bound) = bound.filter(|bound| *bound >= PI) {
            messages.push(format!(
                "expect: uniformity_rmse.{key} = {bound} is kept by every film: it bounds an angle in rad, not in mrad or \
                 degrees"
            ));
        }
    }
    if let Some(least) = expected.least_amplitude.filter(|least| *least <= 0.0) {
        messages.push(format!(
            "expect: amplitude.min = {least} is also kept by a film that is reversed or without a field: give a fraction of \
             the ideal film's field, such as 0.8"
        ));
    }
    if let Some(field) = expected.field.as_ref().filter(|field| field.within >= LARGEST_WITHIN) {
        messages.push(format!(
            "expect: field.within = {} is a fraction of |B|, {} %, and accepts a film that is far from its baseline",
            field.within,
            100.0 * field.within
        ));
    }
    messages.into_iter().map(|message| Finding::new(FindingSubject::Expectations, message)).collect()
}

/// One finding for each item: the first [`MAX_LISTED`] by name, the others as one count.
pub(crate) fn listed<T>(
    mut items: impl Iterator<Item = T>,
    subject: FindingSubject,
    finding: impl Fn(T) -> String,
    sort: &str,
) -> Vec<Finding> {
    let mut found: Vec<String> = items.by_ref().take(MAX_LISTED).map(&finding).collect();
    if let Some(next) = items.next() {
        found.push(format!("{} more {sort}, such as: {}", 1 + items.count(), finding(next)));
    }
    found.into_iter().map(|message| Finding::new(subject, message)).collect()
}

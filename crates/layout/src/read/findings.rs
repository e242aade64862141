//! Findings: properties of a layout that are allowed but usually a mistake.

use std::f64::consts::PI;

use glam::DVec3;
use magsplice_decouple::{PerAxis, PerParameter};
use magsplice_ideal::IdealFilm;
use magsplice_magnet::{Tile, overlap};

use crate::expectations::Expectations;
use crate::finding::{Finding, FindingSubject};
use crate::layout::{NamedTile, WorkingVolume};
use crate::limits::MAX_LISTED;
use crate::plausible::{STRONGEST_MAGNET_T, short, typed};
use crate::read::strength_rules::doubt;

/// Fraction of |B| from which on a tolerance of a baseline was probably meant in another unit.
const LARGEST_WITHIN: f64 = 0.1;

/// A best-fit amplitude above which a bound was probably meant in percent. A film is seldom twice
/// as strong as its ideal film.
const LARGEST_AMPLITUDE: f64 = 10.0;

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

/// Findings about expectations that every film meets, and about bounds in another unit.
pub(crate) fn about_expectations(expected: &Expectations, ideal: Option<&IdealFilm>) -> Vec<Finding> {
    let mut messages = Vec::new();
    // R_x and R_y are angles between -pi and pi, so that they do not deviate more from their mean.
    let PerParameter { r_x, r_y, s_z } = expected.bounds.uniformity_rmse;
    for (key, bound) in [("r_x", r_x), ("r_y", r_y)] {
        if let Some(bound) = bound.filter(|bound| *bound >= PI) {
            messages.push(format!(
                "expect: uniformity_rmse.{key} = {bound} is kept by every film: it bounds an angle in rad, not in mrad or \
                 degrees"
            ));
        }
    }
    if let Some(bound) = s_z.filter(|bound| *bound >= PI) {
        messages.push(format!(
            "expect: uniformity_rmse.s_z = {bound} is kept by almost every film: S_z is a natural logarithm, so that a flux \
             density may vary by a factor of exp({bound}) at equal z; it is no percentage"
        ));
    }
    messages.extend(ideal.iter().flat_map(|ideal| about_displacement(expected.bounds.displacement_rmse_mm, ideal)));
    if let Some(least) = expected.least_clearance_mm.filter(|least| *least < 0.0) {
        messages.push(format!(
            "expect: clearance_mm.min = {least} lets tiles reach {} mm into the working volume, in the way of the sensor: \
             give at least 0",
            -least
        ));
    }
    if let Some(least) = expected.bounds.least_amplitude.filter(|least| *least <= 0.0) {
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
    let found = messages.into_iter().map(|message| Finding::new(FindingSubject::Expectations, message));
    let of_amplitude =
        expected.bounds.least_amplitude.and_then(|least| about_amplitude(FindingSubject::Expectations, least));
    found.chain(of_amplitude).collect()
}

/// Bounds of the displacement that say nothing. R_x and R_y are angles, so that displacements along
/// x and y are at most half the wavelength off.
fn about_displacement(bounds_mm: PerAxis<Option<f64>>, ideal: &IdealFilm) -> Vec<String> {
    let half = 0.5 * ideal.wavelength();
    let mut messages = Vec::new();
    for (axis, bound) in ["x", "y", "z"].into_iter().zip(bounds_mm.to_array()) {
        let Some(bound) = bound.filter(|bound| *bound >= half) else { continue };
        let films = if axis == "z" { "almost every film" } else { "every film" };
        let meant_mm = 1e-3 * bound;
        let meant = if meant_mm < half {
            format!("; did you mean {} mm, which is {bound} um?", typed(meant_mm))
        } else {
            String::new()
        };
        messages.push(format!(
            "expect: displacement_rmse_mm.{axis} = {bound} is kept by {films}: it is not below half the wavelength, \
             {half} mm{meant}"
        ));
    }
    messages
}

/// The finding about a least amplitude in percent, in the table of the subject.
pub(crate) fn about_amplitude(subject: FindingSubject, least: f64) -> Option<Finding> {
    let table = if subject == FindingSubject::Design { "design" } else { "expect" };
    (least > LARGEST_AMPLITUDE).then(|| {
        let message = format!(
            "{table}: amplitude.min = {least} is a fraction of the ideal film's field, so {} %: did you mean {}?",
            typed(100.0 * least),
            typed(0.01 * least)
        );
        Finding::new(subject, message)
    })
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

//! Rules for magnitudes of polarizations: no material has more than a few tesla.

use glam::DVec3;

use crate::plausible::{STRONGEST_MAGNET_T, STRONGEST_MATERIAL_T, meant_polarization};
use crate::read::faults::TableFaults;

/// Requires a magnitude of the polarization that is finite, not negative, and that a material has.
pub(crate) fn check_strength(strength_t: Option<f64>, faults: &mut TableFaults) {
    let Some(strength) = strength_t else { return };
    if !(strength.is_finite() && strength >= 0.0) {
        faults.add(format!(
            "strength_t = {strength}, must be a finite number of at least 0 (reverse the direction instead)"
        ));
    }
    check_material("strength_t", strength, faults);
}

/// Requires a magnitude that a material has. Numbers that are not finite are matters of other
/// rules.
pub(crate) fn check_material(key: &str, value_t: f64, faults: &mut TableFaults) {
    if is_beyond(value_t) {
        faults.add(format!("{key} = {value_t}, {}", rule(value_t)));
    }
}

/// Requires a polarization whose magnitude a material has.
pub(crate) fn check_polarization(polarization_t: Option<[f64; 3]>, faults: &mut TableFaults) {
    let Some(polarization) = polarization_t else { return };
    let magnitude = DVec3::from(polarization).length();
    if is_beyond(magnitude) {
        let one_axis = polarization.iter().filter(|component| **component != 0.0).count() == 1;
        let magnitude_is = if one_axis { String::new() } else { format!(" has a magnitude of {magnitude:.4} T") };
        let rule = rule(magnitude);
        faults.add(format!("polarization_t = {polarization:?}{magnitude_is}, {rule}"));
    }
}

/// Requires products of the pattern and the factor, in T, that a material has.
pub(crate) fn check_component(component_t: f64, largest_pattern: f64, faults: &mut TableFaults) {
    let magnitude = component_t * largest_pattern;
    if is_beyond(magnitude) {
        let rule = rule(magnitude);
        faults.add(format!("component_t = {component_t} times the pattern is up to {magnitude:.4} T, {rule}"));
    }
}

fn is_beyond(magnitude_t: f64) -> bool {
    magnitude_t.is_finite() && magnitude_t.abs() > STRONGEST_MATERIAL_T
}

fn rule(magnitude_t: f64) -> String {
    let meant = meant_polarization(magnitude_t);
    format!("must be at most {STRONGEST_MATERIAL_T} T, more than any material has; {meant}")
}

/// The finding about a magnitude that a material has, but no permanent magnet. `subject` names what
/// has it.
pub(crate) fn doubt(subject: &str, magnitude_t: f64) -> Option<String> {
    (magnitude_t.abs() > STRONGEST_MAGNET_T).then(|| {
        format!("{subject} of {magnitude_t} T is above {STRONGEST_MAGNET_T} T, more than any permanent magnet has")
    })
}

//! Magnitudes that no magnet and no film has, and the unit in which such a number was probably
//! meant.
//!
//! A number in the wrong unit is well-formed, and the field that follows from it is plausible: it
//! is proportional to the polarization, and depends on ratios of lengths only. Only the magnitude
//! shows the mistake.

use glam::DVec3;
use magsplice_magnet::MU_0;

use crate::faults::{NOT_NEGATIVE, Rule, TableFaults};

/// Polarization in T above which no permanent magnet exists. Nd2Fe14B, the strongest material, has
/// a saturation polarization of 1.6 T; magnets of it reach 1.5 T.
pub const STRONGEST_MAGNET_T: f64 = 2.0;

/// Polarization in T above which no material exists that has it uniformly. Saturated iron-cobalt
/// has 2.45 T, more than any other material at room temperature.
pub const STRONGEST_MATERIAL_T: f64 = 2.5;

/// Wavelength in mm below which no film can be spliced: its narrowest tiles would have a few
/// thousandths of a millimetre, the resolution of machine tools.
pub const SHORTEST_WAVELENGTH_MM: f64 = 0.1;

/// Largest ratio of the wavelength to another length of a film or of its working volume. A length
/// in metres instead of millimetres is a thousand times too small.
pub const MAX_LENGTH_RATIO: f64 = 1000.0;

/// Polarizations above this many T were probably meant in gauss, not in mT: no magnet has 2500 mT.
const GAUSS_FROM: f64 = 2500.0;

/// Polarizations above this many T were probably meant as magnetizations in A/m: no magnet has
/// 25000 G.
const AMPERES_PER_METRE_FROM: f64 = 25_000.0;

/// The polarization that a number in T that no material has was probably meant to be, as a
/// question.
///
/// # Example
/// ```
/// use magsplice_layout::meant_polarization;
///
/// assert_eq!(meant_polarization(120.0), "did you mean 0.12 T, which is 120 mT?");
/// assert_eq!(meant_polarization(12000.0), "did you mean 1.2 T, which is 12000 G?");
/// assert_eq!(meant_polarization(955e3), "did you mean J = mu0 M = 1.2 T, for M = 955000 A/m?");
/// ```
pub fn meant_polarization(value_t: f64) -> String {
    let value_t = value_t.abs();
    let question = |factor: f64, unit: &str| {
        format!("did you mean {} T, which is {} {unit}?", short(factor * value_t), typed(value_t))
    };
    if value_t <= GAUSS_FROM {
        return question(1e-3, "mT");
    }
    if value_t <= AMPERES_PER_METRE_FROM {
        return question(1e-4, "G");
    }
    let polarization_t = MU_0 * value_t;
    if polarization_t <= STRONGEST_MATERIAL_T {
        return format!("did you mean J = mu0 M = {} T, for M = {} A/m?", short(polarization_t), typed(value_t));
    }
    "give the polarization J = mu0 M in T".to_owned()
}

/// The length that a number in mm that is far too small was probably meant to be, as a question.
///
/// # Example
/// ```
/// assert_eq!(magsplice_layout::meant_length(0.008), "did you mean 8 mm, which is 0.008 m?");
/// ```
pub fn meant_length(value_mm: f64) -> String {
    format!("did you mean {} mm, which is {value_mm} m?", short(1e3 * value_mm))
}

/// Requires a magnitude of the polarization that is finite, not negative, and that a material has.
pub(crate) fn check_strength(strength_t: Option<f64>, faults: &mut TableFaults) {
    let words = "must be a finite number of at least 0 (reverse the direction instead)";
    faults.number("strength_t", strength_t, Rule { words, ..NOT_NEGATIVE });
    check_material("strength_t", strength_t, faults);
}

/// Requires a magnitude that a material has, if it is given. Numbers that are not finite are
/// matters of other rules.
pub(crate) fn check_material(key: &str, value_t: impl Into<Option<f64>>, faults: &mut TableFaults) {
    if let Some(value_t) = value_t.into().filter(|value_t| is_beyond(*value_t)) {
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

/// The finding about a magnitude that a material has, but no permanent magnet. The message begins
/// with `subject`.
pub(crate) fn doubt(subject: &str, magnitude_t: f64) -> Option<String> {
    (magnitude_t.abs() > STRONGEST_MAGNET_T).then(|| {
        format!("{subject} of {magnitude_t} T is above {STRONGEST_MAGNET_T} T, more than any permanent magnet has")
    })
}

/// Three significant digits, without the round-off of a product.
pub(crate) fn short(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// Twelve significant digits, more than anyone types: without the round-off of sums and products of
/// decimal numbers.
pub(crate) fn typed(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::faults::Faults;

    /// The messages about the polarizations of these numbers, by the rule of each key.
    #[test]
    fn polarizations_that_no_material_has_are_refused() {
        let messages = |check: &dyn Fn(&mut TableFaults)| -> Vec<String> {
            let mut faults = Faults::new("");
            check(&mut faults.at(0, "tile"));
            faults.into_sorted().into_iter().map(|fault| fault.message).collect()
        };
        let rule = "must be at most 2.5 T, more than any material has; did you mean 0.003 T, which is 3 mT?";
        assert_eq!(messages(&|faults| check_strength(Some(3.0), faults)), [format!("strength_t = 3, {rule}")]);
        assert_eq!(messages(&|faults| check_strength(Some(2.5), faults)), [""; 0]);
        assert_eq!(messages(&|faults| check_strength(None, faults)), [""; 0]);
        assert_eq!(messages(&|faults| check_strength(Some(-1.0), faults)).len(), 1);
        let key = "remanence_t";
        assert_eq!(messages(&|faults| check_material(key, -3.0, faults)), [format!("remanence_t = -3, {rule}")]);
        // Numbers that are not finite are matters of other rules.
        assert_eq!(messages(&|faults| check_material(key, f64::INFINITY, faults)), [""; 0]);
        let one = messages(&|faults| check_polarization(Some([0.0, -3.0, 0.0]), faults));
        assert_eq!(one, [format!("polarization_t = [0.0, -3.0, 0.0], {rule}")]);
        let two = messages(&|faults| check_polarization(Some([1.8, -2.4, 0.0]), faults));
        assert_eq!(two, [format!("polarization_t = [1.8, -2.4, 0.0] has a magnitude of 3.0000 T, {rule}")]);
        assert_eq!(messages(&|faults| check_polarization(Some([1.5, -2.0, 0.0]), faults)), [""; 0]);
        let component = messages(&|faults| check_component(1.5, 2.0, faults));
        assert_eq!(component, [format!("component_t = 1.5 times the pattern is up to 3.0000 T, {rule}")]);
        assert_eq!(messages(&|faults| check_component(1.5, 1.6, faults)), [""; 0]);
    }

    /// Numbers in millitesla up to 2500, in gauss up to 25000, then in A/m, of a magnet's strength.
    #[test]
    fn polarizations_in_other_units_are_guessed() {
        for (value_t, meant) in [
            (2500.0, "did you mean 2.5 T, which is 2500 mT?"),
            (-2501.0, "did you mean 0.25 T, which is 2501 G?"),
            (25000.0, "did you mean 2.5 T, which is 25000 G?"),
            (25001.0, "did you mean J = mu0 M = 0.0314 T, for M = 25001 A/m?"),
            (1.98e6, "did you mean J = mu0 M = 2.49 T, for M = 1980000 A/m?"),
            (2e6, "give the polarization J = mu0 M in T"),
        ] {
            assert_eq!(meant_polarization(value_t), meant);
        }
    }

    #[test]
    fn magnitudes_above_those_of_magnets_are_doubted() {
        assert_eq!(doubt("a tile", 2.0), None);
        let found = doubt("a tile", -2.1).expect("a doubt");
        assert_eq!(found, "a tile of -2.1 T is above 2 T, more than any permanent magnet has");
        assert_eq!([short(0.123_456), short(1e-3 * 70.0), typed(0.1 + 0.2)], [0.123, 0.07, 0.3]);
    }
}

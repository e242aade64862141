//! Rules of `[material]` and of the key `recoil_permeability`.

use magsplice_magnet::{MAX_PERMEABILITY, Permeability};

use crate::finding::{Finding, FindingSubject};
use crate::material::Material;
use crate::plausible::short;
use crate::read::faults::TableFaults;
use crate::read::number_rules::check_positive;
use crate::tables::material::{MaterialTable, RecoilPermeability};

/// Largest relative change of the strength per kelvin. Hard ferrite, the material that changes
/// most, has 0.002.
const MOST_PER_KELVIN: f64 = 0.02;

/// Largest recoil permeability that a magnet has: that of Alnico. Rare-earth magnets, bonded or
/// sintered, and ferrite have 1.03 to 1.2.
const MOST_OF_MAGNETS: f64 = 6.0;

/// Least share for the error of what recoil changes. Errors fall with the square of the level, and
/// the number of cells grows with its cube: a hundred times less needs a thousand times more cells.
const LEAST_RECOIL_ERROR: f64 = 1e-4;

/// The material. Faults are added.
pub(crate) fn resolve(table: &MaterialTable, faults: &mut TableFaults, findings: &mut Vec<Finding>) -> Material {
    let stated = table.recoil_permeability.and_then(|written| permeability(written, faults));
    let permeability = stated.unwrap_or(Permeability::RIGID);
    if permeability.along().max(permeability.across()) > MOST_OF_MAGNETS {
        findings.push(Finding::new(
            FindingSubject::Tiles,
            format!(
                "material: recoil_permeability = {} is above {MOST_OF_MAGNETS}, and magnets have 1.03 to 1.2, Alnico up to \
                 5",
                permeability.along().max(permeability.across())
            ),
        ));
    }
    let recoil_error = table.recoil_error.unwrap_or(Material::default().recoil_error);
    if !(LEAST_RECOIL_ERROR..1.0).contains(&recoil_error) {
        faults.add(format!("recoil_error = {recoil_error}, must be at least {LEAST_RECOIL_ERROR} and below 1"));
    }
    if let Some(knee_field_t) = table.knee_field_t {
        check_positive("knee_field_t", knee_field_t, faults);
    }
    if let Some(per_k) = table.strength_per_k {
        check_strength_per_k(per_k, faults);
    }
    Material { permeability, recoil_error, knee_field_t: table.knee_field_t, strength_per_k: table.strength_per_k }
}

/// The permeability that is written, or `None` after adding its faults.
pub(crate) fn permeability(written: RecoilPermeability, faults: &mut TableFaults) -> Option<Permeability> {
    let before = faults.count();
    let mut check = |key: &str, value: f64| {
        if !(1.0..=MAX_PERMEABILITY).contains(&value) {
            let susceptibility = if (0.0..1.0).contains(&value) {
                format!(" (the permeability, not the susceptibility: {}?)", short(1.0 + value))
            } else {
                String::new()
            };
            faults.add(format!("{key} = {value}, must be from 1 to {MAX_PERMEABILITY}{susceptibility}"));
        }
        value
    };
    let (along, across) = match written {
        RecoilPermeability::Isotropic(value) => {
            let value = check("recoil_permeability", value);
            (value, value)
        }
        RecoilPermeability::Axes(axes) => {
            (check("recoil_permeability.along", axes.along), check("recoil_permeability.across", axes.across))
        }
    };
    if faults.count() > before { None } else { Permeability::along_and_across(along, across).ok() }
}

/// Requires a relative change of the strength per kelvin that a magnet can have.
pub(crate) fn check_strength_per_k(per_k: f64, faults: &mut TableFaults) {
    if !per_k.is_finite() {
        faults.add(format!("strength_per_k = {per_k}, must be a finite number"));
    } else if per_k.abs() > MOST_PER_KELVIN {
        faults.add(format!(
            "strength_per_k = {per_k}, must be from -{MOST_PER_KELVIN} to {MOST_PER_KELVIN} (a fraction, not per cent: {}?)",
            short(1e-2 * per_k)
        ));
    }
}

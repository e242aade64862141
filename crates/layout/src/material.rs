//! `[material]`: the material of the tiles, and the key `recoil_permeability` of tiles and kinds.

// Descriptions of the JSON Schema, which are no links, write tables in brackets.
#![allow(rustdoc::broken_intra_doc_links)]

use magsplice_magnet::{MAX_PERMEABILITY, Permeability};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::{FINITE, POSITIVE, TableFaults};
use crate::finding::FindingSubject;
use crate::plausible::short;

/// Default share of the largest change of B by recoil that its error may have. The estimate of the
/// error is far above the error itself (docs/recoil.md), and the permeability of a magnet is known
/// to 0.01 at best, for 1.05 a fifth of the change. Films need the least level at which an error is
/// known.
const RECOIL_ERROR: f64 = 0.3;

/// Largest relative change of the strength per kelvin. Hard ferrite, the material that changes
/// most, has 0.002.
const MOST_PER_KELVIN: f64 = 0.02;

/// Largest recoil permeability of a magnet, which Alnico has. Rare-earth magnets, bonded or
/// sintered, and ferrite have 1.03 to 1.2.
const MOST_OF_MAGNETS: f64 = 6.0;

/// Least share for the error of what recoil changes. Errors fall with the square of the level, and
/// the number of cells grows with its cube: a hundred times less needs a thousand times more cells.
const LEAST_RECOIL_ERROR: f64 = 1e-4;

/// The material of the tiles. The default is a magnet whose polarization no field changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// The relative recoil permeability of tiles that have none of their own.
    pub permeability: Permeability,
    /// Largest error of what recoil changes in B, as a share of its largest change.
    pub recoil_error: f64,
    /// mu0 times the magnitude of H at the knee of the demagnetization curve, in tesla. `None` if
    /// it is not stated.
    pub knee_field_t: Option<f64>,
    /// Relative change of the strength of all tiles per kelvin. `None` if it is not stated.
    pub strength_per_k: Option<f64>,
}

impl Default for Material {
    fn default() -> Material {
        Material {
            permeability: Permeability::RIGID,
            recoil_error: RECOIL_ERROR,
            knee_field_t: None,
            strength_per_k: None,
        }
    }
}

/// The material of the tiles.
#[derive(Deserialize, JsonSchema, Serialize)]
#[schemars(rename = "Material")]
pub(crate) struct MaterialTable {
    /// Relative recoil permeability of tiles that have none of their own. Default: 1, no field
    /// changes the polarization.
    recoil_permeability: Option<RecoilPermeability>,
    /// Largest error of what recoil changes in B, as a share of its largest change. Smaller errors
    /// need more cells. Default: 0.3.
    recoil_error: Option<f64>,
    /// mu0 times the magnitude of H at the knee of the demagnetization curve, in T. Tiles beyond it
    /// are reported. Default: not known.
    knee_field_t: Option<f64>,
    /// Relative change of the strength of all tiles per kelvin, a fraction: -0.0012 is -0.12 % per
    /// kelvin. [tolerance.temperature] takes it.
    strength_per_k: Option<f64>,
}

/// A relative recoil permeability: a number, or one along the direction of the polarization and one
/// across it.
#[derive(Clone, Copy, Deserialize, JsonSchema, Serialize)]
#[serde(untagged)]
pub(crate) enum RecoilPermeability {
    /// The same in all directions.
    Isotropic(f64),
    /// Along the polarization and across it.
    Axes(AlongAndAcross),
}

/// Relative recoil permeabilities along the direction of the polarization and across it.
#[derive(Clone, Copy, Deserialize, JsonSchema, Serialize)]
#[schemars(extend("example" = "{ along = 1.05, across = 1.15 }"))]
pub(crate) struct AlongAndAcross {
    /// Along the polarization, the easy axis.
    along: f64,
    /// Across the polarization.
    across: f64,
}

impl MaterialTable {
    /// The material. Faults are added.
    pub(crate) fn resolve(&self, faults: &mut TableFaults) -> Material {
        let defaults = Material::default();
        let stated = self.recoil_permeability.and_then(|written| written.resolve(faults));
        let permeability = stated.unwrap_or(defaults.permeability);
        let largest = permeability.along().max(permeability.across());
        if largest > MOST_OF_MAGNETS {
            let message = format!(
                "material: recoil_permeability = {largest} is above {MOST_OF_MAGNETS}, and magnets have 1.03 to 1.2, \
                 Alnico up to 5"
            );
            faults.remark(FindingSubject::Tiles, message);
        }
        let recoil_error = self.recoil_error.unwrap_or(defaults.recoil_error);
        let is_kept = (LEAST_RECOIL_ERROR..1.0).contains(&recoil_error);
        let rule = format_args!("must be at least {LEAST_RECOIL_ERROR} and below 1");
        faults.require(is_kept, "recoil_error", recoil_error, rule);
        faults.number("knee_field_t", self.knee_field_t, POSITIVE);
        check_strength_per_k(self.strength_per_k, faults);
        Material { permeability, recoil_error, knee_field_t: self.knee_field_t, strength_per_k: self.strength_per_k }
    }

    /// The table of a material; `None` for the default.
    pub(crate) fn of(material: &Material) -> Option<MaterialTable> {
        let Material { permeability, recoil_error, knee_field_t, strength_per_k } = *material;
        let defaults = Material::default();
        (*material != defaults).then(|| MaterialTable {
            recoil_permeability: (!permeability.is_rigid()).then(|| permeability.into()),
            recoil_error: (recoil_error != defaults.recoil_error).then_some(recoil_error),
            knee_field_t,
            strength_per_k,
        })
    }
}

impl RecoilPermeability {
    /// The permeability, or `None` after adding its faults.
    pub(crate) fn resolve(self, faults: &mut TableFaults) -> Option<Permeability> {
        let before = faults.count();
        let mut check = |key: &str, value: f64| {
            let susceptibility = if (0.0..1.0).contains(&value) {
                format!(" (the permeability, not the susceptibility: {}?)", short(1.0 + value))
            } else {
                String::new()
            };
            let rule = format_args!("must be from 1 to {MAX_PERMEABILITY}{susceptibility}");
            faults.require((1.0..=MAX_PERMEABILITY).contains(&value), key, value, rule);
            value
        };
        let (along, across) = match self {
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
}

impl From<Permeability> for RecoilPermeability {
    /// One number if it is the same in all directions.
    fn from(permeability: Permeability) -> RecoilPermeability {
        let (along, across) = (permeability.along(), permeability.across());
        if along == across {
            RecoilPermeability::Isotropic(along)
        } else {
            RecoilPermeability::Axes(AlongAndAcross { along, across })
        }
    }
}

/// Requires a relative change of the strength per kelvin that a magnet can have, if it is given.
pub(crate) fn check_strength_per_k(per_k: Option<f64>, faults: &mut TableFaults) {
    faults.number("strength_per_k", per_k, FINITE);
    let Some(per_k) = per_k else { return };
    let rule = format_args!(
        "must be from -{MOST_PER_KELVIN} to {MOST_PER_KELVIN} (a fraction, not per cent: {}?)",
        short(1e-2 * per_k)
    );
    faults.require(!(per_k.abs() > MOST_PER_KELVIN && per_k.is_finite()), "strength_per_k", per_k, rule);
}

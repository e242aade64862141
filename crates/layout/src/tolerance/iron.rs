//! `[tolerance.iron]`: flat iron near the film.

// Descriptions of the JSON Schema, which are no links, write tables in brackets.
#![allow(rustdoc::broken_intra_doc_links)]

use magsplice_magnet::{IronPlane, MAX_LENGTH};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error_unit::ErrorUnit;
use crate::faults::Rule;
use crate::plane::{DEFAULT_PERMEABILITY, resolve_normal, resolve_permeability, written_permeability};
use crate::tolerance::NearIron;
use crate::tolerance::common::When;
use crate::tolerance::tabulated::ErrorTable;
use crate::tolerance::written::{Components, ErrorKey};

/// Flat iron near the film, such as a steel plate on which the sensor is put down: a half space
/// behind a plane that does not move with the film.
#[derive(Deserialize, JsonSchema, Serialize)]
pub(crate) struct IronTable {
    /// Distance of the iron from the nearest corner of the film as ordered, in mm.
    #[schemars(extend("example" = 1.0))]
    distance_mm: f64,
    /// Error of this distance, in mm. It must be smaller than the distance in every film, as
    /// { uniform = 0.2 } or { normal = 0.1, within = 0.3 }. Default: none.
    #[serde(default)]
    distance_error_mm: Components<1>,
    /// Direction out of the iron, towards the film. Default: [0, 0, -1], iron above the film.
    #[serde(skip_serializing_if = "Option::is_none")]
    normal: Option<[f64; 3]>,
    /// Relative permeability of the iron: 1 or more, or inf. Default: inf.
    #[serde(skip_serializing_if = "Option::is_none")]
    relative_permeability: Option<f64>,
    /// Whether the iron is there when the sensor is read at the reference point. Default: after.
    #[serde(default = "after")]
    when: When,
}

const DISTANCE: Rule = Rule { is_kept: |mm| mm > 0.0 && mm <= MAX_LENGTH, words: "must be above 0" };

fn after() -> When {
    When::After
}

impl IronTable {
    fn key<'k>(&'k mut self, iron: &'k mut NearIron) -> ErrorKey<'k> {
        let errors = std::slice::from_mut(&mut iron.distance_error_mm);
        ErrorKey::new("distance_error_mm", ErrorUnit::Millimetre, &mut self.distance_error_mm, errors)
    }

    /// The iron, or `None` after adding its faults.
    pub(crate) fn resolve(mut self, at: &mut ErrorTable) -> Option<NearIron> {
        let before = at.faults.count();
        at.faults.number("distance_mm", self.distance_mm, DISTANCE);
        let normal = self.normal.unwrap_or(NearIron::ABOVE.to_array());
        let mu_r = self.relative_permeability.unwrap_or(DEFAULT_PERMEABILITY);
        resolve_permeability(mu_r, &mut at.faults);
        resolve_normal(normal, &mut at.faults);
        let mut iron = NearIron {
            normal: normal.into(),
            distance_mm: self.distance_mm,
            later: self.when == When::After,
            relative_permeability: mu_r,
            ..NearIron::default()
        };
        self.key(&mut iron).read(at);
        let most_mm = iron.distance_error_mm.bound();
        if at.faults.count() == before && !(most_mm < self.distance_mm) {
            at.faults.add(format!(
                "distance_error_mm reaches the film in some samples, must be less than distance_mm = {} in all, as \
                 {{ uniform = 0.2 }} or {{ normal = 0.1, within = 0.3 }}",
                self.distance_mm
            ));
        }
        let plane =
            IronPlane::new(Default::default(), iron.normal, mu_r).ok().filter(|_| at.faults.count() == before)?;
        Some(NearIron { normal: plane.normal(), ..iron })
    }
}

impl From<&NearIron> for IronTable {
    fn from(iron: &NearIron) -> IronTable {
        let mut table = IronTable {
            distance_mm: iron.distance_mm,
            distance_error_mm: Components::default(),
            normal: Some(iron.normal.to_array()),
            relative_permeability: written_permeability(iron.relative_permeability),
            when: iron.later.into(),
        };
        let mut copy = iron.clone();
        let key = table.key(&mut copy);
        if key.has_errors() {
            key.write();
        }
        table
    }
}

//! Errors that all tiles share, and those of the surroundings and of the sensor.

// Descriptions of the JSON Schema, which are no links, write tables in brackets.
#![allow(rustdoc::broken_intra_doc_links)]

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error_unit::ErrorUnit;
use crate::finding::{Finding, FindingSubject};
use crate::material::check_strength_per_k;
use crate::plausible::short;
use crate::tolerance::distribution::Distribution;
use crate::tolerance::tabulated::ErrorTable;
use crate::tolerance::written::{Components, WrittenDistribution};
use crate::tolerance::{FilmPose, SensorErrors, StrayField, Temperature};

/// Flux density in microtesla below which a number was probably meant in tesla: a thousandth of a
/// microtesla is far below the noise of any sensor.
const LEAST_FIELD_UT: f64 = 1e-3;

/// Pose of the film against the sensor. The film turns about the centre of its bounding box.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
pub(crate) struct FilmTable {
    /// Errors of position along x, y, z, in mm: one for all axes, or three.
    position_mm: Option<Components<3>>,
    /// Angles about axes parallel to x, y, z, in degrees: one for all axes, or three.
    rotation_deg: Option<Components<3>>,
}

/// A uniform field: the sum of one with given components and one of any direction.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
pub(crate) struct StrayFieldTable {
    /// Components along x, y, z, in microtesla: one for all axes, or three.
    field_ut: Option<Components<3>>,
    /// Magnitude of a field of any direction of space with equal probability, in microtesla.
    any_direction_ut: Option<WrittenDistribution>,
    /// Whether the field is there when the sensor is read at the reference point. Default: before.
    #[serde(default)]
    when: When,
}

/// A change of temperature after the reading at the reference point.
#[derive(Deserialize, JsonSchema, Serialize)]
pub(crate) struct TemperatureTable {
    /// The change, in kelvin.
    change_k: WrittenDistribution,
    /// Relative change of the strength of all tiles per kelvin, a fraction: -0.0012 is -0.12 % per
    /// kelvin. Default: that of [material].
    strength_per_k: Option<f64>,
}

/// Errors of the sensor, along or about its three axes: one for all, or three.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
pub(crate) struct SensorTable {
    /// Offsets, in microtesla.
    offset_ut: Option<Components<3>>,
    /// Angles by which its axes are turned, in degrees.
    rotation_deg: Option<Components<3>>,
    /// Errors of the gain, as fractions: 0.01 is 1 %.
    gain: Option<Components<3>>,
    /// Noise, independent in every reading, in microtesla.
    noise_ut: Option<Components<3>>,
}

/// Whether a cause of errors is there before or after the reading at the reference point.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum When {
    /// There at all readings.
    #[default]
    Before,
    /// There after the reading at the reference point.
    After,
}

impl From<bool> for When {
    fn from(is_later: bool) -> When {
        if is_later { When::After } else { When::Before }
    }
}

impl FilmTable {
    /// The pose of the film, after adding faults. `film_mm` is its longest side.
    pub(crate) fn resolve(&self, film_mm: Option<f64>, at: &mut ErrorTable, findings: &mut Vec<Finding>) -> FilmPose {
        let position_mm = given("position_mm", &self.position_mm, ErrorUnit::Millimetre, at);
        let largest = position_mm.iter().map(Distribution::largest).fold(0.0, f64::max);
        if let Some(film_mm) = film_mm {
            let rule = format_args!(
                "must be less than the longest side of the film, {} mm (mm, not um: {}?)",
                short(film_mm),
                short(1e-3 * largest)
            );
            at.faults.require(largest < film_mm, "position_mm", largest, rule);
        }
        let rotation_rad = given("rotation_deg", &self.rotation_deg, ErrorUnit::Degree, at);
        let pose = FilmPose { position_mm, rotation_rad };
        remark_on_none("film", pose == FilmPose::default(), findings);
        pose
    }

    pub(crate) fn some(pose: &FilmPose) -> Option<FilmTable> {
        (*pose != FilmPose::default()).then(|| FilmTable {
            position_mm: Components::some(&pose.position_mm, ErrorUnit::Millimetre),
            rotation_deg: Components::some(&pose.rotation_rad, ErrorUnit::Degree),
        })
    }
}

impl StrayFieldTable {
    /// The field, after adding faults.
    pub(crate) fn resolve(&self, at: &mut ErrorTable, findings: &mut Vec<Finding>) -> StrayField {
        let field_t = given("field_ut", &self.field_ut, ErrorUnit::Microtesla, at);
        let any_direction = self.any_direction_ut.as_ref();
        let any_direction_t = any_direction
            .map_or(Distribution::NONE, |written| written.resolve("any_direction_ut", ErrorUnit::Microtesla, at));
        let is_none = field_t.iter().all(Distribution::is_none) && any_direction_t.is_none();
        remark_on_none("stray_field", is_none, findings);
        remark_on_tesla("stray_field.field_ut", &field_t, findings);
        remark_on_tesla("stray_field.any_direction_ut", std::slice::from_ref(&any_direction_t), findings);
        StrayField { field_t, any_direction_t, later: self.when == When::After }
    }
}

impl From<&StrayField> for StrayFieldTable {
    fn from(field: &StrayField) -> StrayFieldTable {
        StrayFieldTable {
            field_ut: Components::some(&field.field_t, ErrorUnit::Microtesla),
            any_direction_ut: WrittenDistribution::some(&field.any_direction_t, ErrorUnit::Microtesla),
            when: field.later.into(),
        }
    }
}

impl TemperatureTable {
    /// The change, after adding faults. `of_material` is the change of strength that the material
    /// states.
    pub(crate) fn resolve(
        &self,
        of_material: Option<f64>,
        at: &mut ErrorTable,
        findings: &mut Vec<Finding>,
    ) -> Temperature {
        if let Some(per_k) = self.strength_per_k {
            check_strength_per_k(per_k, &mut at.faults);
        }
        let stated = self.strength_per_k.or(of_material);
        if stated.is_none() {
            at.faults.add("has no strength_per_k, and [material] has none either: give one of them");
        }
        let change_k = self.change_k.resolve("change_k", ErrorUnit::Kelvin, at);
        let strength_per_k = stated.unwrap_or(0.0);
        remark_on_none("temperature", change_k.is_none() || strength_per_k == 0.0, findings);
        if strength_per_k > 0.0 {
            let message = format!(
                "tolerance.temperature: strength_per_k = {strength_per_k} is positive, and magnets become weaker as they \
                 get warmer"
            );
            findings.push(Finding::new(FindingSubject::Tolerance, message));
        }
        Temperature { change_k, strength_per_k }
    }
}

impl From<&Temperature> for TemperatureTable {
    fn from(change: &Temperature) -> TemperatureTable {
        let change_k = WrittenDistribution::of(&change.change_k, ErrorUnit::Kelvin);
        TemperatureTable { change_k, strength_per_k: Some(change.strength_per_k) }
    }
}

impl SensorTable {
    /// The errors of the sensor, after adding faults.
    pub(crate) fn resolve(&self, at: &mut ErrorTable, findings: &mut Vec<Finding>) -> SensorErrors {
        let errors = SensorErrors {
            offset_t: given("offset_ut", &self.offset_ut, ErrorUnit::Microtesla, at),
            rotation_rad: given("rotation_deg", &self.rotation_deg, ErrorUnit::Degree, at),
            gain: given("gain", &self.gain, ErrorUnit::Fraction, at),
            noise_t: given("noise_ut", &self.noise_ut, ErrorUnit::Microtesla, at),
        };
        remark_on_none("sensor", errors == SensorErrors::default(), findings);
        remark_on_tesla("sensor.offset_ut", &errors.offset_t, findings);
        remark_on_tesla("sensor.noise_ut", &errors.noise_t, findings);
        errors
    }

    pub(crate) fn some(errors: &SensorErrors) -> Option<SensorTable> {
        (*errors != SensorErrors::default()).then(|| SensorTable {
            offset_ut: Components::some(&errors.offset_t, ErrorUnit::Microtesla),
            rotation_deg: Components::some(&errors.rotation_rad, ErrorUnit::Degree),
            gain: Components::some(&errors.gain, ErrorUnit::Fraction),
            noise_ut: Components::some(&errors.noise_t, ErrorUnit::Microtesla),
        })
    }
}

/// The distributions of a key, or none if it is not given.
fn given(key: &str, written: &Option<Components<3>>, unit: ErrorUnit, at: &mut ErrorTable) -> [Distribution; 3] {
    written.as_ref().map_or_else(Default::default, |written| written.resolve(key, unit, at))
}

fn remark_on_none(table: &str, is_none: bool, findings: &mut Vec<Finding>) {
    if is_none {
        let message = format!("tolerance.{table}: all errors are 0, so that it has no effect");
        findings.push(Finding::new(FindingSubject::Tolerance, message));
    }
}

fn remark_on_tesla(key: &str, errors: &[Distribution], findings: &mut Vec<Finding>) {
    let largest = errors.iter().map(Distribution::largest).fold(0.0, f64::max);
    let largest_ut = ErrorUnit::Microtesla.written(largest);
    if largest > 0.0 && largest_ut < LEAST_FIELD_UT {
        let message = format!(
            "tolerance.{key} = {largest_ut} is below {LEAST_FIELD_UT} microtesla (microtesla, not T: {}?)",
            short(1e6 * largest_ut)
        );
        findings.push(Finding::new(FindingSubject::Tolerance, message));
    }
}

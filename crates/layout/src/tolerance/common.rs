//! Errors that all tiles share, and errors of the surroundings and of the sensor.

// Descriptions of the JSON Schema, which are no links, write tables in brackets.
#![allow(rustdoc::broken_intra_doc_links)]

use std::slice;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error_unit::ErrorUnit;
use crate::material::check_strength_per_k;
use crate::plausible::short;
use crate::tolerance::tabulated::ErrorTable;
use crate::tolerance::written::{Components, ErrorKey, WrittenDistribution};
use crate::tolerance::{FilmPose, SensorErrors, StrayField, Temperature};

/// Flux density in microtesla below which a number was probably meant in tesla: a thousandth of a
/// microtesla is far below the noise of any sensor.
const LEAST_FIELD_UT: f64 = 1e-3;

/// Pose of the film against the sensor. The film turns about the centre of its bounding box.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[serde(default)]
pub(crate) struct FilmTable {
    /// Errors of position along x, y, z, in mm: one for all axes, or three.
    position_mm: Components<3>,
    /// Angles about axes parallel to x, y, z, in degrees: one for all axes, or three.
    rotation_deg: Components<3>,
}

/// A uniform field: the sum of one with given components and one of any direction.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[serde(default)]
pub(crate) struct StrayFieldTable {
    /// Components along x, y, z, in microtesla: one for all axes, or three.
    field_ut: Components<3>,
    /// Magnitude of a field of any direction of space with equal probability, in microtesla.
    any_direction_ut: Components<1>,
    /// Whether the field is there when the sensor is read at the reference point. Default: before.
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

/// Errors of the sensor, or of each sensor of a head by itself, along or about its three axes: one
/// for all, or three.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[serde(default)]
pub(crate) struct SensorTable {
    /// Errors of its place along the axes of the film, in mm.
    position_mm: Components<3>,
    /// Offsets, in microtesla.
    offset_ut: Components<3>,
    /// Angles by which its axes are turned, in degrees.
    rotation_deg: Components<3>,
    /// Errors of the gain, as fractions: 0.01 is 1 %.
    gain: Components<3>,
    /// Noise, independent in every reading, in microtesla.
    noise_ut: Components<3>,
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
    fn keys<'k>(&'k mut self, pose: &'k mut FilmPose) -> [ErrorKey<'k>; 2] {
        [
            ErrorKey::new("position_mm", ErrorUnit::Millimetre, &mut self.position_mm, &mut pose.position_mm),
            ErrorKey::new("rotation_deg", ErrorUnit::Degree, &mut self.rotation_deg, &mut pose.rotation_rad),
        ]
    }

    /// The pose of the film, after adding faults. `film_mm` is its longest side.
    pub(crate) fn resolve(mut self, film_mm: Option<f64>, at: &mut ErrorTable) -> FilmPose {
        let mut pose = FilmPose::default();
        read(self.keys(&mut pose), at);
        let largest = pose.position_mm.iter().map(|error| error.largest()).fold(0.0, f64::max);
        if let Some(film_mm) = film_mm {
            let rule = format_args!(
                "must be less than the longest side of the film, {} mm (mm, not um: {}?)",
                short(film_mm),
                short(1e-3 * largest)
            );
            at.faults.require(largest < film_mm, "position_mm", largest, rule);
        }
        pose
    }
}

impl From<&FilmPose> for FilmTable {
    fn from(pose: &FilmPose) -> FilmTable {
        let mut table = FilmTable::default();
        write(table.keys(&mut pose.clone()));
        table
    }
}

impl StrayFieldTable {
    fn keys<'k>(&'k mut self, field: &'k mut StrayField) -> [ErrorKey<'k>; 2] {
        let (ut, any_direction) = (ErrorUnit::Microtesla, slice::from_mut(&mut field.any_direction_t));
        [
            ErrorKey::new("field_ut", ut, &mut self.field_ut, &mut field.field_t),
            ErrorKey::new("any_direction_ut", ut, &mut self.any_direction_ut, any_direction),
        ]
    }

    /// The field, after adding faults.
    pub(crate) fn resolve(mut self, at: &mut ErrorTable) -> StrayField {
        let mut field = StrayField { later: self.when == When::After, ..StrayField::default() };
        read(self.keys(&mut field), at);
        field
    }
}

impl From<&StrayField> for StrayFieldTable {
    fn from(field: &StrayField) -> StrayFieldTable {
        let mut table = StrayFieldTable { when: field.later.into(), ..StrayFieldTable::default() };
        write(table.keys(&mut field.clone()));
        table
    }
}

impl TemperatureTable {
    /// The change, after adding faults. `of_material` is the change of strength that the material
    /// states.
    pub(crate) fn resolve(&self, of_material: Option<f64>, at: &mut ErrorTable) -> Temperature {
        check_strength_per_k(self.strength_per_k, &mut at.faults);
        let stated = self.strength_per_k.or(of_material);
        if stated.is_none() {
            at.faults.add("has no strength_per_k, and [material] has none either: give one of them");
        }
        let change_k = self.change_k.resolve("change_k", ErrorUnit::Kelvin, at);
        let strength_per_k = stated.unwrap_or(0.0);
        remark_on_none(change_k.is_none() || strength_per_k == 0.0, at);
        if strength_per_k > 0.0 {
            at.remark(format!(
                ": strength_per_k = {strength_per_k} is positive, and magnets become weaker as they get warmer"
            ));
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
    fn keys<'k>(&'k mut self, errors: &'k mut SensorErrors) -> [ErrorKey<'k>; 5] {
        [
            ErrorKey::new("position_mm", ErrorUnit::Millimetre, &mut self.position_mm, &mut errors.position_mm),
            ErrorKey::new("offset_ut", ErrorUnit::Microtesla, &mut self.offset_ut, &mut errors.offset_t),
            ErrorKey::new("rotation_deg", ErrorUnit::Degree, &mut self.rotation_deg, &mut errors.rotation_rad),
            ErrorKey::new("gain", ErrorUnit::Fraction, &mut self.gain, &mut errors.gain),
            ErrorKey::new("noise_ut", ErrorUnit::Microtesla, &mut self.noise_ut, &mut errors.noise_t),
        ]
    }

    /// The errors of the sensor, after adding faults.
    pub(crate) fn resolve(mut self, at: &mut ErrorTable) -> SensorErrors {
        let mut errors = SensorErrors::default();
        read(self.keys(&mut errors), at);
        errors
    }
}

impl From<&SensorErrors> for SensorTable {
    fn from(errors: &SensorErrors) -> SensorTable {
        let mut table = SensorTable::default();
        write(table.keys(&mut errors.clone()));
        table
    }
}

/// Reads all keys of a table. Fields that were probably meant in tesla and a table without errors
/// are findings.
fn read<const N: usize>(keys: [ErrorKey; N], at: &mut ErrorTable) {
    let mut is_none = true;
    for mut key in keys {
        key.read(at);
        is_none &= !key.has_errors();
        let largest = key.errors.iter().map(|error| error.largest()).fold(0.0, f64::max);
        let largest_ut = ErrorUnit::Microtesla.written(largest);
        if key.unit == ErrorUnit::Microtesla && largest > 0.0 && largest_ut < LEAST_FIELD_UT {
            let meant = short(1e6 * largest_ut);
            at.remark(format!(
                ".{} = {largest_ut} is below {LEAST_FIELD_UT} microtesla (microtesla, not T: {meant}?)",
                key.name
            ));
        }
    }
    remark_on_none(is_none, at);
}

/// Writes the keys that have errors.
fn write<const N: usize>(keys: [ErrorKey; N]) {
    keys.into_iter().filter(ErrorKey::has_errors).for_each(ErrorKey::write);
}

fn remark_on_none(is_none: bool, at: &mut ErrorTable) {
    if is_none {
        at.remark(": all errors are 0, so that it has no effect");
    }
}

//! Errors that all tiles share, and those of the surroundings and of the sensor.

use crate::distribution::Distribution;
use crate::error_unit::{ErrorUnit, largest_magnitude};
use crate::finding::{Finding, FindingSubject};
use crate::plausible::short;
use crate::read::faults::{Faults, TableFaults};
use crate::read::material::check_strength_per_k;
use crate::read::tolerance::distribution::{components, distribution};
use crate::read::tolerance::tabulated::Tabulated;
use crate::tables::distribution::Components;
use crate::tables::tolerance::{FilmTable, SensorTable, StrayFieldTable, TemperatureTable, ToleranceTable, When};
use crate::tolerance::{CommonErrors, FilmPose, SensorErrors, StrayField, Temperature};

/// Flux density in microtesla below which a number was probably meant in tesla: a thousandth of a
/// microtesla is far below the noise of any sensor.
const LEAST_FIELD_UT: f64 = 1e-3;

/// The errors of all tables but the neighbour. Faults are added. `film_mm` is the longest side of
/// the film, `strength_per_k` that of the material.
pub(crate) fn resolve(
    table: &ToleranceTable,
    film_mm: Option<f64>,
    strength_per_k: Option<f64>,
    tabulated: &mut Tabulated,
    faults: &mut Faults,
    findings: &mut Vec<Finding>,
) -> CommonErrors {
    let mut common = CommonErrors::default();
    if let Some(film) = &table.film {
        let mut at = faults.at(&film.span(), "tolerance.film");
        common.film = film_pose(film.get_ref(), film_mm, tabulated, &mut at);
        remark_on_none("film", common.film == FilmPose::default(), findings);
    }
    if let Some(field) = &table.stray_field {
        let mut at = faults.at(&field.span(), "tolerance.stray_field");
        let found = stray_field(field.get_ref(), tabulated, &mut at);
        remark_on_none("stray_field", StrayField { later: false, ..found.clone() } == StrayField::default(), findings);
        remark_on_tesla("stray_field.field_ut", &found.field_t, findings);
        remark_on_tesla("stray_field.any_direction_ut", std::slice::from_ref(&found.any_direction_t), findings);
        common.stray_field = Some(found);
    }
    if let Some(change) = &table.temperature {
        let mut at = faults.at(&change.span(), "tolerance.temperature");
        let found = temperature(change.get_ref(), strength_per_k, tabulated, &mut at);
        remark_on_none("temperature", found.change_k.is_none() || found.strength_per_k == 0.0, findings);
        if found.strength_per_k > 0.0 {
            findings.push(Finding::new(
                FindingSubject::Tolerance,
                format!(
                    "tolerance.temperature: strength_per_k = {} is positive, and magnets become weaker as they get warmer",
                    found.strength_per_k
                ),
            ));
        }
        common.temperature = Some(found);
    }
    if let Some(sensor) = &table.sensor {
        let mut at = faults.at(&sensor.span(), "tolerance.sensor");
        common.sensor = sensor_errors(sensor.get_ref(), tabulated, &mut at);
        remark_on_none("sensor", common.sensor == SensorErrors::default(), findings);
        remark_on_tesla("sensor.offset_ut", &common.sensor.offset_t, findings);
        remark_on_tesla("sensor.noise_ut", &common.sensor.noise_t, findings);
    }
    common
}

fn remark_on_none(table: &str, is_none: bool, findings: &mut Vec<Finding>) {
    if is_none {
        let message = format!("tolerance.{table}: all errors are 0, so that it has no effect");
        findings.push(Finding::new(FindingSubject::Tolerance, message));
    }
}

fn remark_on_tesla(key: &str, errors: &[Distribution], findings: &mut Vec<Finding>) {
    let largest = errors.iter().map(largest_magnitude).fold(0.0, f64::max);
    let largest_ut = ErrorUnit::Microtesla.written(largest);
    if largest > 0.0 && largest_ut < LEAST_FIELD_UT {
        let message = format!(
            "tolerance.{key} = {largest_ut} is below {LEAST_FIELD_UT} microtesla (microtesla, not T: {}?)",
            short(1e6 * largest_ut)
        );
        findings.push(Finding::new(FindingSubject::Tolerance, message));
    }
}

/// The distributions of a key, or none if it is not given.
fn given(
    key: &str,
    written: Option<&Components<3>>,
    unit: ErrorUnit,
    tabulated: &mut Tabulated,
    faults: &mut TableFaults,
) -> [Distribution; 3] {
    written.map_or_else(Default::default, |written| components(key, written, unit, tabulated, faults))
}

fn film_pose(table: &FilmTable, film_mm: Option<f64>, tabulated: &mut Tabulated, faults: &mut TableFaults) -> FilmPose {
    let position_mm = given("position_mm", table.position_mm.as_ref(), ErrorUnit::Millimetre, tabulated, faults);
    let largest = position_mm.iter().map(largest_magnitude).fold(0.0, f64::max);
    if let Some(film_mm) = film_mm.filter(|film_mm| largest >= *film_mm) {
        faults.add(format!(
            "position_mm = {largest}, must be less than the longest side of the film, {} mm (mm, not um: {}?)",
            short(film_mm),
            short(1e-3 * largest)
        ));
    }
    let rotation_rad = given("rotation_deg", table.rotation_deg.as_ref(), ErrorUnit::Degree, tabulated, faults);
    FilmPose { position_mm, rotation_rad }
}

fn stray_field(table: &StrayFieldTable, tabulated: &mut Tabulated, faults: &mut TableFaults) -> StrayField {
    let any_direction = table.any_direction_ut.as_ref();
    StrayField {
        field_t: given("field_ut", table.field_ut.as_ref(), ErrorUnit::Microtesla, tabulated, faults),
        any_direction_t: any_direction.map_or(Distribution::NONE, |written| {
            distribution("any_direction_ut", written, ErrorUnit::Microtesla, tabulated, faults)
        }),
        later: table.when == When::After,
    }
}

fn temperature(
    table: &TemperatureTable,
    strength_per_k: Option<f64>,
    tabulated: &mut Tabulated,
    faults: &mut TableFaults,
) -> Temperature {
    if let Some(per_k) = table.strength_per_k {
        check_strength_per_k(per_k, faults);
    }
    let stated = table.strength_per_k.or(strength_per_k);
    if stated.is_none() {
        faults.add("has no strength_per_k, and [material] has none either: give one of them");
    }
    let change_k = distribution("change_k", &table.change_k, ErrorUnit::Kelvin, tabulated, faults);
    Temperature { change_k, strength_per_k: stated.unwrap_or(0.0) }
}

fn sensor_errors(table: &SensorTable, tabulated: &mut Tabulated, faults: &mut TableFaults) -> SensorErrors {
    SensorErrors {
        offset_t: given("offset_ut", table.offset_ut.as_ref(), ErrorUnit::Microtesla, tabulated, faults),
        rotation_rad: given("rotation_deg", table.rotation_deg.as_ref(), ErrorUnit::Degree, tabulated, faults),
        gain: given("gain", table.gain.as_ref(), ErrorUnit::Fraction, tabulated, faults),
        noise_t: given("noise_ut", table.noise_ut.as_ref(), ErrorUnit::Microtesla, tabulated, faults),
    }
}

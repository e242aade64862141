//! Rules of `[sensor]` and `[elastomer]`.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};
use magsplice_magnet::{HallSensor, MAX_LENGTH};
use serde::Deserialize;

use crate::error_unit::ErrorUnit;
use crate::read::faults::TableFaults;
use crate::read::names::shown;
use crate::read::number_rules::{check_finite, check_not_negative, check_positive};
use crate::read::rotation;
use crate::sensor::{Elastomer, StatedSensor};
use crate::tables::sensor::{ElastomerTable, PerAxis, PlatesTable, SensorTable};

/// The numbers of the parts.
const PARTS: &str = include_str!("../sensor_parts.toml");

/// Smallest Poisson ratio of a stable material.
const LEAST_POISSON_RATIO: f64 = -1.0;

/// Largest one: that of a layer that keeps its volume.
const MOST_POISSON_RATIO: f64 = 0.5;

/// A part with the source of its numbers.
#[derive(Deserialize)]
struct PartTable {
    #[expect(dead_code, reason = "the source is for people who read the file")]
    source: String,
    #[expect(dead_code, reason = "the setting is for people who read the file")]
    setting: String,
    noise_ut: PerAxis,
    count_ut: PerAxis,
    range_mt: PerAxis,
    rate_hz: f64,
}

/// The sensor, or `None` after adding its faults.
pub(crate) fn resolve(table: &SensorTable, faults: &mut TableFaults) -> Option<StatedSensor> {
    let before = faults.count();
    let part = table.part.as_deref().and_then(|name| part(name, faults));
    let of_part = |own: Option<PerAxis>, of: fn(&PartTable) -> PerAxis| own.or_else(|| part.as_ref().map(of));
    let perfect = HallSensor::default();
    let noise = of_part(table.noise_ut, |part| part.noise_ut);
    let count = of_part(table.count_ut, |part| part.count_ut);
    let range = of_part(table.range_mt, |part| part.range_mt);
    let mut numbers = |key: &str, value: Option<PerAxis>, unit: ErrorUnit, check: Check, default: DVec3| {
        value.map_or(default, |value| {
            check_axes(key, value, check, faults);
            DVec3::from(value.values().map(|value| unit.read(value)))
        })
    };
    let element = HallSensor {
        noise_t: numbers("noise_ut", noise, ErrorUnit::Microtesla, check_not_negative, perfect.noise_t),
        count_t: numbers("count_ut", count, ErrorUnit::Microtesla, check_not_negative, perfect.count_t),
        range_t: numbers("range_mt", range, ErrorUnit::Millitesla, check_positive, perfect.range_t),
        gain: numbers("gain", table.gain, ErrorUnit::Fraction, check_gain, perfect.gain),
        offset_t: numbers("offset_ut", table.offset_ut, ErrorUnit::Microtesla, check_finite, perfect.offset_t),
        active_area: table.active_area_mm.unwrap_or(perfect.active_area),
        plates: plates(table.plates_mm.unwrap_or_default(), faults),
        rotation: DQuat::IDENTITY,
    };
    for (axis, side) in element.active_area.into_iter().enumerate() {
        check_not_negative(&format!("active_area_mm[{axis}]"), side, faults);
    }
    let rate_hz = table.rate_hz.or(part.map(|part| part.rate_hz));
    if let Some(rate_hz) = rate_hz {
        check_positive("rate_hz", rate_hz, faults);
    }
    let rotation = table.rotation.as_ref().and_then(|table| rotation::resolve(table, faults));
    if faults.count() > before {
        return None;
    }
    let turn = rotation.map_or(DQuat::IDENTITY, |rotation| rotation.quaternion());
    let element = HallSensor { rotation: turn, ..element };
    match element.checked() {
        Ok(element) => Some(StatedSensor { part: table.part.clone(), rate_hz, rotation, element }),
        Err(fault) => {
            faults.add(fault.to_string());
            None
        }
    }
}

type Check = fn(&str, f64, &mut TableFaults);

fn check_axes(key: &str, value: PerAxis, check: Check, faults: &mut TableFaults) {
    match value {
        PerAxis::Same(value) => check(key, value, faults),
        PerAxis::Each(values) => {
            for (axis, value) in values.into_iter().enumerate() {
                check(&format!("{key}[{axis}]"), value, faults);
            }
        }
    }
}

fn check_gain(key: &str, value: f64, faults: &mut TableFaults) {
    if !(value.is_finite() && value != 0.0) {
        faults.add(format!("{key} = {value}, must be a finite number other than 0"));
    }
}

/// The numbers of a part by its name, or `None` after adding a fault.
fn part(name: &str, faults: &mut TableFaults) -> Option<PartTable> {
    let mut parts: BTreeMap<String, PartTable> = toml::from_str(PARTS).expect("the list of parts is TOML");
    if let Some(part) = parts.remove(name) {
        return Some(part);
    }
    let known: Vec<String> = parts.into_keys().collect();
    faults.add(format!("part = \"{}\", must be one of: {}; or leave it out", shown(name), known.join(", ")));
    None
}

fn plates(table: PlatesTable, faults: &mut TableFaults) -> [DVec3; 3] {
    [("x", table.x), ("y", table.y), ("z", table.z)].map(|(axis, place)| {
        let place = place.unwrap_or_default();
        if !place.iter().all(|c| c.abs() <= MAX_LENGTH) {
            faults.add(format!("plates_mm.{axis} = {place:?}, must be three finite numbers"));
        }
        place.into()
    })
}

/// The elastic layer, or `None` after adding its faults.
pub(crate) fn resolve_elastomer(table: &ElastomerTable, faults: &mut TableFaults) -> Option<Elastomer> {
    let before = faults.count();
    let ElastomerTable { area_mm2, thickness_mm, youngs_modulus_mpa, poisson_ratio, scale, force_at_rest_n } = *table;
    check_positive("area_mm2", area_mm2, faults);
    check_positive("thickness_mm", thickness_mm, faults);
    check_positive("youngs_modulus_mpa", youngs_modulus_mpa, faults);
    if !(poisson_ratio > LEAST_POISSON_RATIO && poisson_ratio <= MOST_POISSON_RATIO) {
        faults.add(format!(
            "poisson_ratio = {poisson_ratio}, must be above {LEAST_POISSON_RATIO} and at most {MOST_POISSON_RATIO}"
        ));
    }
    if let Some(scale) = scale {
        check_axes("scale", scale, check_positive, faults);
    }
    if let Some(force) = force_at_rest_n {
        check_axes("force_at_rest_n", force, check_finite, faults);
    }
    let vector = |value: Option<PerAxis>, default| DVec3::from(value.map_or([default; 3], PerAxis::values));
    let elastomer = Elastomer {
        area_mm2,
        thickness_mm,
        youngs_modulus_mpa,
        poisson_ratio,
        scale: vector(scale, 1.0),
        force_at_rest_n: vector(force_at_rest_n, 0.0),
    };
    let stiffness = elastomer.stiffness_n_per_mm();
    if faults.count() == before && !(stiffness.is_finite() && stiffness.cmpgt(DVec3::ZERO).all()) {
        faults.add(format!("the stiffness is {stiffness} N/mm, must be a finite number greater than 0"));
    }
    (faults.count() == before).then_some(elastomer)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_obeys_the_rules() {
        let parts: BTreeMap<String, PartTable> = toml::from_str(PARTS).unwrap();
        assert_eq!(parts.len(), 4);
        for part in parts.values() {
            let all = [part.noise_ut, part.count_ut, part.range_mt].map(PerAxis::values);
            assert!(all.as_flattened().iter().all(|value| *value > 0.0) && part.rate_hz > 0.0);
            // A count is finer than the range by more than ten bits.
            assert!((0..3).all(|axis| all[1][axis] < all[2][axis]));
        }
    }
}

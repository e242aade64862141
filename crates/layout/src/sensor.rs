//! `[sensor]`: the three-axis Hall sensor below the film.

use glam::{DQuat, DVec3};
use magsplice_magnet::{Axis, HallSensor};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml::Table;

use crate::error_unit::ErrorUnit;
use crate::faults::{FINITE, NOT_NEGATIVE, POSITIVE, Rule, TableFaults};
use crate::names::shown;
use crate::one_or_three::OneOrThree;
use crate::rotation::{Rotation, RotationTable};

/// The numbers of the parts.
const PARTS: &str = include_str!("sensor_parts.toml");

/// The sensor that a layout states.
#[derive(Clone, Debug, PartialEq)]
pub struct StatedSensor {
    /// The part whose numbers it has where the layout gives no others.
    pub part: Option<String>,
    /// Readings per second.
    pub rate_hz: Option<f64>,
    /// The rotation as written, from which the one of `element` was computed.
    pub rotation: Option<Rotation>,
    /// What it reads. Lengths in millimetres.
    pub element: HallSensor,
}

/// The three-axis Hall sensor below the film. Without this table it is perfect: points without
/// errors, noise or limits.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[schemars(rename = "Sensor")]
pub(crate) struct SensorTable {
    /// A part with known numbers: MLX90393, TLV493D, LIS3MDL or MMC5983MA. The keys beside it
    /// replace its numbers.
    part: Option<String>,
    /// Standard deviation of the noise of a reading, in microtesla: one for all axes, or three.
    /// Default: 0.
    noise_ut: Option<OneOrThree>,
    /// Flux density of one count, in microtesla: one for all axes, or three. Default: 0, readings
    /// are not rounded.
    count_ut: Option<OneOrThree>,
    /// Largest flux density that is read, in millitesla: one for all axes, or three. Default: no
    /// limit.
    range_mt: Option<OneOrThree>,
    /// Readings per second. Default: not stated.
    rate_hz: Option<f64>,
    /// Reading over flux density: one for all axes, or three. Default: 1.
    gain: Option<OneOrThree>,
    /// Reading without a field, in microtesla: one for all axes, or three. Default: 0.
    offset_ut: Option<OneOrThree>,
    /// Rotation of the sensor in the frame of the film. Default: none.
    rotation: Option<RotationTable>,
    /// Sides of the rectangle along x and y of the sensor that a plate averages over, in mm.
    /// Default: points.
    #[schemars(extend("example" = "[0.1, 0.1]"))]
    active_area_mm: Option<[f64; 2]>,
    /// Centres of the plates in the frame of the sensor. Default: all at its position.
    #[schemars(extend("example" = "{ z = [0.0, 0.0, -0.1] }"))]
    plates_mm: Option<PlatesTable>,
}

/// Centres of the plates that read x, y and z, in the frame of the sensor, in mm. Default: its
/// position.
#[derive(Clone, Copy, Default, Deserialize, JsonSchema, Serialize)]
pub(crate) struct PlatesTable {
    /// Centre of the plate that reads B_x.
    x: Option<[f64; 3]>,
    /// Centre of the plate that reads B_y.
    y: Option<[f64; 3]>,
    /// Centre of the plate that reads B_z.
    z: Option<[f64; 3]>,
}

/// A key with a number for each axis: its name, unit and rule, as it is written, and in memory.
type AxisKey<'k> = (&'static str, ErrorUnit, Rule, &'k mut Option<OneOrThree>, &'k mut DVec3);

/// Number of the first keys for which parts have numbers of their own.
const OF_PARTS: usize = 3;

const NOT_ZERO: Rule =
    Rule { is_kept: |gain| gain.is_finite() && gain != 0.0, words: "must be a finite number other than 0" };

impl SensorTable {
    fn keys<'k>(&'k mut self, element: &'k mut HallSensor) -> [AxisKey<'k>; 5] {
        let (ut, mt) = (ErrorUnit::Microtesla, ErrorUnit::Millitesla);
        [
            ("noise_ut", ut, NOT_NEGATIVE, &mut self.noise_ut, &mut element.noise_t),
            ("count_ut", ut, NOT_NEGATIVE, &mut self.count_ut, &mut element.count_t),
            ("range_mt", mt, POSITIVE, &mut self.range_mt, &mut element.range_t),
            ("gain", ErrorUnit::Fraction, NOT_ZERO, &mut self.gain, &mut element.gain),
            ("offset_ut", ut, FINITE, &mut self.offset_ut, &mut element.offset_t),
        ]
    }

    /// The sensor, or `None` after adding its faults.
    pub(crate) fn resolve(mut self, faults: &mut TableFaults) -> Option<StatedSensor> {
        let before = faults.count();
        let part = self.part.as_deref().map_or_else(SensorTable::default, |name| part(name, faults));
        self.noise_ut = self.noise_ut.or(part.noise_ut);
        self.count_ut = self.count_ut.or(part.count_ut);
        self.range_mt = self.range_mt.or(part.range_mt);
        let mut element = HallSensor::default();
        for (name, unit, rule, written, value) in self.keys(&mut element) {
            let Some(written) = *written else { continue };
            written.check(name, rule, faults);
            *value = DVec3::from(written).map(|value| unit.read(value));
        }
        let PlatesTable { x, y, z } = self.plates_mm.unwrap_or_default();
        let plates = [x, y, z].map(Option::unwrap_or_default);
        for (axis, place) in Axis::ALL.into_iter().zip(plates) {
            faults.point(format_args!("plates_mm.{axis}"), place);
        }
        element.plates = plates.map(DVec3::from);
        element.active_area = self.active_area_mm.unwrap_or(element.active_area);
        faults.numbers("active_area_mm", &element.active_area, NOT_NEGATIVE);
        let rate_hz = self.rate_hz.or(part.rate_hz);
        faults.number("rate_hz", rate_hz, POSITIVE);
        let rotation = self.rotation.and_then(|table| table.resolve(faults));
        if faults.count() > before {
            return None;
        }
        element.rotation = rotation.map_or(DQuat::IDENTITY, |rotation| rotation.quaternion());
        let element = element.checked().map_err(|fault| faults.add(fault.to_string())).ok()?;
        Some(StatedSensor { part: self.part, rate_hz, rotation, element })
    }
}

/// The table of a sensor, with all numbers written out that a perfect one does not have.
impl From<&StatedSensor> for SensorTable {
    fn from(StatedSensor { part, rate_hz, rotation, element }: &StatedSensor) -> SensorTable {
        let mut perfect = HallSensor::default();
        let [x, y, z] = element.plates.map(|place| (place != DVec3::ZERO).then(|| place.to_array()));
        let mut table = SensorTable {
            part: part.clone(),
            rate_hz: *rate_hz,
            rotation: rotation.map(Into::into),
            active_area_mm: (element.active_area != perfect.active_area).then_some(element.active_area),
            plates_mm: x.or(y).or(z).map(|_| PlatesTable { x, y, z }),
            ..SensorTable::default()
        };
        let defaults = SensorTable::default().keys(&mut perfect).map(|(.., value)| *value);
        for (index, (_, unit, _, written, value)) in table.keys(&mut element.clone()).into_iter().enumerate() {
            // A part has numbers of its own, so a perfect value beside it must be written too.
            let is_given = *value != defaults[index] || (index < OF_PARTS && part.is_some());
            *written = (is_given && value.is_finite()).then(|| value.map(|value| unit.written(value)).into());
        }
        table
    }
}

/// The numbers of a part by its name, or none after adding a fault.
fn part(name: &str, faults: &mut TableFaults) -> SensorTable {
    let mut parts: Table = PARTS.parse().expect("the list of parts is TOML");
    if let Some(part) = parts.remove(name) {
        return part.try_into().expect("a part is a table of a sensor");
    }
    let known: Vec<&str> = parts.keys().map(String::as_str).collect();
    faults.add(format!("part = \"{}\", must be one of: {}; or leave it out", shown(name), known.join(", ")));
    SensorTable::default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_obeys_the_rules() {
        let parts: Table = PARTS.parse().unwrap();
        assert_eq!(parts.len(), 4);
        for (_, part) in parts {
            let part: SensorTable = part.try_into().unwrap();
            let all = [part.noise_ut, part.count_ut, part.range_mt].map(|numbers| DVec3::from(numbers.unwrap()));
            assert!(all.iter().all(|values| values.cmpgt(DVec3::ZERO).all()) && part.rate_hz > Some(0.0));
            // A count is finer than the range by more than ten bits.
            assert!(all[1].cmplt(all[2]).all());
        }
    }
}

//! The keys of one Hall sensor: of `[sensor]`, and of the sensors of a head.

use glam::{DQuat, DVec3};
use magsplice_magnet::{Axis, GAIN_MAGNITUDES, HallSensor, MAX_SENSOR_ERROR_T};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error_unit::ErrorUnit;
use crate::faults::{NOT_NEGATIVE, POSITIVE, Rule, TableFaults};
use crate::names::shown;
use crate::one_or_three::OneOrThree;
use crate::rotation::{Rotation, RotationTable};
use crate::sensor_part::{GAINS, Part, PartSetting, RESOLUTIONS};

/// The numbers of a three-axis Hall sensor. Without them it is perfect: points without errors,
/// noise or limits.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
pub(crate) struct HallKeys {
    /// A part with known numbers: MLX90393, TLV493D, LIS3MDL or MMC5983MA. The keys beside it
    /// replace its numbers.
    part: Option<String>,
    /// Register GAIN_SEL of an MLX90393, from 0 to 7. Default: 7, the highest gain.
    gain_sel: Option<u8>,
    /// Register RES of an MLX90393, from 0 to 3: one for all axes, or three. Default: 0.
    res: Option<OneOrThree>,
    /// Full scale of a LIS3MDL in gauss: 4, 8, 12 or 16. Default: 16.
    full_scale_gauss: Option<u8>,
    /// Standard deviation of the noise of a reading, in microtesla: one for all axes, or three.
    /// Default: 0.
    noise_ut: Option<OneOrThree>,
    /// Flux density of one count, in microtesla: one for all axes, or three. Default: 0, readings
    /// are not rounded.
    count_ut: Option<OneOrThree>,
    /// Largest flux density that is read, in millitesla: one for all axes, or three. Default: no
    /// limit.
    range_mt: Option<OneOrThree>,
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
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
pub(crate) struct PlatesTable {
    /// Centre of the plate that reads B_x.
    x: Option<[f64; 3]>,
    /// Centre of the plate that reads B_y.
    y: Option<[f64; 3]>,
    /// Centre of the plate that reads B_z.
    z: Option<[f64; 3]>,
}

/// A Hall sensor as its keys state it.
pub(crate) struct StatedHall {
    pub(crate) part: Option<String>,
    pub(crate) setting: Option<PartSetting>,
    /// Readings per second of the part.
    pub(crate) rate_hz: Option<f64>,
    pub(crate) rotation: Option<Rotation>,
    pub(crate) element: HallSensor,
}

/// A key with a number for each axis: its name, unit and rule, as it is written, and in memory.
type AxisKey<'k> = (&'static str, ErrorUnit, Rule, &'k mut Option<OneOrThree>, &'k mut DVec3);

const GAIN: Rule = Rule {
    is_kept: |gain| GAIN_MAGNITUDES.contains(&gain.abs()),
    words: "must be from 1e-6 to 1e6, or from -1e6 to -1e-6",
};

/// [`MAX_SENSOR_ERROR_T`], as it is written.
const MAX_ERROR_UT: f64 = 1e6 * MAX_SENSOR_ERROR_T;

const ERROR: Rule =
    Rule { is_kept: |error| (0.0..=MAX_ERROR_UT).contains(&error), words: "must be from 0 to 1e6 (1 T)" };

const OFFSET: Rule =
    Rule { is_kept: |offset| offset.abs() <= MAX_ERROR_UT, words: "must be at most 1e6 (1 T) in magnitude" };

impl HallKeys {
    fn keys<'k>(&'k mut self, element: &'k mut HallSensor) -> [AxisKey<'k>; 5] {
        let (ut, mt) = (ErrorUnit::Microtesla, ErrorUnit::Millitesla);
        [
            ("noise_ut", ut, ERROR, &mut self.noise_ut, &mut element.noise_t),
            ("count_ut", ut, ERROR, &mut self.count_ut, &mut element.count_t),
            ("range_mt", mt, POSITIVE, &mut self.range_mt, &mut element.range_t),
            ("gain", ErrorUnit::Fraction, GAIN, &mut self.gain, &mut element.gain),
            ("offset_ut", ut, OFFSET, &mut self.offset_ut, &mut element.offset_t),
        ]
    }

    /// The numbers of a part.
    pub(crate) fn of_part(name: &str) -> HallKeys {
        HallKeys { part: Some(name.to_owned()), ..HallKeys::default() }
    }

    /// These keys, with those of `common` where they are not given. A part of its own has no number
    /// and setting of another part.
    pub(crate) fn or(self, common: &HallKeys) -> HallKeys {
        let common = common.clone();
        let of_part = if self.part.is_some() { HallKeys::default() } else { common.clone() };
        HallKeys {
            part: self.part.or(of_part.part),
            gain_sel: self.gain_sel.or(of_part.gain_sel),
            res: self.res.or(of_part.res),
            full_scale_gauss: self.full_scale_gauss.or(of_part.full_scale_gauss),
            noise_ut: self.noise_ut.or(of_part.noise_ut),
            count_ut: self.count_ut.or(of_part.count_ut),
            range_mt: self.range_mt.or(of_part.range_mt),
            gain: self.gain.or(common.gain),
            offset_ut: self.offset_ut.or(common.offset_ut),
            rotation: self.rotation.or(common.rotation),
            active_area_mm: self.active_area_mm.or(common.active_area_mm),
            plates_mm: self.plates_mm.or(common.plates_mm),
        }
    }

    /// What the keys state, or `None` after adding their faults.
    pub(crate) fn resolve(mut self, faults: &mut TableFaults) -> Option<StatedHall> {
        let before = faults.count();
        let part = self.part.as_deref().map(|name| part(name, faults)).unwrap_or_default();
        let setting = self.setting(&part, faults);
        self.noise_ut = self.noise_ut.or(part.noise_ut);
        let mut element = HallSensor::default();
        if let Some(scale) = part.scale(setting.or(part.default_setting())) {
            (element.count_t, element.range_t) = (scale.count_t, scale.range_t);
        }
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
        let rotation = self.rotation.and_then(|table| table.resolve(faults));
        if faults.count() > before {
            return None;
        }
        element.rotation = rotation.map_or(DQuat::IDENTITY, |rotation| rotation.quaternion());
        let element = element.checked().map_err(|fault| faults.add(fault.to_string())).ok()?;
        Some(StatedHall { part: self.part, setting, rate_hz: part.rate_hz, rotation, element })
    }

    /// The setting of the part as written. `None` without one, or after adding a fault.
    fn setting(&self, part: &Part, faults: &mut TableFaults) -> Option<PartSetting> {
        let default = part.default_setting();
        let is_gain = matches!(default, Some(PartSetting::Gain { .. }));
        let is_scale = matches!(default, Some(PartSetting::FullScale { .. }));
        let value = |value: Option<u8>| value.map(|value| value.to_string());
        for (key, value, is_of_part, owner) in [
            ("gain_sel", value(self.gain_sel), is_gain, "MLX90393"),
            ("res", self.res.map(|res| res.to_string()), is_gain, "MLX90393"),
            ("full_scale_gauss", value(self.full_scale_gauss), is_scale, "LIS3MDL"),
        ] {
            if let Some(value) = value.filter(|_| !is_of_part) {
                faults.add(format!("{key} = {value}, is a setting of part = \"{owner}\" only"));
            }
        }
        match default? {
            PartSetting::Gain { gain_sel, res } if self.gain_sel.is_some() || self.res.is_some() => {
                let gain_sel = self.gain_sel.unwrap_or(gain_sel);
                let is_kept = usize::from(gain_sel) < GAINS;
                faults.require(is_kept, "gain_sel", gain_sel, "must be a whole number from 0 to 7");
                let before = faults.count();
                self.res.inspect(|res| res.check("res", RESOLUTION, faults));
                let is_kept = is_kept && faults.count() == before;
                // A number that keeps its rule is whole and small.
                let res = self.res.map_or(res, |res| DVec3::from(res).to_array().map(|res| res as u8));
                is_kept.then_some(PartSetting::Gain { gain_sel, res })
            }
            PartSetting::FullScale { .. } => {
                let setting = PartSetting::FullScale { gauss: self.full_scale_gauss? };
                let is_kept = part.scale(Some(setting)).is_some();
                let gauss = self.full_scale_gauss.unwrap_or_default();
                faults.require(is_kept, "full_scale_gauss", gauss, "must be 4, 8, 12 or 16");
                is_kept.then_some(setting)
            }
            PartSetting::Gain { .. } => None,
        }
    }
}

const RESOLUTION: Rule = Rule {
    is_kept: |res| (0..RESOLUTIONS).any(|known| known as f64 == res),
    words: "must be a whole number from 0 to 3",
};

/// The keys of a sensor, with all numbers that its part, or a perfect one, does not have.
impl From<&StatedHall> for HallKeys {
    fn from(StatedHall { part, setting, rotation, element, .. }: &StatedHall) -> HallKeys {
        let mut perfect = HallSensor::default();
        let (gain_sel, res, full_scale_gauss) = match *setting {
            Some(PartSetting::Gain { gain_sel, res }) => {
                (Some(gain_sel), Some(DVec3::from(res.map(f64::from)).into()), None)
            }
            Some(PartSetting::FullScale { gauss }) => (None, None, Some(gauss)),
            None => (None, None, None),
        };
        let [x, y, z] = element.plates.map(|place| (place != DVec3::ZERO).then(|| place.to_array()));
        let mut table = HallKeys {
            part: part.clone(),
            gain_sel,
            res,
            full_scale_gauss,
            rotation: rotation.map(Into::into),
            active_area_mm: (element.active_area != perfect.active_area).then_some(element.active_area),
            plates_mm: x.or(y).or(z).map(|_| PlatesTable { x, y, z }),
            ..HallKeys::default()
        };
        let of_part = part.as_deref().and_then(Part::named).unwrap_or_default();
        let mut noise = HallKeys { noise_ut: of_part.noise_ut, ..HallKeys::default() };
        for (_, unit, _, written, value) in noise.keys(&mut perfect) {
            *value = written.map_or(*value, |written| DVec3::from(written).map(|value| unit.read(value)));
        }
        if let Some(scale) = of_part.scale(setting.or(of_part.default_setting())) {
            (perfect.count_t, perfect.range_t) = (scale.count_t, scale.range_t);
        }
        let defaults = HallKeys::default().keys(&mut perfect).map(|(.., value)| *value);
        for (index, (_, unit, _, written, value)) in table.keys(&mut element.clone()).into_iter().enumerate() {
            // The others follow from the part, also with another setting.
            let is_given = *value != defaults[index];
            *written = (is_given && value.is_finite()).then(|| value.map(|value| unit.written(value)).into());
        }
        table
    }
}

/// The numbers of a part by its name, or none after adding a fault.
fn part(name: &str, faults: &mut TableFaults) -> Part {
    Part::named(name).unwrap_or_else(|| {
        let known = Part::names().join(", ");
        faults.add(format!("part = \"{}\", must be one of: {known}; or leave it out", shown(name)));
        Part::default()
    })
}

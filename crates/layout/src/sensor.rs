//! `[sensor]`: the three-axis Hall sensor below the film.

use glam::DVec3;
use magsplice_magnet::{Axis, HallSensor};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::{Faults, POSITIVE};
use crate::hall_keys::{HallKeys, StatedHall};
use crate::head::{HeadKeys, StatedHead};
use crate::places::Place;
use crate::rotation::Rotation;
use crate::sensor_part::{Part, PartSetting};

/// The sensor that a layout states.
#[derive(Clone, Debug, PartialEq)]
pub struct StatedSensor {
    /// The part whose numbers it has where the layout gives no others.
    pub part: Option<String>,
    /// The setting of the part, as written.
    pub setting: Option<PartSetting>,
    /// Readings per second.
    pub rate_hz: Option<f64>,
    /// The rotation as written, from which the one of `element` was computed.
    pub rotation: Option<Rotation>,
    /// What it reads, or what each sensor of the head reads that states nothing else. Lengths in
    /// millimetres.
    pub element: HallSensor,
    /// The sensors of a head.
    pub head: Option<StatedHead>,
}

impl StatedSensor {
    /// The sensor that reads what the layout states: the sensor itself, or that of a head.
    pub fn as_one(&self) -> HallSensor {
        self.head.as_ref().map_or(self.element, |head| head.sensors.as_one())
    }

    /// The finest setting of the part whose range holds these readings in tesla, and this range.
    /// The range must be larger than the sensor's along axes with a reading at its limit. `None`
    /// without a part, and if no setting of the part has such a range.
    pub fn setting_for<'r>(&self, readings_t: impl IntoIterator<Item = &'r DVec3>) -> Option<(PartSetting, DVec3)> {
        let finite = readings_t.into_iter().filter(|reading| reading.is_finite());
        let largest_t = finite.fold(DVec3::ZERO, |largest, reading| largest.max(reading.abs()));
        let needed_t = DVec3::from(Axis::ALL.map(|axis| {
            let (index, along) = (axis.index(), axis.unit());
            let is_limited = self.element.is_saturated(largest_t * along);
            if is_limited { largest_t[index].max(self.element.range_t[index]) } else { largest_t[index] }
        }));
        Part::named(self.part.as_deref()?)?.setting_for(needed_t)
    }
}

/// The three-axis Hall sensor below the film, or a head of several. Without this table it is
/// perfect: points without errors, noise or limits.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
#[schemars(rename = "Sensor")]
pub(crate) struct SensorTable {
    #[serde(flatten)]
    hall: HallKeys,
    /// Readings per second. Default: that of the part, else not stated.
    rate_hz: Option<f64>,
    #[serde(flatten)]
    head: HeadKeys,
}

impl SensorTable {
    /// The sensor below an ideal film of this wavelength in millimetres, or `None` after adding
    /// faults.
    pub(crate) fn resolve(
        self,
        wavelength_mm: Option<f64>,
        place: &Place,
        faults: &mut Faults,
    ) -> Option<StatedSensor> {
        let mut own = faults.at(place.start, "sensor");
        let hall = self.hall.clone().resolve(&mut own);
        own.number("rate_hz", self.rate_hz, POSITIVE);
        let (before, has_head) = (faults.count(), self.head.is_given());
        let head =
            hall.as_ref().and_then(|of| self.head.resolve(&self.hall, &of.element, wavelength_mm, place, faults));
        let StatedHall { part, setting, rate_hz, rotation, element } = hall?;
        if faults.count() > before || has_head != head.is_some() {
            return None;
        }
        Some(StatedSensor { part, setting, rate_hz: self.rate_hz.or(rate_hz), rotation, element, head })
    }
}

impl From<&StatedSensor> for SensorTable {
    fn from(sensor: &StatedSensor) -> SensorTable {
        let StatedSensor { part, setting, rate_hz, rotation, element, head } = sensor.clone();
        let hall = StatedHall { part, setting, rate_hz, rotation, element };
        SensorTable {
            rate_hz,
            hall: HallKeys::from(&hall),
            head: head.as_ref().map(HeadKeys::from).unwrap_or_default(),
        }
    }
}

impl StatedSensor {
    /// The names of the parts with known numbers, in alphabetical order.
    pub fn part_names() -> Vec<String> {
        Part::names()
    }

    /// A part with known numbers, by its name. `None` if there is no such part.
    pub fn of_part(name: &str) -> Option<StatedSensor> {
        let table = SensorTable { hall: HallKeys::of_part(name), ..SensorTable::default() };
        Part::named(name).and_then(|_| table.resolve(None, &Place::default(), &mut Faults::new("")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_found_by_its_name_alone() {
        let sensor = StatedSensor::of_part("MLX90393").expect("a part");
        assert_eq!(sensor.part.as_deref(), Some("MLX90393"));
        assert!(sensor.element.range_t.is_finite() && sensor.element.noise_t.cmpgt(DVec3::ZERO).all());
        assert_eq!(StatedSensor::of_part("MLX"), None);
        assert_eq!(StatedSensor::part_names(), ["LIS3MDL", "MLX90393", "MMC5983MA", "TLV493D"]);
    }
}

//! `[sensor]`: the three-axis Hall sensor below the film.

use glam::DVec3;
use magsplice_head::Board;
use magsplice_magnet::{Axis, HallSensor};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::LayoutFault;
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

impl StatedSensor {
    /// A sensor without errors, noise or limits.
    pub fn perfect() -> StatedSensor {
        let sensor = SensorTable::default().resolve(None, &Place::default(), &mut Faults::new(""));
        sensor.expect("a table without keys is valid")
    }

    /// A head of sensors like this one, on a board below an ideal film of this wavelength. Lengths
    /// in millimetres; without a spacing the board has its own, or half a wavelength.
    ///
    /// # Errors
    /// If the board needs another spacing, or none of the spacings that it can have is valid.
    pub fn on_board(
        &self,
        board: Board,
        spacing_mm: Option<f64>,
        wavelength_mm: f64,
    ) -> Result<StatedSensor, Vec<LayoutFault>> {
        let table = SensorTable { head: HeadKeys::of_board_named(board, spacing_mm), ..SensorTable::from(self) };
        let mut faults = Faults::new("");
        let sensor = table.resolve(Some(wavelength_mm), &Place::default(), &mut faults);
        // No file has a line of the board.
        let unplaced = |fault: LayoutFault| LayoutFault { line: None, ..fault };
        sensor.ok_or_else(|| faults.into_sorted().into_iter().map(unplaced).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The keys of a part stay, and the spacing of a board follows the rules of a file.
    #[test]
    fn a_sensor_becomes_a_head_on_a_board() {
        let part = StatedSensor::of_part("MLX90393").expect("a part");
        let head = |board: Board, spacing_mm: Option<f64>| part.on_board(board, spacing_mm, 10.0);
        let cross = head(Board::Cross, None).expect("a head");
        let sensors = cross.head.as_ref().expect("a head").sensors.elements.clone();
        assert_eq!((sensors.len(), sensors[4].place), (5, DVec3::new(5.0, 5.0, 0.0)));
        assert_eq!((cross.part.as_deref(), sensors[4].sensor), (Some("MLX90393"), part.element));
        let faults = |board: Board, spacing_mm: Option<f64>| head(board, spacing_mm).expect_err("refused").len();
        assert_eq!([faults(Board::PairZ, None), faults(Board::PairZ, Some(-1.0))], [1, 1]);
        assert_eq!(faults(Board::Reskin, Some(5.0)), 1);
        assert_eq!(StatedSensor::perfect().element, HallSensor::default());
    }

    #[test]
    fn a_part_is_found_by_its_name_alone() {
        let sensor = StatedSensor::of_part("MLX90393").expect("a part");
        assert_eq!(sensor.part.as_deref(), Some("MLX90393"));
        assert!(sensor.element.range_t.is_finite() && sensor.element.noise_t.cmpgt(DVec3::ZERO).all());
        assert_eq!(StatedSensor::of_part("MLX"), None);
        assert_eq!(StatedSensor::part_names(), ["LIS3MDL", "MLX90393", "MMC5983MA", "TLV493D"]);
    }
}

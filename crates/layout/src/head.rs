//! Several Hall sensors on one board, read as one weighted sum: `head` and `[[sensor.element]]`.

use std::f64::consts::TAU;

use glam::DVec3;
use magsplice_head::{Board, HeadElement, SensorHead, least_noise_weights};
use magsplice_magnet::HallSensor;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::{FINITE, Faults, POSITIVE, TableFaults};
use crate::hall_keys::HallKeys;
use crate::one_or_three::OneOrThree;
use crate::places::Place;

/// Largest number of sensors on a board.
const MAX_ELEMENTS: usize = 64;

/// Several Hall sensors on a board, read as one weighted sum.
#[derive(Clone, Debug, PartialEq)]
pub struct StatedHead {
    /// The board that the layout names.
    pub board: Option<Board>,
    /// The spacing of a board that may have any, in millimetres.
    pub spacing_mm: Option<f64>,
    /// The sensors. Places in millimetres.
    pub sensors: SensorHead,
    /// Whether the layout states the weights. Otherwise they are those of least noise.
    pub has_stated_weights: bool,
    /// As written.
    keys: HeadKeys,
}

/// Keys of a head.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
pub(crate) struct HeadKeys {
    /// A board of several sensors, read as one weighted sum: two of them, the second below
    /// ("pair-z") or aside along x and y ("pair-xy"); five, at the centre and the corners of a
    /// square ("cross"); the five of the boards of ReSkin, AnySkin and eFlesh ("reskin").
    head: Option<Board>,
    /// Distance of the sensors of "pair-z" along z, or of "pair-xy" and "cross" along x and along
    /// y, in mm. Default for the last two: half a wavelength of [ideal].
    spacing_mm: Option<f64>,
    /// The sensors of a board of your own. Their keys replace those of [sensor].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    element: Vec<ElementTable>,
}

/// A sensor of a board. A part of its own has no number of the part of [sensor].
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(rename = "SensorElement")]
pub(crate) struct ElementTable {
    /// Place on the board, in mm. Positions of the sensor are those of the origin of the board.
    #[schemars(extend("example" = "[0.0, 0.0, -1.0]"))]
    position_mm: [f64; 3],
    /// Factor of its reading in the sum: one for all axes, or three. Default: the weights of least
    /// noise that reject uniform fields and keep the form of Eq. 2, and reject linear fields where
    /// the sensors can.
    weight: Option<OneOrThree>,
    #[serde(flatten)]
    hall: HallKeys,
}

impl HeadKeys {
    /// The keys of a board with a name.
    pub(crate) fn of_board_named(board: Board, spacing_mm: Option<f64>) -> HeadKeys {
        HeadKeys { head: Some(board), spacing_mm, element: Vec::new() }
    }

    /// Whether the keys describe a head.
    pub(crate) fn is_given(&self) -> bool {
        self.head.is_some() || self.spacing_mm.is_some() || !self.element.is_empty()
    }

    /// The head of sensors with these keys where they have none of their own. `None` without one,
    /// or after adding faults.
    pub(crate) fn resolve(
        self,
        common: &HallKeys,
        sensor: &HallSensor,
        wavelength_mm: Option<f64>,
        place: &Place,
        faults: &mut Faults,
    ) -> Option<StatedHead> {
        if !self.is_given() {
            return None;
        }
        let has_stated_weights = self.element.iter().any(|element| element.weight.is_some());
        let (elements, spacing_mm) = match self.head {
            Some(board) => {
                let mut own = faults.at(place.start, "sensor");
                let spacing_mm = self.spacing_of(board, wavelength_mm, &mut own)?;
                let element = |place: DVec3| HeadElement { sensor: *sensor, place, weight: DVec3::ZERO };
                let elements = board.places(spacing_mm).into_iter().map(element).collect();
                (elements, Some(spacing_mm).filter(|_| board.own_spacing_mm().is_none()))
            }
            None => (self.of_elements(common, place, faults)?, None),
        };
        let mut own = faults.at(place.start, "sensor");
        let sensors = match has_stated_weights {
            true => SensorHead { elements },
            false => weighted(elements, wavelength_mm, &mut own)?,
        };
        Some(StatedHead { board: self.head, spacing_mm, sensors, has_stated_weights, keys: self })
    }

    /// The spacing of a board with a name.
    fn spacing_of(&self, board: Board, wavelength_mm: Option<f64>, faults: &mut TableFaults) -> Option<f64> {
        let name = board.name();
        if !self.element.is_empty() {
            return faults.refuse(format!("head = \"{name}\" and [[sensor.element]] are both given: give one of them"));
        }
        let before = faults.count();
        faults.number("spacing_mm", self.spacing_mm, POSITIVE);
        let half_wave_mm = wavelength_mm.map(|wavelength_mm| 0.5 * wavelength_mm);
        let spacing_mm = match (board.own_spacing_mm(), self.spacing_mm) {
            (Some(own_mm), Some(spacing_mm)) => {
                let rule = format_args!("must not be given for head = \"{name}\", whose spacing is {own_mm} mm");
                faults.require(false, "spacing_mm", spacing_mm, rule);
                None
            }
            (own_mm, spacing_mm) => own_mm.or(spacing_mm).or(half_wave_mm.filter(|_| board != Board::PairZ)),
        };
        if spacing_mm.is_none() && faults.count() == before {
            faults.add(format!("head = \"{name}\" has no distance of its sensors: give spacing_mm"));
        }
        spacing_mm.filter(|_| faults.count() == before)
    }

    /// The sensors of the tables, with the weights that they state.
    fn of_elements(&self, common: &HallKeys, place: &Place, faults: &mut Faults) -> Option<Vec<HeadElement>> {
        let mut own = faults.at(place.start, "sensor");
        if let Some(spacing_mm) = self.spacing_mm {
            return own
                .refuse(format!("spacing_mm = {spacing_mm}, is the distance of the sensors of a head: give head"));
        }
        let (count, before) = (self.element.len(), own.count());
        own.require(count <= MAX_ELEMENTS, "sensors", count, format_args!("must be at most {MAX_ELEMENTS}"));
        if self.element.iter().any(|element| element.weight.is_some() != self.element[0].weight.is_some()) {
            own.add("weight is given for some sensors only: give it for all, or for none");
        }
        if own.count() > before {
            return None;
        }
        let place = place.key("element");
        let resolve = |(index, table): (usize, &ElementTable)| -> Option<HeadElement> {
            let mut own = faults.at(place.item(index).start, format!("sensor.element {}", index + 1));
            own.point("position_mm", table.position_mm);
            if let Some(weight) = table.weight {
                weight.check("weight", FINITE, &mut own);
            }
            let hall = table.hall.clone().or(common).resolve(&mut own)?;
            let weight = table.weight.map_or(DVec3::ZERO, DVec3::from);
            Some(HeadElement { sensor: hall.element, place: table.position_mm.into(), weight })
        };
        let elements: Vec<Option<HeadElement>> = self.element.iter().enumerate().map(resolve).collect();
        if faults.count() > before {
            return None;
        }
        elements.into_iter().collect()
    }
}

/// The head with the weights of least noise.
fn weighted(
    mut elements: Vec<HeadElement>,
    wavelength_mm: Option<f64>,
    faults: &mut TableFaults,
) -> Option<SensorHead> {
    let Some(wavelength_mm) = wavelength_mm else {
        return faults
            .refuse("the sensors have no weights, and without [ideal] none are computed: give both, or weight");
    };
    let places: Vec<DVec3> = elements.iter().map(|of| of.place).collect();
    // One weight for the axes of a sensor: its noise is the root mean square of theirs.
    let deviations: Vec<f64> = elements.iter().map(|of| (of.sensor.deviation_t() / of.sensor.gain).length()).collect();
    match least_noise_weights(&places, &deviations, TAU / wavelength_mm) {
        Ok(weights) => {
            elements.iter_mut().zip(weights).for_each(|(of, weight)| of.weight = DVec3::splat(weight));
            Some(SensorHead { elements })
        }
        Err(error) => faults.refuse(error.to_string()),
    }
}

impl From<&StatedHead> for HeadKeys {
    fn from(head: &StatedHead) -> HeadKeys {
        head.keys.clone()
    }
}

//! The head of a film in numbers.

use std::f64::consts::TAU;
use std::fmt;

use glam::DVec3;
use magsplice_head::{Board, HeadForm};
use magsplice_layout::Layout;
use serde::Serialize;

use super::significant::number;

/// Distance from the form of Eq. 2, and reading of a uniform field of 1, that are round-off.
const ROUND_OFF: f64 = 1e-9;

/// The sensors of a head, and what their sum reads of an ideal film and of a uniform field.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeadSummary {
    /// The board that the layout names.
    pub board: Option<Board>,
    /// Number of sensors.
    pub sensors: usize,
    /// The reading of the ideal film over that of one sensor; `None` without `[ideal]`.
    pub factor: Option<f64>,
    /// Distance from the form of Eq. 2 (see [`HeadForm::distance`]); `None` without `[ideal]`.
    pub distance: Option<f64>,
    /// The reading of a uniform field along each axis over that of one sensor.
    pub uniform: DVec3,
}

impl HeadSummary {
    /// The head of a layout; `None` for one sensor.
    pub fn of(layout: &Layout) -> Option<HeadSummary> {
        let head = layout.sensor.as_ref()?.head.as_ref()?;
        let form = |wavenumber: f64| head.sensors.form(wavenumber);
        let of_ideal = layout.ideal.as_ref().map(|ideal| form(TAU / ideal.wavelength()));
        Some(HeadSummary {
            board: head.board,
            sensors: head.sensors.elements.len(),
            factor: of_ideal.map(|form| form.factor()),
            distance: of_ideal.map(|form: HeadForm| form.distance()),
            uniform: form(0.0).uniform,
        })
    }
}

impl fmt::Display for HeadSummary {
    /// Writes the sensors, then what they do not reject or keep.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "weighted sum of {} sensors", self.sensors)?;
        if let Some(board) = self.board {
            write!(f, " ({})", board.name())?;
        }
        if self.uniform.abs().max_element() > ROUND_OFF {
            let [x, y, z] = self.uniform.to_array().map(number);
            write!(f, ", which reads ({x}, {y}, {z}) of a uniform field of 1")?;
        }
        if let Some(factor) = self.factor.filter(|factor| (factor - 1.0).abs() > ROUND_OFF) {
            write!(f, ", {} times the ideal film", number(factor))?;
        }
        match self.distance.filter(|distance| *distance > ROUND_OFF) {
            Some(distance) => write!(f, ", and differs from the form of Eq. 2 by {} of it", number(distance)),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Film;

    /// Five sensors below the published film; docs/heads.md has the numbers.
    #[test]
    fn cross_below_the_published_film_has_the_known_errors() {
        let layout = Layout::read("../../layouts/heads/published-cross.toml").unwrap_or_else(|error| panic!("{error}"));
        let film = Film::new(layout).unwrap();
        let found = DVec3::from(film.decouple().unwrap().decoupling.displacement_rmse_mm.to_array());
        assert!((found - DVec3::new(0.0326, 0.0326, 0.0306)).abs().max_element() < 6e-5, "{found}");
        let summary = HeadSummary::of(film.layout()).unwrap();
        assert_eq!(summary.to_string(), "weighted sum of 5 sensors (cross)");
        // One sensor reads 0.82 of the ideal film, which lacks no field beyond a rim.
        let comparison = film.compare().unwrap().comparison;
        assert!((0.91..0.92).contains(&comparison.amplitude), "{}", comparison.amplitude);
        let one = Film::new(Layout { sensor: None, ..Layout::clone(film.layout()) }).unwrap();
        assert!(one.decouple().unwrap().decoupling.displacement_rmse_mm.to_array().iter().all(|of| *of > 0.2));
    }

    /// Weights that keep nothing: half the reading of one sensor, and all of one 1 mm below.
    #[test]
    fn weights_that_break_the_rules_are_named() {
        let text = "format = 1\nname = \"two\"\n[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.1\n\
            [sensor]\n[[sensor.element]]\nposition_mm = [0, 0, 0]\nweight = 0.5\n\
            [[sensor.element]]\nposition_mm = [1, 0, 0]\nweight = 1\n\
            [[tile]]\nposition_mm = [0, 0, 0.5]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
        let summary = HeadSummary::of(&Layout::parse(text, "two").unwrap()).unwrap();
        // Along x 0.5 + e^(i 36 deg), along y 1.5: the mean of the real parts is 1.4045.
        let (along_x, factor) = ((0.1 * TAU).cos(), 0.25 * (2.0 * (0.5 + (0.1 * TAU).cos()) + 3.0));
        assert!((summary.factor.unwrap() - factor).abs() < 1e-14);
        let distance = f64::hypot(0.5 + along_x - factor, (0.1 * TAU).sin()) / factor;
        assert!((summary.distance.unwrap() - distance).abs() < 1e-14);
        let words = summary.to_string();
        assert!(
            words.contains(
                "reads (1.500000, 1.500000, 1.500000) of a uniform field of 1, 1.404508 times the ideal film"
            ),
            "{words}"
        );
        assert!(words.ends_with("differs from the form of Eq. 2 by 0.423986 of it"), "{words}");
    }
}

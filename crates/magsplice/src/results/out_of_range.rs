//! Readings beyond the range of the sensor of a layout.

use glam::DVec3;
use magsplice_magnet::{Axis, HallSensor};
use serde::Serialize;

use crate::film::Film;
use crate::film_error::FilmError;
use crate::results::at_limit::larger_range;

/// Bytes for each point: the point and the reading of each sensor, each twice while they are
/// evaluated.
const BYTES_PER_POINT: f64 = 48.0;

/// The points of the working volume at which a reading is at the limit of the sensor's range, or
/// would be beyond it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OutOfRange {
    /// Number of these points.
    pub points: usize,
    /// Number of all points.
    pub of: usize,
    /// The axis along which a reading exceeds the range most, as a ratio.
    pub axis: Axis,
    /// The largest magnitude of a reading along this axis, without the limit.
    pub largest_t: f64,
    /// The range along this axis.
    pub range_t: f64,
    /// The number of the sensor of a head that this is, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<usize>,
    /// The setting of the part that holds all readings, with its range, as the end of a sentence.
    #[serde(skip)]
    pub setting: Option<String>,
}

impl Film {
    /// The readings beyond the range of the layout's sensor, over the working volume. `None`
    /// without a sensor, without a range, and if all readings are within it.
    ///
    /// # Errors
    /// If the layout has no working volume, or the sensor cannot read the field.
    pub fn out_of_range(&self) -> Result<Option<OutOfRange>, FilmError> {
        let sensors = self.layout().head().map_or(1, |head| head.elements.len());
        let grid = self.volume_for(BYTES_PER_POINT * (1 + sensors) as f64)?.grid;
        let sensed = self.sensed_field(&grid)?;
        let head = self.layout().head();
        let sensors: Vec<HallSensor> =
            head.map_or_else(|| vec![*sensed.sensor()], |head| head.elements.iter().map(|of| of.sensor).collect());
        if sensors.iter().all(|sensor| sensor.range_t.min_element().is_infinite()) {
            return Ok(None);
        }
        let points: Vec<DVec3> = grid.points().collect();
        let readings = sensed.readings_of_sensors_t(&points).map_err(FilmError::Points)?;
        let is_beyond = |point: usize| {
            let mut all = sensors.iter().zip(&readings);
            all.any(|(sensor, readings_t)| sensor.is_saturated(sensor.digitized_t(readings_t[point])))
        };
        let beyond = (0..points.len()).filter(|point| is_beyond(*point)).count();
        let of_sensor = |(number, (sensor, readings_t)): (usize, (&HallSensor, &Vec<DVec3>))| {
            let largest = readings_t.iter().fold(DVec3::ZERO, |most, reading| most.max(reading.abs()));
            Axis::ALL.map(|axis| OutOfRange {
                points: beyond,
                of: points.len(),
                axis,
                largest_t: largest[axis.index()],
                range_t: sensor.range_t[axis.index()],
                sensor: head.map(|_| number + 1),
                setting: None,
            })
        };
        let excess = |of: &OutOfRange| of.largest_t / of.range_t;
        let all = sensors.iter().zip(&readings).enumerate().flat_map(of_sensor);
        let worst = all.max_by(|a, b| excess(a).total_cmp(&excess(b))).filter(|_| beyond > 0);
        let stated = self.layout().sensor.as_ref().filter(|_| head.is_none());
        let setting = stated.and_then(|sensor| larger_range(sensor, readings.iter().flatten()));
        Ok(worst.map(|worst| OutOfRange { setting, ..worst }))
    }
}

#[cfg(test)]
mod tests {
    use magsplice_layout::Layout;

    use super::*;

    /// One tile, whose field along x and z differs.
    fn film(sensor: &str) -> Film {
        let text = format!(
            "format = 1\nname = \"one\"\n[volume]\nx_mm = [-1, 1]\ny_mm = [-1, 1]\nz_mm = [-4, -2]\nstep_mm = 1\n\
             [[tile]]\nposition_mm = [0, 0, 0.5]\nsize_mm = [3, 3, 1]\npolarization_t = [0, 0, 1.2]\n{sensor}"
        );
        Film::new(Layout::parse(&text, "test").expect("a layout")).expect("a film")
    }

    #[test]
    fn readings_beyond_the_range_are_counted() {
        assert_eq!(film("").out_of_range(), Ok(None));
        assert_eq!(film("[sensor]\nnoise_ut = 1").out_of_range(), Ok(None));
        let field = film("");
        let field = field.volume_field_t().expect("a field");
        let largest = field.iter().map(|b| b.z.abs()).fold(0.0, f64::max);
        assert_eq!(film(&format!("[sensor]\nrange_mt = {}", 1001.0 * largest)).out_of_range(), Ok(None));
        let range_t = 0.9 * largest;
        let found = film(&format!("[sensor]\nrange_mt = {}", 1e3 * range_t)).out_of_range().expect("readings");
        let found = found.expect("beyond the range");
        let beyond = field.iter().filter(|b| b.abs().max_element() >= range_t).count();
        assert_eq!((found.points, found.of, found.axis), (beyond, 27, Axis::Z));
        assert!((found.largest_t - largest).abs() < 1e-12 && (found.range_t - range_t).abs() < 1e-12, "{found:?}");
        // A sensor at the rim reads another field than the head, which reads the sum.
        let of_head = |range: &str| {
            let elements = format!(
                "[[sensor.element]]\nposition_mm = [0, 0, 0]\nweight = 1\n{range}\n\
                 [[sensor.element]]\nposition_mm = [9, 0, 0]\nweight = -1\n"
            );
            film(&format!("[sensor]\nrange_mt = 1000\n{elements}")).out_of_range().expect("readings")
        };
        assert_eq!(of_head(""), None);
        let of_first = of_head(&format!("range_mt = {}", 1e3 * range_t)).expect("beyond the range");
        assert_eq!(
            of_first,
            OutOfRange {
                sensor: Some(1),
                ..film(&format!("[sensor]\nrange_mt = {}", 1e3 * range_t)).out_of_range().unwrap().unwrap()
            }
        );
        // The range of x alone.
        let found = film("[sensor]\nrange_mt = [0.001, 1000, 1000]").out_of_range().expect("readings");
        assert_eq!(found.expect("beyond the range").axis, Axis::X);
    }
}

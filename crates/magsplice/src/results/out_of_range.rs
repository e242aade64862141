//! Readings beyond the range of the sensor of a layout.

use glam::DVec3;
use magsplice_magnet::Axis;
use serde::Serialize;

use crate::film::Film;
use crate::film_error::FilmError;

/// Bytes for each point: the point and its reading, each twice while they are evaluated.
const BYTES_PER_POINT: f64 = 96.0;

/// The points of the working volume at which a reading is at the limit of the sensor's range, or
/// would be beyond it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
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
}

impl Film {
    /// The readings beyond the range of the layout's sensor, over the working volume. `None`
    /// without a sensor, without a range, and if all readings are within it.
    ///
    /// # Errors
    /// If the layout has no working volume, or the sensor cannot read the field.
    pub fn out_of_range(&self) -> Result<Option<OutOfRange>, FilmError> {
        let grid = self.volume_for(BYTES_PER_POINT)?.grid;
        let sensed = self.sensed_field(&grid)?;
        let sensor = *sensed.sensor();
        if !sensor.range_t.is_finite() && sensor.range_t.min_element().is_infinite() {
            return Ok(None);
        }
        let points: Vec<DVec3> = grid.points().collect();
        let readings = sensed.readings_t(&points).map_err(FilmError::Points)?;
        let beyond = readings.iter().filter(|reading| sensor.is_saturated(sensor.digitized_t(**reading))).count();
        let largest = readings.iter().fold(DVec3::ZERO, |most, reading| most.max(reading.abs()));
        let excess = largest / sensor.range_t;
        let axis = Axis::ALL.into_iter().max_by(|a, b| excess[a.index()].total_cmp(&excess[b.index()]));
        let of_axis = |axis: Axis| OutOfRange {
            points: beyond,
            of: points.len(),
            axis,
            largest_t: largest[axis.index()],
            range_t: sensor.range_t[axis.index()],
        };
        Ok(axis.filter(|_| beyond > 0).map(of_axis))
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
        // The range of x alone.
        let found = film("[sensor]\nrange_mt = [0.001, 1000, 1000]").out_of_range().expect("readings");
        assert_eq!(found.expect("beyond the range").axis, Axis::X);
    }
}

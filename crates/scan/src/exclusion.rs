//! Readings that a fit does not use.

use std::fmt;

use glam::DVec3;
use magsplice_magnet::{Axis, HallSensor};
use serde::Serialize;

/// The reason why a fit does not use a reading.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Exclusion {
    /// A component is missing: it is not a finite number.
    Incomplete,
    /// A component is at the limit of the sensor's range.
    Saturated,
    /// The reading contradicts the fit of the others.
    Outlier,
}

impl Exclusion {
    /// The reading cannot be used with any parameters.
    pub fn of_reading(sensor: &HallSensor, reading_t: DVec3) -> Option<Exclusion> {
        match reading_t {
            incomplete if !incomplete.is_finite() => Some(Exclusion::Incomplete),
            saturated if sensor.is_saturated(saturated) => Some(Exclusion::Saturated),
            _ => None,
        }
    }
}

/// Outliers that share the extreme of a component, as readings of a sensor at its limit do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Plateau {
    /// The component.
    pub axis: Axis,
    /// Its largest or smallest reading, in the unit of the readings.
    pub reading_t: f64,
    /// Number of outliers with this reading.
    pub outliers: usize,
}

impl Plateau {
    /// The plateau of most outliers. `None` where no two share an extreme.
    pub fn among(readings_t: &[DVec3], exclusions: &[Option<Exclusion>]) -> Option<Plateau> {
        let of = |axis: Axis, sign: f64| {
            let component = |reading: &DVec3| sign * reading[axis.index()];
            let extreme = readings_t.iter().map(component).fold(f64::NEG_INFINITY, f64::max);
            let shares = |(reading, exclusion): &(&DVec3, &Option<Exclusion>)| {
                **exclusion == Some(Exclusion::Outlier) && component(reading) == extreme
            };
            let outliers = readings_t.iter().zip(exclusions).filter(shares).count();
            Plateau { axis, reading_t: sign * extreme, outliers }
        };
        let all = Axis::ALL.into_iter().flat_map(|axis| [of(axis, 1.0), of(axis, -1.0)]);
        all.filter(|plateau| plateau.outliers > 1).max_by_key(|plateau| plateau.outliers)
    }
}

impl fmt::Display for Plateau {
    /// How many outliers share the reading, and what to do.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let extreme = if self.reading_t > 0.0 { "largest" } else { "smallest" };
        let Plateau { axis, outliers, .. } = self;
        write!(f, "{outliers} outliers share the {extreme} reading of b{axis}: if it is the limit of the sensor, ")?;
        f.write_str("state it as range_mt in [sensor]")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outliers_at_one_extreme_are_a_plateau() {
        let outlier = Some(Exclusion::Outlier);
        let readings_t = [[1.0, 0.0, -3.0], [2.0, 5.0, -3.0], [2.0, 1.0, -3.0], [9.0, 1.0, f64::NAN]].map(DVec3::from);
        let found = Plateau::among(&readings_t, &[None, outlier, outlier, Some(Exclusion::Incomplete)]);
        assert_eq!(found, Some(Plateau { axis: Axis::Z, reading_t: -3.0, outliers: 2 }));
        // One outlier is wild, and shared readings of x are no extreme.
        assert_eq!(Plateau::among(&readings_t, &[None, outlier, None, None]), None);
    }
}

//! Columns of a table of readings that no scan has.

use std::ops::Range;

use glam::DVec3;
use magsplice_magnet::Axis;
use thiserror::Error;

/// Smallest number of readings that are alike by more than chance.
const LEAST_READINGS: usize = 4;

/// Smallest number of successive readings, and smallest share of all readings, that an axis repeats
/// only when it is stuck. A sensor with coarse counts repeats its reading where the field is flat.
const LEAST_RUN: (usize, f64) = (16, 0.1);

/// A fault of the columns, which readings show by themselves.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum ColumnFault {
    /// Two components are equal in all readings.
    #[error("b{0} and b{1} are equal in all readings: one column was written twice")]
    EqualFields(Axis, Axis),
    /// A component is constant.
    #[error("b{axis} is {} mT in all readings: this axis of the sensor is stuck, or its column has other values", in_mt(*.reading_t))]
    ConstantField {
        /// The component.
        axis: Axis,
        /// Its reading.
        reading_t: f64,
    },
    /// A component is constant from one reading on.
    #[error(
        "b{axis} is {} mT in {count} successive readings, from {} on: this axis of the sensor was stuck; leave these \
         readings of all axes out", in_mt(*.reading_t), millimetres(*.from)
    )]
    StuckField {
        /// The component.
        axis: Axis,
        /// Its reading.
        reading_t: f64,
        /// Number of readings.
        count: usize,
        /// Position of the first of them.
        from: DVec3,
    },
    /// Two coordinates are equal at all positions.
    #[error(
        "{0} and {1} of all positions are equal: one column was written twice, unless the scan is along a diagonal"
    )]
    EqualPositions(Axis, Axis),
}

impl ColumnFault {
    /// The fault of these columns. A scan that fits may have it: components vanish on planes of
    /// symmetry, and a scan along a diagonal has equal coordinates.
    pub fn among(points: &[DVec3], readings_t: &[DVec3]) -> Option<ColumnFault> {
        let finite: Vec<DVec3> = readings_t.iter().copied().filter(|reading_t| reading_t.is_finite()).collect();
        if finite.len() < LEAST_READINGS {
            return None;
        }
        let constant = Axis::ALL.into_iter().find_map(|axis| {
            let reading_t = finite[0][axis.index()];
            let is_constant = finite.iter().all(|of| of[axis.index()] == reading_t);
            is_constant.then_some(ColumnFault::ConstantField { axis, reading_t })
        });
        let fields = equal(&finite).map(|(a, b)| ColumnFault::EqualFields(a, b));
        let stuck = || Axis::ALL.into_iter().find_map(|axis| stuck(axis, points, readings_t));
        constant.or(fields).or_else(stuck).or_else(|| equal(points).map(|(a, b)| ColumnFault::EqualPositions(a, b)))
    }
}

/// A reading in millitesla, to a nanotesla: the unit of a file leaves digits of round-off.
fn in_mt(reading_t: f64) -> f64 {
    (1e9 * reading_t).round() / 1e6
}

/// A position in words.
fn millimetres(point: DVec3) -> String {
    let [x, y, z] = point.to_array().map(|coordinate| (1e6 * coordinate).round() / 1e6);
    format!("({x}, {y}, {z}) mm")
}

/// The longest repetition of one reading of an axis, if it is too long for chance. Components
/// vanish along lines of symmetry.
fn stuck(axis: Axis, points: &[DVec3], readings_t: &[DVec3]) -> Option<ColumnFault> {
    let component = |number: usize| readings_t[number][axis.index()];
    let mut longest: Range<usize> = 0..0;
    let mut first = 0;
    for number in 1..=readings_t.len() {
        if number == readings_t.len() || component(number) != component(first) {
            if number - first > longest.len() && component(first) != 0.0 {
                longest = first..number;
            }
            first = number;
        }
    }
    let (least, share) = LEAST_RUN;
    let is_long = longest.len() >= least && longest.len() as f64 >= share * readings_t.len() as f64;
    let reading_t = is_long.then(|| component(longest.start))?;
    // The limit of a range is read again and again.
    let count = readings_t.iter().filter(|of| of[axis.index()] == reading_t).count();
    if count > longest.len() {
        return None;
    }
    Some(ColumnFault::StuckField { axis, reading_t, count, from: points[longest.start] })
}

/// Two components that are equal and not constant.
fn equal(vectors: &[DVec3]) -> Option<(Axis, Axis)> {
    let [x, y, z] = Axis::ALL;
    [(x, y), (x, z), (y, z)].into_iter().find(|(a, b)| {
        let pairs = || vectors.iter().map(|vector| (vector[a.index()], vector[b.index()]));
        pairs().all(|(a, b)| a == b) && pairs().any(|pair| Some(pair) != pairs().next())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_and_constant_columns_are_found() {
        let points: Vec<DVec3> = (0..6).map(|n| DVec3::new(f64::from(n), f64::from(n * n), -3.0)).collect();
        let readings_t: Vec<DVec3> = points.iter().map(|p| DVec3::new(p.y, 2.0 * p.x, 1.0 - p.x)).collect();
        assert_eq!(ColumnFault::among(&points, &readings_t), None);
        let changed = |change: fn(&DVec3) -> DVec3| readings_t.iter().map(change).collect::<Vec<_>>();
        let twice = changed(|of| DVec3::new(of.z, of.y, of.z));
        assert_eq!(ColumnFault::among(&points, &twice), Some(ColumnFault::EqualFields(Axis::X, Axis::Z)));
        let constant = changed(|of| DVec3::new(of.x, 2e-3, of.z));
        let fault = ColumnFault::ConstantField { axis: Axis::Y, reading_t: 2e-3 };
        assert_eq!(ColumnFault::among(&points, &constant), Some(fault));
        let of_file = ColumnFault::ConstantField { axis: Axis::X, reading_t: 1606.78 * 1e-6 };
        assert!(of_file.to_string().starts_with("bx is 1.60678 mT"), "{of_file}");
        let among = |count: i32| {
            let points: Vec<DVec3> = (0..count).map(|n| DVec3::new(f64::from(n), 0.5, -3.0)).collect();
            let readings_t = points.iter().map(|p| DVec3::new(p.x, -(p.x % 40.0).min(8.0), 1.0 - p.x));
            ColumnFault::among(&points, &readings_t.collect::<Vec<_>>())
        };
        let from = DVec3::new(8.0, 0.5, -3.0);
        let stuck = |count| Some(ColumnFault::StuckField { axis: Axis::Y, reading_t: -8.0, count, from });
        // The last of 49 readings is at the limit again.
        assert_eq!([23, 24, 48, 49].map(among), [None, stuck(16), stuck(32), None]);
        let diagonal: Vec<DVec3> = points.iter().map(|p| DVec3::new(p.x, p.x, -3.0)).collect();
        assert_eq!(ColumnFault::among(&diagonal, &readings_t), Some(ColumnFault::EqualPositions(Axis::X, Axis::Y)));
        assert_eq!(ColumnFault::among(&points[..3], &constant[..3]), None);
    }
}

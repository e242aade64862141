//! Columns of a table of readings that no scan has.

use glam::DVec3;
use magsplice_magnet::Axis;
use thiserror::Error;

use crate::frozen_log::FrozenLog;
use crate::still_positions::StillPositions;
use crate::stuck_axis::{StuckAxis, in_mt};

/// Smallest number of readings that are alike by more than chance.
const LEAST_READINGS: usize = 4;

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
    #[error("{0}")]
    Stuck(StuckAxis),
    /// The readings do not change while the positions do.
    #[error("{0} of the readings, at different positions: the log was frozen; leave them out")]
    Frozen(FrozenLog),
    /// Readings at one position contradict each other.
    #[error("{0}")]
    Still(StillPositions),
    /// Two coordinates are equal at all positions.
    #[error(
        "{0} and {1} of all positions are equal: one column was written twice, unless the scan is along a diagonal"
    )]
    EqualPositions(Axis, Axis),
}

impl ColumnFault {
    /// Whether no film explains readings with this fault. Readings may be 0 on a line of symmetry.
    pub fn is_certain(&self) -> bool {
        match self {
            ColumnFault::Stuck(stuck) => stuck.reading_t != 0.0,
            ColumnFault::Still(_) | ColumnFault::Frozen(_) => true,
            _ => false,
        }
    }

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
        let stuck = || StuckAxis::among(readings_t).map(ColumnFault::Stuck);
        let still = || StillPositions::among(points, readings_t).map(ColumnFault::Still);
        let moves = |frozen: &FrozenLog| points[frozen.rows()].iter().any(|point| *point != points[frozen.first]);
        let frozen = || FrozenLog::among(readings_t).filter(moves).map(ColumnFault::Frozen);
        let positions = || equal(points).map(|(a, b)| ColumnFault::EqualPositions(a, b));
        constant.or(fields).or_else(stuck).or_else(frozen).or_else(positions).or_else(still)
    }
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
        let diagonal: Vec<DVec3> = points.iter().map(|p| DVec3::new(p.x, p.x, -3.0)).collect();
        assert_eq!(ColumnFault::among(&diagonal, &readings_t), Some(ColumnFault::EqualPositions(Axis::X, Axis::Y)));
        assert_eq!(ColumnFault::among(&points[..3], &constant[..3]), None);
    }
}

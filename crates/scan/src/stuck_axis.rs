//! An axis of a sensor that repeats its reading.

use std::ops::Range;

use glam::DVec3;
use magsplice_magnet::Axis;
use thiserror::Error;

/// Smallest number of successive readings, and smallest share of all readings, that an axis repeats
/// only when it is stuck. A sensor with coarse counts repeats its reading where the field is flat.
const LEAST_RUN: (usize, f64) = (16, 0.1);

/// Smallest number of other readings, without which the axis may not move.
const LEAST_OTHERS: usize = 8;

/// An axis that had one reading from some reading on, and no other time.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error(
    "b{axis} is {} mT in {count} successive readings, from reading {} on, while the others change: this axis of the \
     sensor was stuck or at the limit of its range; leave these readings of all axes out", in_mt(*.reading_t), first + 1
)]
pub struct StuckAxis {
    /// The axis.
    pub axis: Axis,
    /// Its reading.
    pub reading_t: f64,
    /// Index of the first reading.
    pub first: usize,
    /// Number of readings.
    pub count: usize,
}

impl StuckAxis {
    /// The stuck axis of readings in their order.
    pub fn among(readings_t: &[DVec3]) -> Option<StuckAxis> {
        Axis::ALL.into_iter().find_map(|axis| StuckAxis::along(axis, readings_t))
    }

    fn along(axis: Axis, readings_t: &[DVec3]) -> Option<StuckAxis> {
        let component = |number: usize| readings_t[number][axis.index()];
        let mut longest: Range<usize> = 0..0;
        let mut first = 0;
        for number in 1..=readings_t.len() {
            if number == readings_t.len() || component(number) != component(first) {
                if number - first > longest.len() {
                    longest = first..number;
                }
                first = number;
            }
        }
        let (least, share) = LEAST_RUN;
        let is_long = longest.len() >= least && longest.len() as f64 >= share * readings_t.len() as f64;
        let reading_t = is_long.then(|| component(longest.start))?;
        // The limit of a range, and the field on a line of symmetry, are read again and again.
        let count = readings_t.iter().filter(|of| of[axis.index()] == reading_t).count();
        let has_others = readings_t.iter().filter(|of| of.is_finite()).count() >= count + LEAST_OTHERS;
        // All axes of a sensor at rest repeat their readings.
        let is_at_rest = readings_t[longest.clone()].iter().all(|of| *of == readings_t[longest.start]);
        (count == longest.len() && has_others && !is_at_rest).then_some(StuckAxis {
            axis,
            reading_t,
            first: longest.start,
            count,
        })
    }
}

/// A reading in millitesla, to a nanotesla: the unit of a file leaves digits of round-off.
pub(crate) fn in_mt(reading_t: f64) -> f64 {
    (1e9 * reading_t).round() / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_is_stuck_that_repeats_one_reading_alone() {
        let found = |count: usize, others: f64| {
            let reading = |n: usize| {
                let n = n as f64;
                DVec3::new(others * n, -(n % 40.0).min(8.0), others * (1.0 - n))
            };
            StuckAxis::among(&(0..count).map(reading).collect::<Vec<_>>())
        };
        let stuck = |count| Some(StuckAxis { axis: Axis::Y, reading_t: -8.0, first: 8, count });
        // The last of 49 readings is at the limit again.
        assert_eq!([23, 24, 48, 49].map(|count| found(count, 1.0)), [None, stuck(16), stuck(32), None]);
        // A sensor at rest.
        assert_eq!(found(24, 0.0), None);
        let few: Vec<DVec3> = (0..30).map(|n| DVec3::new(f64::from(n), f64::from(n.min(3)), 1.0)).collect();
        assert_eq!(StuckAxis::among(&few), None);
        assert!(
            stuck(16).unwrap().to_string().starts_with("by is -8000 mT in 16 successive readings, from reading 9 on")
        );
    }
}

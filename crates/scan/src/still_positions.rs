//! Readings at one position that contradict each other.

use std::collections::HashMap;

use glam::DVec3;
use magsplice_magnet::Axis;
use thiserror::Error;

use crate::stuck_axis::in_mt;

/// Smallest number of readings at positions of earlier ones, and smallest share of all readings.
const LEAST_REPEATED: (usize, f64) = (16, 0.1);

/// Median difference over the length of the readings above which they contradict each other. The
/// noise of sensors, and a film that slips a little, are a few per cent.
const LEAST_DIFFERENCE: f64 = 0.2;

/// Readings at positions of earlier ones, whose field is another one. The field depends on the
/// position, so half of them leave a residual that no fit accepts.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error(
    "{repeated} readings are at positions of earlier readings and differ from them, half of them by more than {} mT: {}",
    in_mt(*.difference_t), reason(*.still)
)]
pub struct StillPositions {
    /// Number of readings at a position of an earlier reading.
    pub repeated: usize,
    /// Median of the differences from the first reading at the position.
    pub difference_t: f64,
    /// The coordinate that does not change any more, if there is one, and the index of the reading
    /// from which on.
    pub still: Option<(Axis, usize)>,
}

impl StillPositions {
    /// The readings of a scan, in their order, that contradict each other. Readings that are not
    /// finite are not used.
    pub fn among(points: &[DVec3], readings_t: &[DVec3]) -> Option<StillPositions> {
        let usable = || (0..points.len()).filter(|number| readings_t[*number].is_finite());
        let mut first: HashMap<[u64; 3], usize> = HashMap::new();
        let mut repeated: Vec<usize> = Vec::new();
        let mut differences_t: Vec<f64> = Vec::new();
        for number in usable() {
            let position = points[number].to_array().map(|coordinate| (coordinate + 0.0).to_bits());
            let earlier = *first.entry(position).or_insert(number);
            if earlier != number {
                repeated.push(number);
                differences_t.push((readings_t[number] - readings_t[earlier]).length());
            }
        }
        let (least, share) = LEAST_REPEATED;
        if repeated.len() < least || (repeated.len() as f64) < share * usable().count() as f64 {
            return None;
        }
        differences_t.sort_by(f64::total_cmp);
        let difference_t = differences_t[differences_t.len() / 2];
        let squares: f64 = usable().map(|number| readings_t[number].length_squared()).sum();
        let reading_t = (squares / usable().count() as f64).sqrt();
        (difference_t > LEAST_DIFFERENCE * reading_t).then(|| StillPositions {
            repeated: repeated.len(),
            difference_t,
            still: still(points, &repeated),
        })
    }
}

/// The coordinate that has one value from a reading on, with most of the repeated readings, and had
/// others before. The only one: all coordinates of a stage that does not move have one value.
fn still(points: &[DVec3], repeated: &[usize]) -> Option<(Axis, usize)> {
    let from = |axis: Axis| {
        let last = points.last()?[axis.index()];
        let from = points.iter().rposition(|point| point[axis.index()] != last)? + 1;
        let count = repeated.iter().filter(|number| **number >= from).count();
        (2 * count > repeated.len()).then_some((axis, from))
    };
    let mut found = Axis::ALL.into_iter().filter_map(from);
    found.next().filter(|_| found.next().is_none())
}

/// What makes readings contradict each other.
fn reason(still: Option<(Axis, usize)>) -> String {
    match still {
        Some((axis, from)) => format!(
            "{axis} has one value from reading {} on: the stage or its log stood still; leave these readings out",
            from + 1
        ),
        None => "the positions are those of other readings, the stage stood still, or the film was moved".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A raster of 6 x 6 positions and a field that depends on both coordinates.
    fn raster() -> (Vec<DVec3>, Vec<DVec3>) {
        let points: Vec<DVec3> = (0..36).map(|n| DVec3::new(f64::from(n / 6), f64::from(n % 6), -3.0)).collect();
        let readings_t = points.iter().map(|at| DVec3::new(at.x, at.y - 2.0, 1.0 - at.x)).collect();
        (points, readings_t)
    }

    #[test]
    fn a_coordinate_that_stands_still_is_named() {
        let (points, readings_t) = raster();
        assert_eq!(StillPositions::among(&points, &readings_t), None);
        for axis in [Axis::X, Axis::Y] {
            let mut logged = points.clone();
            logged[12..].iter_mut().for_each(|at| at[axis.index()] = points[12][axis.index()]);
            let found = StillPositions::among(&logged, &readings_t).expect("readings contradict each other");
            assert_eq!(found.still, Some((axis, 12)), "{found}");
        }
    }

    #[test]
    fn repeated_scans_and_single_moves_do_not_contradict_each_other() {
        let (points, readings_t) = raster();
        let twice = |readings_t: &[DVec3]| [readings_t, readings_t].concat();
        assert_eq!(StillPositions::among(&twice(&points), &twice(&readings_t)), None);
        // Fewer than half of the repeated readings are wild.
        let mut wild_t = twice(&readings_t);
        wild_t[40..50].fill(DVec3::splat(50.0));
        assert_eq!(StillPositions::among(&twice(&points), &wild_t), None);
        // The film was moved between two scans: no coordinate stands still.
        let moved_t = [readings_t.clone(), readings_t.iter().map(|of| *of + 3.0).collect()].concat();
        let found = StillPositions::among(&twice(&points), &moved_t).expect("readings contradict each other");
        assert_eq!((found.repeated, found.still), (36, None));
    }
}

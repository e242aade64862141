//! Baselines: a stored field, and the difference of another field from it.

use glam::DVec3;
use thiserror::Error;

/// Values of B at the points of a working volume, stored for comparison with later fields.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Baseline {
    /// The points, in millimetres.
    pub points: Vec<DVec3>,
    /// B at each of them, in tesla.
    pub field_t: Vec<DVec3>,
}

/// The largest difference of a field from its baseline.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct BaselineDifference {
    /// Length of the difference of the two values of B, over the length of the longer. It is 0 for
    /// equal values and at most 2.
    pub relative: f64,
    /// The first point with that difference, in millimetres.
    #[cfg_attr(feature = "serde", serde(rename = "at_mm"))]
    pub at: DVec3,
}

/// The reason why a field and a baseline cannot be compared: their points differ.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum PointsMismatch {
    /// The numbers of points differ.
    #[error("the baseline has {baseline} points and the working volume {volume}, must have the same")]
    Count {
        /// Number of points of the baseline.
        baseline: usize,
        /// Number of points of the working volume.
        volume: usize,
    },
    /// A point differs.
    #[error(
        "point {} of the baseline is ({}, {}, {}) mm and of the working volume ({}, {}, {}) mm, must be the same",
        index + 1, baseline.x, baseline.y, baseline.z, volume.x, volume.y, volume.z
    )]
    Point {
        /// Index of the point, from 0.
        index: usize,
        /// The point of the baseline, in millimetres.
        baseline: DVec3,
        /// The point of the working volume, in millimetres.
        volume: DVec3,
    },
}

impl Baseline {
    /// The largest difference of a field from the baseline. `field_t` is in tesla, at `points` in
    /// millimetres.
    ///
    /// # Accuracy
    /// Round-off of a few times 1e-16 of the longer value of B.
    ///
    /// # Errors
    /// If the points differ from the points of the baseline in order or in any digit.
    ///
    /// # Panics
    /// If `field_t` does not have one value per point, or the baseline does not.
    pub fn difference(
        &self,
        points: impl ExactSizeIterator<Item = DVec3>,
        field_t: &[DVec3],
    ) -> Result<BaselineDifference, PointsMismatch> {
        assert_eq!(points.len(), field_t.len(), "one field value per point");
        assert_eq!(self.points.len(), self.field_t.len(), "one field value per point of the baseline");
        if points.len() != self.points.len() {
            return Err(PointsMismatch::Count { baseline: self.points.len(), volume: points.len() });
        }
        let mut worst = BaselineDifference { relative: 0.0, at: DVec3::ZERO };
        for (index, (volume, &baseline)) in points.zip(&self.points).enumerate() {
            if volume != baseline {
                return Err(PointsMismatch::Point { index, baseline, volume });
            }
            let relative = relative(field_t[index], self.field_t[index]);
            if relative > worst.relative {
                worst = BaselineDifference { relative, at: volume };
            }
        }
        Ok(worst)
    }
}

fn relative(one: DVec3, other: DVec3) -> f64 {
    // Scaled so that squares neither overflow nor underflow.
    let largest = one.abs().max_element().max(other.abs().max_element());
    if largest == 0.0 {
        return 0.0;
    }
    let (one, other) = (one / largest, other / largest);
    one.distance(other) / one.length().max(other.length())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn baseline(field_t: &[DVec3]) -> Baseline {
        let points = (0..field_t.len()).map(|i| DVec3::new(i as f64, 0.0, -1.0)).collect();
        Baseline { points, field_t: field_t.to_vec() }
    }

    fn difference(now: &[DVec3], before: &[DVec3]) -> BaselineDifference {
        let baseline = baseline(before);
        baseline.difference(baseline.points.clone().into_iter(), now).unwrap()
    }

    /// The point with the larger difference in tesla is not the worst, because differences are
    /// relative to |B|.
    #[test]
    fn worst_point_is_relative_to_its_own_field() {
        let before = [DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 0.0, 1e-3), DVec3::ZERO];
        let now = [DVec3::new(1.0, 1e-6, 0.0), DVec3::new(1e-8, 0.0, 1e-3), DVec3::ZERO];
        let found = difference(&now, &before);
        assert!((found.relative - 1e-5).abs() < 1e-12, "{found:?}");
        assert_eq!(found.at.x, 1.0);
        assert_eq!(difference(&before, &before).relative, 0.0);
    }

    /// The first of points with the same difference is reported.
    #[test]
    fn difference_is_divided_by_the_longer_value() {
        let short = DVec3::new(3.0, 4.0, 0.0);
        let found = difference(&[short, 2.0 * short, short], &[short, short, 2.0 * short]);
        assert_eq!((found.relative, found.at.x), (0.5, 1.0));
    }

    #[test]
    fn difference_is_finite_for_zero_and_extreme_fields() {
        assert_eq!(difference(&[DVec3::X], &[DVec3::ZERO]).relative, 1.0);
        assert_eq!(difference(&[1e-200 * DVec3::X], &[-1e-200 * DVec3::X]).relative, 2.0);
        assert_eq!(difference(&[1e300 * DVec3::X], &[1e-300 * DVec3::Y]).relative, 1.0);
    }

    #[test]
    fn different_points_are_an_error() {
        let baseline = baseline(&[DVec3::X, DVec3::X]);
        let fewer = baseline.difference([DVec3::ZERO].into_iter(), &[DVec3::X]);
        assert_eq!(fewer, Err(PointsMismatch::Count { baseline: 2, volume: 1 }));
        let mut points = baseline.points.clone();
        points[1].z = f64::next_up(-1.0);
        let moved = baseline.difference(points.iter().copied(), &[DVec3::X; 2]).unwrap_err();
        assert!(moved.to_string().starts_with("point 2 of the baseline is (1, 0, -1) mm and"), "{moved}");
    }
}

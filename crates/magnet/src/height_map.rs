//! Heights over a grid of points of a plane.

use std::error::Error;
use std::fmt;

use glam::DVec3;

/// Heights z(x, y) on a grid, interpolated by cubic polynomials with continuous slopes
/// (Catmull-Rom).
#[derive(Clone, Debug, PartialEq)]
pub struct HeightMap {
    x: Vec<f64>,
    y: Vec<f64>,
    /// y fastest.
    heights: Vec<f64>,
}

/// An invalid height map. Coordinates must ascend, at least two along each axis, and each pair must
/// have one finite height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvalidHeightMap;

/// The reason why points are no height map.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum HeightMapError {
    /// The number of points differs from the number of pairs of coordinates.
    NoGrid {
        /// Number of points.
        points: usize,
        /// Number of coordinates along x.
        x: usize,
        /// Number of coordinates along y.
        y: usize,
    },
    /// A point has the x and y of an earlier one.
    Repeated {
        /// Its index.
        point: usize,
    },
    /// The numbers are no height map.
    Invalid(InvalidHeightMap),
}

impl HeightMap {
    /// The map of points on a full grid, in any order. Their z are the heights.
    ///
    /// # Errors
    /// See [`HeightMapError`].
    pub fn from_points(points: &[DVec3]) -> Result<HeightMap, HeightMapError> {
        let coordinates = |axis: usize| -> Vec<f64> {
            let mut values: Vec<f64> = points.iter().map(|point| point[axis]).collect();
            values.sort_by(f64::total_cmp);
            values.dedup();
            values
        };
        let (x, y) = (coordinates(0), coordinates(1));
        let index = |values: &[f64], value: f64| values.partition_point(|known| *known < value);
        // A full grid has as many points as pairs of coordinates, each once.
        if x.len().checked_mul(y.len()) != Some(points.len()) {
            return Err(HeightMapError::NoGrid { points: points.len(), x: x.len(), y: y.len() });
        }
        let mut heights = vec![f64::NAN; points.len()];
        for (number, point) in points.iter().enumerate() {
            let height = &mut heights[index(&x, point.x) * y.len() + index(&y, point.y)];
            if !height.is_nan() {
                return Err(HeightMapError::Repeated { point: number });
            }
            *height = point.z;
        }
        HeightMap::new(x, y, heights).map_err(HeightMapError::Invalid)
    }

    /// The map with these coordinates and heights, y fastest.
    ///
    /// # Errors
    /// [`InvalidHeightMap`].
    pub fn new(x: Vec<f64>, y: Vec<f64>, heights: Vec<f64>) -> Result<HeightMap, InvalidHeightMap> {
        let ascends = |of: &[f64]| {
            of.len() >= 2 && of.iter().all(|c| c.is_finite()) && of.windows(2).all(|pair| pair[0] < pair[1])
        };
        let has_all = heights.len() == x.len() * y.len() && heights.iter().all(|height| height.is_finite());
        if ascends(&x) && ascends(&y) && has_all { Ok(HeightMap { x, y, heights }) } else { Err(InvalidHeightMap) }
    }

    /// The height at a point, and its slopes along x and y. `None` outside the grid.
    pub fn at(&self, x: f64, y: f64) -> Option<(f64, [f64; 2])> {
        let along_x = Weights::new(&self.x, x)?;
        let along_y = Weights::new(&self.y, y)?;
        let height = |i: usize, j: usize| self.heights[i * self.y.len() + j];
        let sum = |of_x: &[f64; 4], of_y: &[f64; 4]| -> f64 {
            let pairs = (0..along_x.count).flat_map(|i| (0..along_y.count).map(move |j| (i, j)));
            pairs.map(|(i, j)| of_x[i] * of_y[j] * height(along_x.first + i, along_y.first + j)).sum()
        };
        let slopes = [sum(&along_x.slopes, &along_y.values), sum(&along_x.values, &along_y.slopes)];
        Some((sum(&along_x.values, &along_y.values), slopes))
    }
}

/// The weights of up to four neighbouring values in the value and in the slope between two of them.
struct Weights {
    first: usize,
    count: usize,
    values: [f64; 4],
    slopes: [f64; 4],
}

impl Weights {
    fn new(at: &[f64], x: f64) -> Option<Weights> {
        if !(x >= at[0] && x <= at[at.len() - 1]) {
            return None;
        }
        // The interval from `low` to `low + 1`.
        let low = at.partition_point(|coordinate| *coordinate <= x).clamp(1, at.len() - 1) - 1;
        let first = low.saturating_sub(1);
        let count = (low + 3).min(at.len()) - first;
        let width = at[low + 1] - at[low];
        let t = (x - at[low]) / width;
        let (t2, t3) = (t * t, t * t * t);
        let hermite = [2.0 * t3 - 3.0 * t2 + 1.0, t3 - 2.0 * t2 + t, -2.0 * t3 + 3.0 * t2, t3 - t2];
        let slope = [6.0 * t2 - 6.0 * t, 3.0 * t2 - 4.0 * t + 1.0, -6.0 * t2 + 6.0 * t, 3.0 * t2 - 2.0 * t];
        let mut weights = Weights { first, count, values: [0.0; 4], slopes: [0.0; 4] };
        for (end, [value, tangent]) in [(low, [0, 1]), (low + 1, [2, 3])] {
            weights.values[end - first] += hermite[value];
            weights.slopes[end - first] += slope[value] / width;
            // The slope at a point is the slope of the parabola through it and its neighbours; at
            // an end, the slope of the first interval.
            for (index, weight) in derivative(at, end) {
                weights.values[index - first] += hermite[tangent] * width * weight;
                weights.slopes[index - first] += slope[tangent] * weight;
            }
        }
        Some(weights)
    }
}

/// The slope at a point of the grid as a sum of values with weights.
fn derivative(at: &[f64], index: usize) -> Vec<(usize, f64)> {
    if index == 0 || index + 1 == at.len() {
        let low = index.min(at.len() - 2);
        let width = at[low + 1] - at[low];
        return vec![(low, -1.0 / width), (low + 1, 1.0 / width)];
    }
    let (before, after) = (at[index] - at[index - 1], at[index + 1] - at[index]);
    let both = before + after;
    vec![
        (index - 1, -after / (before * both)),
        (index, (after - before) / (before * after)),
        (index + 1, before / (after * both)),
    ]
}

impl fmt::Display for HeightMapError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            HeightMapError::NoGrid { points, x, y } => {
                write!(f, "has {points} heights at {x} x and {y} y, must have one for each pair")
            }
            HeightMapError::Repeated { point } => write!(f, "point {point} has the x and y of an earlier one"),
            HeightMapError::Invalid(error) => error.fmt(f),
        }
    }
}

impl Error for HeightMapError {}

impl fmt::Display for InvalidHeightMap {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("heights must be a full grid of finite numbers, with two points at least along x and y")
    }
}

impl Error for InvalidHeightMap {}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slopes of parabolas are exact inside, and so are the values between such slopes.
    #[test]
    fn parabolas_are_exact_within() {
        let x = vec![-3.0, -2.0, -0.5, 0.0, 1.5, 2.0, 4.0];
        let y = vec![-1.0, 0.0, 2.0, 2.5, 4.0];
        let z = |x: f64, y: f64| 0.3 + 0.1 * x - 0.2 * y + 0.05 * x * x - 0.03 * x * y + 0.01 * y * y;
        let heights = x.iter().flat_map(|x| y.iter().map(|y| z(*x, *y))).collect();
        let map = HeightMap::new(x, y, heights).unwrap();
        for (x, y) in [(-1.9, 0.1), (0.0, 2.2), (1.7, 0.0), (-0.5, 2.4), (1.99, 1.0)] {
            let (height, [by_x, by_y]) = map.at(x, y).unwrap();
            assert!((height - z(x, y)).abs() < 1e-14, "{x}, {y}: {height}");
            assert!((by_x - (0.1 + 0.1 * x - 0.03 * y)).abs() < 1e-14, "{x}, {y}: {by_x}");
            assert!((by_y - (-0.2 - 0.03 * x + 0.02 * y)).abs() < 1e-14, "{x}, {y}: {by_y}");
        }
        // The corners are values of the grid.
        assert!((map.at(4.0, 4.0).unwrap().0 - z(4.0, 4.0)).abs() < 1e-14);
        assert!((map.at(-3.0, -1.0).unwrap().0 - z(-3.0, -1.0)).abs() < 1e-14);
        assert_eq!((map.at(4.1, 0.0), map.at(0.0, -1.1), map.at(f64::NAN, 0.0)), (None, None, None));
    }

    #[test]
    fn two_points_along_an_axis_are_a_plane() {
        let map = HeightMap::new(vec![0.0, 2.0], vec![0.0, 1.0], vec![0.0, 3.0, 4.0, 7.0]).unwrap();
        let (height, slopes) = map.at(0.5, 0.25).unwrap();
        assert!((height - 1.75).abs() < 1e-14 && (slopes[0] - 2.0).abs() < 1e-14 && (slopes[1] - 3.0).abs() < 1e-14);
    }

    #[test]
    fn grids_that_do_not_ascend_are_refused() {
        let of = |x: &[f64], heights: &[f64]| HeightMap::new(x.to_vec(), vec![0.0, 1.0], heights.to_vec());
        for (x, heights) in [
            (&[0.0][..], &[0.0, 1.0][..]),
            (&[0.0, 0.0], &[0.0; 4]),
            (&[1.0, 0.0], &[0.0; 4]),
            (&[0.0, 1.0], &[0.0; 3]),
            (&[0.0, f64::INFINITY], &[0.0; 4]),
            (&[0.0, 1.0], &[0.0, 1.0, f64::NAN, 0.0]),
        ] {
            assert_eq!(of(x, heights), Err(InvalidHeightMap));
        }
    }
}

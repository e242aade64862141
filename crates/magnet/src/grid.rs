//! Regular grids of points.

use std::fmt;
use std::ops::Range;

use glam::DVec3;

/// A regular grid from `lower` to `upper`, both included.
///
/// Points are numbered with z fastest and x slowest. An axis with one point has it at `lower`.
///
/// # Example
/// ```
/// use glam::DVec3;
/// use magsplice_magnet::Grid;
///
/// // The published working volume, in mm: 9 x 9 x 5 points, 0.5 mm apart.
/// let grid = Grid::new(DVec3::new(-2.0, -2.0, -5.0), DVec3::new(2.0, 2.0, -3.0), [9, 9, 5])?;
/// assert_eq!(grid.len(), 405);
/// assert_eq!(grid.point(1), DVec3::new(-2.0, -2.0, -4.5));
/// # Ok::<(), magsplice_magnet::GridFault>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "UncheckedGrid"))]
pub struct Grid {
    lower: DVec3,
    upper: DVec3,
    counts: [usize; 3],
}

/// A deserialized grid, before [`Grid::new`] checks it.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct UncheckedGrid {
    lower: DVec3,
    upper: DVec3,
    counts: [usize; 3],
}

#[cfg(feature = "serde")]
impl TryFrom<UncheckedGrid> for Grid {
    type Error = GridFault;

    fn try_from(grid: UncheckedGrid) -> Result<Grid, GridFault> {
        Grid::new(grid.lower, grid.upper, grid.counts)
    }
}

/// A rule that a grid breaks. Axes are 0, 1, 2 for x, y, z.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum GridFault {
    /// An axis has no points.
    NoPoints {
        /// The axis.
        axis: usize,
    },
    /// The number of points is more than an index can hold.
    TooManyPoints {
        /// Points along x, y, z.
        counts: [usize; 3],
    },
    /// A bound is not a finite number.
    NotFinite {
        /// The axis.
        axis: usize,
        /// The bound.
        value: f64,
    },
}

impl Grid {
    /// The corners of the smallest box around points; without points, the origin.
    ///
    /// # Panics
    /// If a coordinate is not finite.
    pub fn around(points: &[DVec3]) -> Grid {
        let lower = points.iter().copied().reduce(DVec3::min).unwrap_or_default();
        let upper = points.iter().copied().reduce(DVec3::max).unwrap_or_default();
        let counts = [0, 1, 2].map(|axis| if lower[axis] < upper[axis] { 2 } else { 1 });
        Grid::new(lower, upper, counts).expect("points must be finite")
    }

    /// A grid of `counts` points along x, y, z.
    ///
    /// # Errors
    /// If an axis has no points, the points cannot be counted, or a bound is not finite.
    pub fn new(lower: DVec3, upper: DVec3, counts: [usize; 3]) -> Result<Grid, GridFault> {
        if let Some(axis) = counts.iter().position(|&count| count == 0) {
            return Err(GridFault::NoPoints { axis });
        }
        let len = counts.iter().try_fold(1_usize, |len, &count| len.checked_mul(count));
        if len.is_none_or(|len| len > isize::MAX as usize) {
            return Err(GridFault::TooManyPoints { counts });
        }
        for axis in 0..3 {
            if let Some(value) = [lower[axis], upper[axis]].into_iter().find(|value| !value.is_finite()) {
                return Err(GridFault::NotFinite { axis, value });
            }
        }
        Ok(Grid { lower, upper, counts })
    }

    /// First point along every axis.
    pub fn lower(&self) -> DVec3 {
        self.lower
    }

    /// Last point along every axis.
    pub fn upper(&self) -> DVec3 {
        self.upper
    }

    /// Number of points along x, y, z; at least one each.
    pub fn counts(&self) -> [usize; 3] {
        self.counts
    }

    /// Number of points, at least one.
    #[expect(clippy::len_without_is_empty, reason = "a grid has points")]
    pub fn len(&self) -> usize {
        self.counts.iter().product()
    }

    /// Number of points in each plane normal to `axis`, at least one.
    ///
    /// # Panics
    /// If `axis` is not 0, 1 or 2.
    pub fn plane_len(&self, axis: usize) -> usize {
        self.len() / self.counts[axis]
    }

    /// The coordinate with index `i` along `axis`, rounded once, so that a grid symmetric about 0
    /// contains 0.
    ///
    /// # Panics
    /// If `axis` is not 0, 1 or 2.
    pub fn coordinate(&self, axis: usize, i: usize) -> f64 {
        let last = self.counts[axis] - 1;
        if i == 0 {
            return self.lower[axis];
        }
        if i == last {
            return self.upper[axis];
        }
        (self.lower[axis] * (last - i) as f64 + self.upper[axis] * i as f64) / last as f64
    }

    /// Indices along x, y, z of point `index`.
    pub fn indices(&self, index: usize) -> [usize; 3] {
        let [_, ny, nz] = self.counts;
        [index / (ny * nz), index / nz % ny, index % nz]
    }

    /// The point with this index.
    pub fn point(&self, index: usize) -> DVec3 {
        let [i, j, k] = self.indices(index);
        DVec3::new(self.coordinate(0, i), self.coordinate(1, j), self.coordinate(2, k))
    }

    /// All points, z fastest.
    pub fn points(&self) -> impl ExactSizeIterator<Item = DVec3> + '_ {
        self.points_in(0..self.len()).into_iter()
    }

    /// The points with these indices, z fastest.
    ///
    /// # Panics
    /// If an index is not below the number of points.
    pub fn points_in(&self, indices: Range<usize>) -> Vec<DVec3> {
        let mut points = Vec::with_capacity(indices.len());
        if indices.is_empty() {
            return points;
        }
        assert!(indices.end <= self.len(), "indices of points of the grid");
        let [_, ny, nz] = self.counts;
        let ([i, j, k], last) = (self.indices(indices.start), self.indices(indices.end - 1));
        // Coordinates are computed once, because each takes a division.
        let along = |axis: usize, first: usize, is_one_row: bool| {
            let range = if is_one_row { first..last[axis] + 1 } else { 0..self.counts[axis] };
            (range.start, range.map(|index| self.coordinate(axis, index)).collect::<Vec<f64>>())
        };
        let (first_y, y) = along(1, j, i == last[0]);
        let (first_z, z) = along(2, k, [i, j] == [last[0], last[1]]);
        let (mut row, mut from) = ([i, j], k);
        while points.len() < indices.len() {
            let x = self.coordinate(0, row[0]);
            while row[1] < ny && points.len() < indices.len() {
                let y = y[row[1] - first_y];
                let count = (nz - from).min(indices.len() - points.len());
                points.extend(z[from - first_z..from - first_z + count].iter().map(|&z| DVec3::new(x, y, z)));
                (row[1], from) = (row[1] + 1, 0);
            }
            row = [row[0] + 1, 0];
        }
        points
    }
}

impl fmt::Display for GridFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            GridFault::NoPoints { axis } => write!(f, "counts[{axis}] = 0, must be at least 1"),
            GridFault::TooManyPoints { counts: [x, y, z] } => {
                write!(f, "counts = {x} x {y} x {z}, must be no more points than memory can hold")
            }
            GridFault::NotFinite { axis, value } => {
                write!(f, "bound of axis {axis} = {value}, must be a finite number")
            }
        }
    }
}

impl std::error::Error for GridFault {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_rounded_once() {
        let grid = Grid::new(DVec3::splat(-2.0), DVec3::splat(2.0), [41, 41, 1]).unwrap();
        let x: Vec<f64> = (0..41).map(|i| grid.coordinate(0, i)).collect();
        assert_eq!((x[0], x[1], x[7], x[20], x[40]), (-2.0, -1.9, -1.3, 0.0, 2.0));
        let off = Grid::new(DVec3::splat(0.1), DVec3::splat(1.1), [4; 3]).unwrap();
        assert_eq!((off.coordinate(0, 0), off.coordinate(0, 3)), (0.1, 1.1));
        assert_eq!(grid.points().len(), 41 * 41);
        assert_eq!(grid.point(42), DVec3::new(-1.9, -1.9, -2.0));
    }

    #[test]
    fn grids_without_points_or_bounds_are_refused() {
        let refused = |upper, counts| Grid::new(DVec3::ZERO, upper, counts).unwrap_err();
        assert_eq!(refused(DVec3::ONE, [2, 0, 2]), GridFault::NoPoints { axis: 1 });
        assert_eq!(refused(DVec3::ONE, [usize::MAX, 2, 1]), GridFault::TooManyPoints { counts: [usize::MAX, 2, 1] });
        let infinite = DVec3::new(1.0, 1.0, f64::INFINITY);
        assert_eq!(refused(infinite, [2; 3]), GridFault::NotFinite { axis: 2, value: f64::INFINITY });
    }

    #[test]
    fn points_are_those_of_their_indices() {
        for counts in [[3, 4, 5], [1, 2, 1], [2, 1, 3], [1, 1, 1]] {
            let grid = Grid::new(DVec3::new(-1.0, 0.3, -5.0), DVec3::new(1.0, 0.9, -3.0), counts).unwrap();
            let points: Vec<DVec3> = grid.points().collect();
            let by_index: Vec<DVec3> = (0..grid.len()).map(|index| grid.point(index)).collect();
            assert_eq!(points, by_index);
        }
    }

    #[test]
    fn points_of_any_range_are_the_points_of_its_indices() {
        for counts in [[2, 3, 4], [4, 1, 1], [1, 4, 1], [3, 1, 2], [1, 1, 5]] {
            let grid = Grid::new(DVec3::new(0.1, -2.0, 3.0), DVec3::new(1.3, 2.0, 4.0), counts).unwrap();
            for start in 0..=grid.len() {
                for end in start..=grid.len() {
                    let by_index: Vec<DVec3> = (start..end).map(|index| grid.point(index)).collect();
                    assert_eq!(grid.points_in(start..end), by_index, "{counts:?} {start} {end}");
                }
            }
        }
    }
}

//! Regular grids of points.

use glam::DVec3;

/// A regular grid from `lower` to `upper`, both included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// First point along every axis.
    pub lower: DVec3,
    /// Last point along every axis.
    pub upper: DVec3,
    /// Number of points along x, y, z; an axis with one point has it at `lower`.
    pub counts: [usize; 3],
}

impl Grid {
    /// Number of points.
    pub fn len(&self) -> usize {
        self.counts.iter().product()
    }

    /// Whether the grid has no points.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The coordinate with index `i` along `axis`, rounded once: a grid symmetric about 0 contains 0.
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

    /// Indices along x, y, z of point `index`; z runs fastest, x slowest.
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
        (0..self.len()).map(|index| self.point(index))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_the_decimals_meant() {
        let grid = Grid { lower: DVec3::splat(-2.0), upper: DVec3::splat(2.0), counts: [41, 41, 1] };
        let x: Vec<f64> = (0..41).map(|i| grid.coordinate(0, i)).collect();
        assert_eq!((x[0], x[1], x[7], x[20], x[40]), (-2.0, -1.9, -1.3, 0.0, 2.0));
        let off = Grid { lower: DVec3::splat(0.1), upper: DVec3::splat(1.1), counts: [4; 3] };
        assert_eq!((off.coordinate(0, 0), off.coordinate(0, 3)), (0.1, 1.1));
        assert_eq!(grid.points().len(), 41 * 41);
        assert_eq!(grid.point(42), DVec3::new(-1.9, -1.9, -2.0));
    }
}

//! The positions of a scan: the grid, missing positions and repeated positions.

use std::collections::HashSet;

use glam::DVec3;

/// Largest difference of equal coordinates, as a fraction of the extent along the axis.
const SAME_COORDINATE: f64 = 1e-6;

/// Smallest share of the positions of a grid in a scan that counts as this grid with gaps.
const LEAST_FILLED: f64 = 0.5;

/// The positions of a scan.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ScanPositions {
    /// Number of positions along x, y, z, if they form a grid, possibly with gaps.
    pub grid: Option<[usize; 3]>,
    /// Positions of the grid without a reading, z fastest.
    pub missing: Vec<DVec3>,
    /// Indices of the readings at the position of an earlier reading.
    pub repeated: Vec<usize>,
}

impl ScanPositions {
    /// The positions of readings. Two are equal if they differ by at most a millionth of the extent
    /// along each axis. They form a grid if at least half of its positions have a reading.
    pub fn new(points: &[DVec3]) -> ScanPositions {
        let coordinates: [Vec<f64>; 3] = std::array::from_fn(|axis| {
            let mut values: Vec<f64> = points.iter().map(|point| point[axis]).collect();
            values.sort_by(f64::total_cmp);
            let extent = values.last().unwrap_or(&0.0) - values.first().unwrap_or(&0.0);
            values.dedup_by(|a, b| (*a - *b).abs() <= SAME_COORDINATE * extent);
            values
        });
        // The smallest of equal coordinates represents them.
        let cell = |point: &DVec3| -> [usize; 3] {
            std::array::from_fn(|axis| {
                coordinates[axis].partition_point(|value| *value <= point[axis]).saturating_sub(1)
            })
        };
        let mut visited: HashSet<[usize; 3]> = HashSet::new();
        let repeated = (0..points.len()).filter(|index| !visited.insert(cell(&points[*index]))).collect();
        let counts = [0, 1, 2].map(|axis| coordinates[axis].len());
        let cells = counts.iter().try_fold(1_usize, |product, count| product.checked_mul(*count));
        let is_grid = cells.is_some_and(|cells| visited.len() as f64 >= LEAST_FILLED * cells as f64);
        let mut missing = Vec::new();
        if is_grid {
            let [x, y, z] = &coordinates;
            for (i, x) in x.iter().enumerate() {
                for (j, y) in y.iter().enumerate() {
                    let absent = z.iter().enumerate().filter(|(k, _)| !visited.contains(&[i, j, *k]));
                    missing.extend(absent.map(|(_, z)| DVec3::new(*x, *y, *z)));
                }
            }
        }
        ScanPositions { grid: is_grid.then_some(counts), missing, repeated }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_and_repeated_positions_of_a_grid_are_found() {
        let mut points: Vec<DVec3> =
            (0..12).map(|n| DVec3::new(f64::from(n / 4), f64::from(n / 2 % 2), f64::from(n % 2))).collect();
        points.remove(5);
        // Equal to the position before, to round-off.
        points.insert(3, points[2] + 1e-9);
        let found = ScanPositions::new(&points);
        assert_eq!((found.grid, found.repeated), (Some([3, 2, 2]), vec![3]));
        assert_eq!(found.missing, [DVec3::new(1.0, 0.0, 1.0)]);
    }

    #[test]
    fn positions_on_a_line_across_the_axes_are_no_grid() {
        let points: Vec<DVec3> = (0..5).map(|n| DVec3::splat(f64::from(n))).collect();
        let found = ScanPositions::new(&points);
        assert_eq!(found, ScanPositions { grid: None, missing: vec![], repeated: vec![] });
    }
}

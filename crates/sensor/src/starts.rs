//! Starting points of the search for a position: points of the volume whose field is nearest to the
//! reading.

use glam::DVec3;
use magsplice_magnet::Grid;

/// Largest number of starting points of one reading. A reading near many separate points is
/// ambiguous after two of them.
const MOST_STARTS: usize = 8;

/// Number of further starting points of a thorough search, the nearest to the reading. In narrow
/// valleys between points none of them is lower than its neighbours.
const NEAREST: usize = 24;

/// The points of a grid whose field is nearest to the reading among their neighbours, nearest
/// first; in a `thorough` search also the nearest of all others. A point without a field, which is
/// NaN, is none of them.
///
/// The squared difference of the field and the reading has a minimum at each position with this
/// reading. On a grid on which the field is nearly linear from point to point, one of the points
/// around the position is lower than its neighbours.
pub(crate) fn starts(grid: &Grid, field_t: &[DVec3], reading_t: DVec3, thorough: bool) -> Vec<DVec3> {
    let distance_to =
        |field: &DVec3| if field.is_finite() { (*field - reading_t).length_squared() } else { f64::INFINITY };
    let distance: Vec<f64> = field_t.iter().map(distance_to).collect();
    let counts = grid.counts();
    let strides = [counts[1] * counts[2], counts[2], 1];
    let nearer = |a: &usize, b: &usize| distance[*a].total_cmp(&distance[*b]);
    let is_field = |index: &usize| distance[*index] < f64::INFINITY;
    let mut lowest: Vec<usize> = (0..distance.len())
        .filter(is_field)
        .filter(|&index| {
            let at = grid.indices(index);
            // Neighbours along the axes. A point as low as its neighbour counts.
            (0..3).all(|axis| {
                let below = at[axis] > 0 && distance[index - strides[axis]] < distance[index];
                let above = at[axis] + 1 < counts[axis] && distance[index + strides[axis]] < distance[index];
                !below && !above
            })
        })
        .collect();
    lowest.sort_by(nearer);
    lowest.truncate(MOST_STARTS);
    if thorough {
        let mut others: Vec<usize> = (0..distance.len()).filter(is_field).filter(|of| !lowest.contains(of)).collect();
        let count = NEAREST.min(others.len());
        if count < others.len() {
            others.select_nth_unstable_by(count, nearer);
        }
        others.truncate(count);
        others.sort_by(nearer);
        lowest.extend(others);
    }
    lowest.into_iter().map(|index| grid.point(index)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Along x two points are lower than their neighbours, one of them beside points without a
    /// field. A thorough search adds the others, nearest to the reading first; here, all 18.
    #[test]
    fn searches_start_where_the_field_is_nearest_among_neighbours() {
        const ALONG_X: [f64; 6] = [3.0, 1.0, 3.0, 4.0, 0.5, f64::NAN];
        let grid = Grid::new(DVec3::ZERO, DVec3::new(5.0, 1.0, 1.0), [6, 2, 2]).unwrap();
        let field_t: Vec<DVec3> = grid.points().map(|point| DVec3 { x: ALONG_X[point.x as usize], ..point }).collect();
        let lowest = [DVec3::new(4.0, 0.0, 0.0), DVec3::new(1.0, 0.0, 0.0)];
        assert_eq!(starts(&grid, &field_t, DVec3::ZERO, false), lowest);
        let all = starts(&grid, &field_t, DVec3::ZERO, true);
        assert_eq!(all[..2], lowest);
        assert_eq!(all.len(), 20);
        let distance = |point: &DVec3| ALONG_X[point.x as usize].hypot(point.y).hypot(point.z);
        assert!(all[2..].is_sorted_by(|a, b| distance(a) <= distance(b) + 1e-12), "{all:?}");
    }
}

//! Starting points of the search for a position: points of the volume whose field is nearest to the
//! reading.

use glam::DVec3;
use magsplice_magnet::Grid;

/// Largest number of starting points of one reading. A reading near many separate points is
/// ambiguous after two of them.
const MOST_STARTS: usize = 8;

/// The points of a grid whose field is nearest to the reading among their neighbours, nearest
/// first.
///
/// The squared difference of the field and the reading has a minimum at each position with this
/// reading. On a grid on which the field is nearly linear from point to point, one of the points
/// around the position is lower than its neighbours.
pub(crate) fn starts(grid: &Grid, field_t: &[DVec3], reading_t: DVec3) -> Vec<DVec3> {
    let distance: Vec<f64> = field_t.iter().map(|field| (*field - reading_t).length_squared()).collect();
    let counts = grid.counts();
    let strides = [counts[1] * counts[2], counts[2], 1];
    let mut lowest: Vec<usize> = (0..distance.len())
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
    lowest.sort_by(|a, b| distance[*a].total_cmp(&distance[*b]));
    lowest.truncate(MOST_STARTS);
    lowest.into_iter().map(|index| grid.point(index)).collect()
}

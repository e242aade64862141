//! One coordinate for faces that differ by round-off.
//!
//! Tiles have centres and sizes, and `position + size / 2` of one need not round to `position -
//! size / 2` of the tile that touches it. A point between the two numbers would belong to both
//! tiles or to none. Faces within a few units of round-off of each other therefore get one
//! coordinate, which moves each face by at most these units.

use magsplice_simd::compensated_sum::TwoSum;

/// A face, given by its coordinate along its normal.
pub(super) struct Plane {
    pub coordinate: TwoSum,
    /// Largest distance of the coordinate from the intended coordinate.
    pub tolerance: f64,
    /// Frame, block, axis of the frame, and 0 for the lower or 1 for the upper face.
    pub place: [usize; 4],
}

impl Plane {
    fn owner(&self) -> [usize; 2] {
        [self.place[0], self.place[1]]
    }
}

/// The faces that move, with their new coordinates.
pub(super) fn joined(mut planes: Vec<Plane>) -> Vec<(TwoSum, [usize; 4])> {
    planes.sort_by(|a, b| a.coordinate.value().total_cmp(&b.coordinate.value()));
    let apart = |a: &Plane, b: &Plane| b.coordinate.minus(a.coordinate).value() > a.tolerance.max(b.tolerance);
    let mut moves = Vec::new();
    for cluster in planes.chunk_by(|a, b| !apart(a, b)) {
        // A tile thinner than the tolerance keeps its faces, because its thickness is data.
        let mut owners: Vec<[usize; 2]> = cluster.iter().map(Plane::owner).collect();
        owners.sort_unstable();
        let sliver =
            |p: &&Plane| owners.partition_point(|o| *o <= p.owner()) - owners.partition_point(|o| *o < p.owner()) > 1;
        let whole: Vec<&Plane> = cluster.iter().filter(|p| !sliver(p)).collect();
        if let Some(common) = common_coordinate(&whole) {
            moves.extend(whole.iter().map(|p| (common, p.place)));
        }
    }
    moves
}

fn common_coordinate(cluster: &[&Plane]) -> Option<TwoSum> {
    let first = cluster.first()?.coordinate;
    if cluster.iter().all(|p| p.coordinate == first) {
        return None;
    }
    // The coordinate nearest to a binary64 number is most likely the intended coordinate, and
    // points can have exactly that coordinate.
    let meant = cluster.iter().map(|p| p.coordinate).min_by(|a, b| a.lo.abs().total_cmp(&b.lo.abs()))?;
    Some(TwoSum::exact(meant.hi))
}

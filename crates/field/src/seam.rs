//! Faces that are meant to be one plane become one.
//!
//! Two touching tiles are given by centres and sizes, and `position + size / 2` of the one need not round to
//! `position - size / 2` of the other. Between the two numbers a point would belong to both tiles or to none. Faces within a
//! few units of round-off of each other are therefore given one coordinate, which moves no face by more than that.

use crate::two_sum::TwoSum;

/// A face as a coordinate along its normal.
pub(crate) struct Plane {
    pub(crate) coordinate: TwoSum,
    /// How far the number may be from what was meant.
    pub(crate) tolerance: f64,
    /// Which face it is: frame, block, axis of the frame, lower or upper.
    pub(crate) place: [usize; 4],
}

/// The faces that move, with their new coordinates.
pub(crate) fn joined(mut planes: Vec<Plane>) -> Vec<(TwoSum, [usize; 4])> {
    planes.sort_by(|a, b| a.coordinate.value().total_cmp(&b.coordinate.value()));
    let mut moves = Vec::new();
    let mut rest = planes.as_slice();
    while let Some(first) = rest.first() {
        let near = |p: &&Plane| p.coordinate.minus(first.coordinate).value() <= p.tolerance.min(first.tolerance);
        let (cluster, others) = rest.split_at(rest.iter().take_while(near).count().max(1));
        rest = others;
        if let Some(common) = common_coordinate(cluster) {
            moves.extend(cluster.iter().map(|p| (common, p.place)));
        }
    }
    moves
}

fn common_coordinate(cluster: &[Plane]) -> Option<TwoSum> {
    let first = cluster.first()?.coordinate;
    if cluster.iter().all(|p| p.coordinate == first) {
        return None;
    }
    // A tile thinner than the tolerance keeps its faces apart: its thickness is data.
    let mut owners: Vec<&[usize]> = cluster.iter().map(|p| &p.place[..2]).collect();
    owners.sort_unstable();
    if owners.windows(2).any(|pair| pair[0] == pair[1]) {
        return None;
    }
    // The one nearest to a binary64 number is most likely what was meant, and points can lie on that number exactly.
    let meant = cluster.iter().map(|p| p.coordinate).min_by(|a, b| a.lo.abs().total_cmp(&b.lo.abs()))?;
    Some(TwoSum::exact(meant.hi))
}

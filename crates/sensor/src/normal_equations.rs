//! The normal equations of the fit of a head.

use glam::DVec3;
use nalgebra::{SMatrix, SVector};

use crate::head_fit::HeadUnknowns;

/// Most numbers that are fitted, in this order: position, stray field, rotation.
pub(crate) const MOST: usize = HeadUnknowns::Pose.count();

pub(crate) type Normal = SMatrix<f64, MOST, MOST>;
pub(crate) type Step = SVector<f64, MOST>;

/// Smallest eigenvalue of the normal matrix, scaled to a diagonal of 1, from which on the readings
/// determine the numbers. Round-off of the products is 1e-15.
const DETERMINED: f64 = 1e-11;

/// Three of the numbers.
pub(crate) fn part(step: &Step, from: usize) -> DVec3 {
    DVec3::new(step[from], step[from + 1], step[from + 2])
}

/// The normal matrix scaled to a diagonal of 1, with 1 for numbers that are not fitted, and the
/// scales.
fn scaled(normal: &Normal, unknowns: HeadUnknowns) -> (Normal, Step) {
    let free = unknowns.count();
    let scales = Step::from_fn(|row, _| if row < free { normal[(row, row)].sqrt() } else { 1.0 });
    let matrix = Normal::from_fn(|row, column| match (row.max(column) < free, row == column) {
        (true, _) => normal[(row, column)] / (scales[row] * scales[column]),
        (false, is_diagonal) => f64::from(u8::from(is_diagonal)),
    });
    (matrix, scales)
}

/// Standard deviations of three of the numbers.
pub(crate) fn deviations(covariance: &Normal, from: usize) -> DVec3 {
    DVec3::from([0, 1, 2].map(|axis| covariance[(from + axis, from + axis)].sqrt()))
}

/// The step of Gauss and Newton. `None` where the readings do not determine the numbers.
pub(crate) fn step(normal: &Normal, right: &Step, unknowns: HeadUnknowns) -> Option<Step> {
    let (matrix, scales) = scaled(normal, unknowns);
    let solved = matrix.cholesky()?.solve(&right.component_div(&scales));
    Some(solved.component_div(&scales))
}

/// The covariance of the numbers; 0 for those that are not fitted. `None` where the readings do not
/// determine them.
pub(crate) fn covariance(normal: &Normal, unknowns: HeadUnknowns) -> Option<Normal> {
    let (matrix, scales) = scaled(normal, unknowns);
    if matrix.symmetric_eigenvalues().min() < DETERMINED {
        return None;
    }
    let inverse = matrix.cholesky()?.inverse();
    Some(Normal::from_fn(|row, column| match row.max(column) < unknowns.count() {
        true => inverse[(row, column)] / (scales[row] * scales[column]),
        false => 0.0,
    }))
}

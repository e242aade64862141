//! The scalar product of long rows, in a fixed order of additions.

use crate::tolerances::PARTIAL_SUMS;

/// The scalar product of two rows of equal length. The order of additions does not depend on the
/// processor, so the result is bit-identical on all processors.
pub(crate) fn scalar_product(row: &[f64], j: &[f64]) -> f64 {
    let mut sums = [0.0; PARTIAL_SUMS];
    let (rows, rest) = row.as_chunks::<PARTIAL_SUMS>();
    let (js, rest_j) = j.as_chunks::<PARTIAL_SUMS>();
    for (row, j) in rows.iter().zip(js) {
        for k in 0..PARTIAL_SUMS {
            sums[k] += row[k] * j[k];
        }
    }
    for (sum, (row, j)) in sums.iter_mut().zip(rest.iter().zip(rest_j)) {
        *sum += row * j;
    }
    sums.iter().sum()
}

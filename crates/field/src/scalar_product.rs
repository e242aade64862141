//! The scalar product of long rows.

use crate::tolerances::CHAINS;

/// The scalar product, in an order that does not depend on the processor.
pub(crate) fn scalar_product(row: &[f64], j: &[f64]) -> f64 {
    let mut sums = [0.0; CHAINS];
    let (rows, rest) = row.as_chunks::<CHAINS>();
    let (js, rest_j) = j.as_chunks::<CHAINS>();
    for (row, j) in rows.iter().zip(js) {
        for chain in 0..CHAINS {
            sums[chain] += row[chain] * j[chain];
        }
    }
    for (chain, (row, j)) in rest.iter().zip(rest_j).enumerate() {
        sums[chain] += row * j;
    }
    sums.iter().sum()
}

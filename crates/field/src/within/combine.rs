//! Sums of rows with weights, in the widest vectors: what products of expansions come down to.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};

use crate::batch::lanes::{Lanes, Number};

/// Rows are filled up with zeros to multiples of this, two of the longest vectors.
const PADDING: usize = 16;

/// The room for a row of so many numbers.
pub(super) fn padded(length: usize) -> usize {
    length.next_multiple_of(PADDING)
}

/// The sum of `weights` times as many `rows` of the length of `sum`, which is one that [`padded`] gives.
pub(super) fn combine(level: Level, weights: &[f64], rows: &[f64], sum: &mut [f64]) {
    dispatch!(level, simd => weighted_sum(simd, weights, rows, sum));
}

/// See [`combine`].
#[inline(always)]
pub(super) fn weighted_sum<S: Simd>(simd: S, weights: &[f64], rows: &[f64], sum: &mut [f64]) {
    let (length, stride) = (Lanes::<S>::LEN, sum.len());
    for (number, sum) in sum.chunks_exact_mut(2 * length).enumerate() {
        let start = 2 * length * number;
        let mut sums = [Lanes::<S>::splat(simd, 0.0); 2];
        for (weight, row) in weights.iter().zip(rows.chunks_exact(stride)) {
            let row = &row[start..start + 2 * length];
            sums[0] = Lanes::<S>::load(simd, &row[..length]).scale_add(*weight, sums[0]);
            sums[1] = Lanes::<S>::load(simd, &row[length..]).scale_add(*weight, sums[1]);
        }
        sums[0].store(&mut sum[..length]);
        sums[1].store(&mut sum[length..]);
    }
}

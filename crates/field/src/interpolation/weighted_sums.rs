//! Weighted sums of rows, in the widest vectors. Sums of products of polynomials use them.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};

use magsplice_simd::lanes::{Lanes, Number};

/// Row lengths are rounded up to a multiple of two of the longest vectors; the padding is zero.
pub(super) const PADDING: usize = 16;

/// Length of a row of `length` numbers with its padding.
pub(super) fn padded(length: usize) -> usize {
    length.next_multiple_of(PADDING)
}

/// Sets `sum` to the sum of `weights` times `rows`. Each row has the [`padded`] length of `sum`.
pub(super) fn weighted_sum_at(level: Level, weights: &[f64], rows: &[f64], sum: &mut [f64]) {
    dispatch!(level, simd => weighted_sum(simd, weights, rows, sum));
}

/// [`weighted_sum_at`] inside a dispatched function.
#[inline(always)]
pub(super) fn weighted_sum<S: Simd>(simd: S, weights: &[f64], rows: &[f64], sum: &mut [f64]) {
    let (length, stride) = (Lanes::<S>::LEN, sum.len());
    let wide = sum.len() / (4 * length) * (4 * length);
    for start in (0..wide).step_by(4 * length) {
        strip::<S, 4>(simd, weights, rows, stride, start, sum);
    }
    for start in (wide..stride).step_by(2 * length) {
        strip::<S, 2>(simd, weights, rows, stride, start, sum);
    }
}

/// `N` vectors of the sum, with independent additions.
#[inline(always)]
fn strip<S: Simd, const N: usize>(
    simd: S,
    weights: &[f64],
    rows: &[f64],
    stride: usize,
    start: usize,
    sum: &mut [f64],
) {
    let length = Lanes::<S>::LEN;
    let mut sums = [Lanes::<S>::splat(simd, 0.0); N];
    // Indices instead of iterators: with cargo's default profile the iterators of zipped slices are
    // not inlined here and take half the time of a look-up.
    let mut at = start;
    for weight in weights {
        for (n, sum) in sums.iter_mut().enumerate() {
            *sum = Lanes::<S>::load(simd, &rows[at + n * length..][..length]).scale_add(*weight, *sum);
        }
        at += stride;
    }
    for (n, value) in sums.into_iter().enumerate() {
        value.store(&mut sum[start + n * length..][..length]);
    }
}

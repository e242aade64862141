//! Constant factors of the M2L operator: norms, exchanges of x and z, and translations along z
//! (docs/physics.md, section 5.2).

use std::sync::LazyLock;

use crate::local::local_index;
use crate::tolerances::{HIGHEST_DEGREE, HIGHEST_LOCAL_DEGREE};

/// Highest degree of the potentials before and after a translation.
pub(crate) const HIGHEST_POTENTIAL_DEGREE: usize =
    if HIGHEST_DEGREE > HIGHEST_LOCAL_DEGREE { HIGHEST_DEGREE } else { HIGHEST_LOCAL_DEGREE + 1 };

/// Number of output coefficients summed at the same time. Surplus coefficients of a last block are
/// zero and never read.
pub(crate) const BLOCK: usize = 4;

/// The norm ((l - m)! (l + m)!)^1/2 of each degree and order, row after row of equal degree.
///
/// Moments are multiplied by the norm and coefficients of local expansions divided by it. Rotations
/// then preserve the sum of squares of a degree.
pub(crate) static NORMS: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let mut root_factorials = vec![1.0];
    for n in 1..=2 * HIGHEST_POTENTIAL_DEGREE {
        root_factorials.push(root_factorials[n - 1] * (n as f64).sqrt());
    }
    let pairs = (0..=HIGHEST_POTENTIAL_DEGREE).flat_map(|l| (0..=l).map(move |m| (l, m)));
    pairs.map(|(l, m)| root_factorials[l - m] * root_factorials[l + m]).collect()
});

/// The norm of a degree and order.
fn norm(l: usize, m: usize) -> f64 {
    NORMS[local_index(l, m)]
}

/// Factors of the exchange of x and z (Eq. P36), by degree, for the real and the imaginary parts.
pub(crate) static EXCHANGES: LazyLock<Vec<[XzExchange; 2]>> = LazyLock::new(exchanges);

/// Factors of the exchange of x and z in the real or the imaginary parts of a degree.
///
/// Half of the factors are zero and omitted: input orders of one parity contribute to output orders
/// of one parity only.
pub(crate) struct XzExchange {
    /// By the parity of the input order: block after block of output orders, the factors of each
    /// input order.
    pub(crate) factors: [Vec<[f64; BLOCK]>; 2],
}

/// The factors of all degrees. The recurrence (Eq. P36) uses integers 2^l times as large, so it is
/// exact.
fn exchanges() -> Vec<[XzExchange; 2]> {
    let mut last: Vec<Vec<i128>> = vec![vec![1]];
    let mut exchanges = Vec::new();
    for degree in 0..=HIGHEST_POTENTIAL_DEGREE {
        if degree > 0 {
            last = next_exchange(&last);
        }
        let scale = 0.5_f64.powi(degree as i32);
        let factor = |part: usize, m: usize, to: usize| {
            let sign = if m.is_multiple_of(2) == (part == 0) { 1 } else { -1 };
            let other = if m == 0 { 0 } else { sign * last[degree - m][to] };
            (last[degree + m][to] + other) as f64 * (norm(degree, m) / norm(degree, to) * scale)
        };
        let factor = &factor;
        exchanges.push([0, 1].map(|part| XzExchange {
            factors: [0, 1].map(|parity| {
                let inputs = || (lowest_input_order(part, parity)..=degree).step_by(2);
                let blocks = (lowest_output_order(degree, part, parity)..=degree).step_by(2 * BLOCK);
                let known = move |m: usize, to: usize| if to <= degree { factor(part, m, to) } else { 0.0 };
                let from = move |m: usize, block: usize| std::array::from_fn(|k| known(m, block + 2 * k));
                blocks.flat_map(|block| inputs().map(move |m| from(m, block))).collect()
            }),
        }));
    }
    exchanges
}

/// The factors of the next degree (Eq. P36): input orders from -l to l, output orders from 0 to l.
fn next_exchange(last: &[Vec<i128>]) -> Vec<Vec<i128>> {
    let before = (last.len() / 2) as isize;
    let degree = before + 1;
    let at = |m: isize, to: isize| {
        if m.abs() > before || to > before { 0 } else { last[(m + before) as usize][to as usize] }
    };
    let new = |m: isize, to: isize| {
        if to < degree {
            at(m - 1, to) - at(m + 1, to)
        } else {
            2 * at(m, to - 1) + at(m + 1, to - 1) + at(m - 1, to - 1)
        }
    };
    (-degree..=degree).map(|m| (0..=degree).map(|to| new(m, to)).collect()).collect()
}

/// Lowest input order of a parity. Imaginary parts of order 0 are zero and omitted.
pub(crate) fn lowest_input_order(part: usize, parity: usize) -> usize {
    if part == 1 && parity == 0 { 2 } else { parity }
}

/// Lowest output order to which input orders of a parity contribute.
pub(crate) fn lowest_output_order(degree: usize, part: usize, parity: usize) -> usize {
    lowest_input_order(part, (parity + degree + part) % 2)
}

/// Factors of a translation along the z axis (Eq. P35), (-1)^(n + m) (l + n)! over both norms: by
/// order, block after block of output degrees n, the factors of each input degree l.
pub(crate) static Z_TRANSLATIONS: LazyLock<Vec<Vec<[f64; BLOCK]>>> = LazyLock::new(|| {
    let binomial = {
        let mut rows = vec![vec![1.0]];
        for n in 1..=2 * HIGHEST_POTENTIAL_DEGREE {
            let last: &Vec<f64> = &rows[n - 1];
            let at = |k: usize| if k < last.len() { last[k] } else { 0.0 };
            rows.push((0..=n).map(|k| at(k) + if k > 0 { at(k - 1) } else { 0.0 }).collect());
        }
        rows
    };
    let factor = |l: usize, n: usize, m: usize| {
        // (l + n)! over the norms is the root of the binomials (l + n)! / (l - m)! (n + m)! and
        // (l + n)! / (l + m)! (n - m)!.
        let size = (binomial[l + n][l - m] * binomial[l + n][l + m]).sqrt();
        if (n + m).is_multiple_of(2) { size } else { -size }
    };
    let factor = &factor;
    let order = |m: usize| {
        let highest = HIGHEST_LOCAL_DEGREE + 1;
        let blocks = (m.max(1)..=highest).step_by(BLOCK);
        let known = move |l: usize, n: usize| if n <= highest { factor(l, n, m) } else { 0.0 };
        let from = move |l: usize, block: usize| std::array::from_fn(|k| known(l, block + k));
        blocks.flat_map(|block| (m.max(1)..=HIGHEST_DEGREE).map(move |l| from(l, block))).collect()
    };
    (0..=HIGHEST_DEGREE.min(HIGHEST_LOCAL_DEGREE + 1)).map(order).collect()
});

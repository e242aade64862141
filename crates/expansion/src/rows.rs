//! Sums over degrees and orders of polynomials times coefficients (docs/physics.md, Eqs. P23 and
//! P24), evaluated at two vectors of points. Multipole and local expansions share them.

use std::sync::LazyLock;

use fearless_simd::prelude::*;
use magsplice_simd::lanes::{Lanes, Number};

use crate::tolerances::HIGHEST_DEGREE;

/// Highest degree of the field, one above the degree of the potential.
const FIELD_DEGREE: usize = HIGHEST_DEGREE + 1;

/// Index of the first recurrence factor of an order.
fn recurrence_start(order: usize) -> usize {
    order * (2 * FIELD_DEGREE + 3 - order) / 2
}

/// Factors of the polynomials' recurrence (Eq. P24): row after row of equal order, within a row by
/// degree, beginning at the degree of the order.
static RECURRENCE: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let mut factors = Vec::with_capacity(recurrence_start(FIELD_DEGREE + 1));
    for order in 0..=FIELD_DEGREE {
        // The factor from this degree to the next.
        for degree in order..=FIELD_DEGREE {
            let (l, m) = (degree as f64, order as f64);
            factors.push((l * l - m * m) / (4.0 * l * l - 1.0));
        }
    }
    factors
});

/// Variables of the polynomials at a vector of points: x, y, z and r^2 for a local expansion; for a
/// multipole expansion x, y and z are divided by r^2, and r^2 by r^4.
pub(crate) struct HarmonicVariables<S: Simd> {
    /// r^2, or 1 / r^2
    pub(crate) square: Lanes<S>,
    /// z, or z / r^2
    pub(crate) z: Lanes<S>,
    /// x and y, or x / r^2 and y / r^2
    pub(crate) xy: [Lanes<S>; 2],
}

/// All coefficients of a row are present.
///
/// In an expansion with a parity, nonzero coefficients of the order alternate by degree with
/// nonzero coefficients of the neighbouring orders.
pub(crate) const ALL_COEFFICIENTS: u8 = 0;
/// Coefficients alternate. The order's own begin, at the degree of the order.
pub(crate) const OWN_ORDER_FIRST: u8 = 1;
/// Coefficients alternate. The neighbouring orders' begin.
pub(crate) const NEIGHBOURS_FIRST: u8 = 2;

/// The field (Eq. P23) up to `degree` at two vectors of points. `rows` gives the coefficients of an
/// order, of the next and of the previous order, from the degree of the order on.
#[inline(always)]
pub(crate) fn fields_of_rows<'a, S: Simd, const COEFFICIENTS: u8>(
    simd: S,
    variables: &[HarmonicVariables<S>; 2],
    degree: usize,
    rows: impl Fn(usize) -> [&'a [[f64; 2]]; 3],
) -> [[Lanes<S>; 3]; 2] {
    let (zero, one) = (Lanes::<S>::splat(simd, 0.0), Lanes::<S>::splat(simd, 1.0));
    let mut phase = [[one, zero]; 2];
    let mut field = [[zero; 3]; 2];
    for order in 0..=degree {
        let count = degree + 1 - order;
        let start = recurrence_start(order);
        let factors = &RECURRENCE[start..start + count];
        let sums = row_sums::<S, COEFFICIENTS>(simd, variables, rows(order).map(|row| &row[..count]), factors);
        for at in 0..2 {
            let [own_re, own_im, above_re, above_im, below_re, below_im] = sums[at];
            let [re, im] = phase[at];
            let [x, y, z] = &mut field[at];
            if order == 0 {
                (*x, *y, *z) = (*x - above_re, *y + above_im, *z + own_re);
            } else {
                *x = (below_re - above_re).mul_add(re, (above_im - below_im).mul_add(im, *x));
                *y = (below_im + above_im).mul_add(re, (below_re + above_re).mul_add(im, *y));
                *z = own_re.mul_add(re + re, *z) - own_im * (im + im);
            }
            let [factor_x, factor_y] = variables[at].xy;
            phase[at] = [re.mul_sub(factor_x, im * factor_y), re.mul_add(factor_y, im * factor_x)];
        }
    }
    field
}

/// Sums over degrees of polynomial times coefficient, at two vectors of points. Each coefficient is
/// loaded once for both.
#[inline(always)]
fn row_sums<S: Simd, const COEFFICIENTS: u8>(
    simd: S,
    variables: &[HarmonicVariables<S>; 2],
    rows: [&[[f64; 2]]; 3],
    factors: &[f64],
) -> [[Lanes<S>; 6]; 2] {
    let mut row = RowSums::new(simd);
    let [own, above, below] = rows;
    let (mut own, mut above, mut below) = (own.chunks_exact(2), above.chunks_exact(2), below.chunks_exact(2));
    let mut factors = factors.chunks_exact(2);
    for (((own, above), below), factors) in (&mut own).zip(&mut above).zip(&mut below).zip(&mut factors) {
        if COEFFICIENTS != NEIGHBOURS_FIRST {
            row.add_own(simd, own[0]);
        }
        if COEFFICIENTS != OWN_ORDER_FIRST {
            row.add_neighbours(simd, above[0], below[0]);
        }
        row.advance(variables, factors[0]);
        if COEFFICIENTS != OWN_ORDER_FIRST {
            row.add_own(simd, own[1]);
        }
        if COEFFICIENTS != NEIGHBOURS_FIRST {
            row.add_neighbours(simd, above[1], below[1]);
        }
        row.advance(variables, factors[1]);
    }
    if let ([own], [above], [below]) = (own.remainder(), above.remainder(), below.remainder()) {
        if COEFFICIENTS != NEIGHBOURS_FIRST {
            row.add_own(simd, *own);
        }
        if COEFFICIENTS != OWN_ORDER_FIRST {
            row.add_neighbours(simd, *above, *below);
        }
    }
    row.sums
}

/// Partial sums of a row at two vectors of points, with the coefficients of the order, of the next
/// and of the previous order.
struct RowSums<S: Simd> {
    last: [Lanes<S>; 2],
    polynomial: [Lanes<S>; 2],
    sums: [[Lanes<S>; 6]; 2],
}

impl<S: Simd> RowSums<S> {
    #[inline(always)]
    fn new(simd: S) -> RowSums<S> {
        let (zero, one) = (Lanes::<S>::splat(simd, 0.0), Lanes::<S>::splat(simd, 1.0));
        RowSums { last: [zero; 2], polynomial: [one; 2], sums: [[zero; 6]; 2] }
    }

    #[inline(always)]
    fn add(&mut self, simd: S, part: usize, coefficient: f64) {
        let coefficient = Lanes::<S>::splat(simd, coefficient);
        self.sums[0][part] = self.polynomial[0].mul_add(coefficient, self.sums[0][part]);
        self.sums[1][part] = self.polynomial[1].mul_add(coefficient, self.sums[1][part]);
    }

    #[inline(always)]
    fn add_own(&mut self, simd: S, [re, im]: [f64; 2]) {
        self.add(simd, 0, re);
        self.add(simd, 1, im);
    }

    #[inline(always)]
    fn add_neighbours(&mut self, simd: S, above: [f64; 2], below: [f64; 2]) {
        self.add(simd, 2, above[0]);
        self.add(simd, 3, above[1]);
        self.add(simd, 4, below[0]);
        self.add(simd, 5, below[1]);
    }

    /// Advances the polynomials to the next degree (Eq. P24).
    #[inline(always)]
    fn advance(&mut self, variables: &[HarmonicVariables<S>; 2], factor: f64) {
        for (variables, (last, polynomial)) in variables.iter().zip(self.last.iter_mut().zip(&mut self.polynomial)) {
            let next = polynomial.mul_add(variables.z, (variables.square * *last) * -factor);
            (*last, *polynomial) = (*polynomial, next);
        }
    }
}

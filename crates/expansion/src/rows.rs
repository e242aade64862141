//! Sums over degrees and orders of polynomials times coefficients, at two vectors of points
//! (docs/physics.md, Eqs. P23 and P24).

use std::sync::LazyLock;

use fearless_simd::prelude::*;
use magsplice_simd::lanes::{Lanes, Number};

use crate::tolerances::HIGHEST_DEGREE;

/// The degree of the field is one higher than that of the potential.
const FIELD_DEGREE: usize = HIGHEST_DEGREE + 1;

/// Where the factors of an order begin.
fn row(order: usize) -> usize {
    order * (2 * FIELD_DEGREE + 3 - order) / 2
}

/// How the polynomials follow from each other (Eq. P24): row after row of equal order, by degree from that of the order on.
static RECURRENCE: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let mut factors = Vec::with_capacity(row(FIELD_DEGREE + 1));
    for order in 0..=FIELD_DEGREE {
        // From this degree to the next.
        for degree in order..=FIELD_DEGREE {
            let (l, m) = (degree as f64, order as f64);
            factors.push((l * l - m * m) / (4.0 * l * l - 1.0));
        }
    }
    factors
});

/// What the polynomials of an expansion are made of, z / r^2 and so on; or of one around its centre, z and so on.
pub(crate) struct Place<S: Simd> {
    /// 1 / r^2, or r^2
    pub(crate) square: Lanes<S>,
    /// z / r^2
    pub(crate) along: Lanes<S>,
    /// x / r^2 and y / r^2
    pub(crate) across: [Lanes<S>; 2],
}

/// Which coefficients of a row there are. In rows of an expansion with a parity those of the order itself alternate with those of its neighbours, beginning at the
/// degree of the order.
pub(crate) const ALL: u8 = 0;
pub(crate) const OWN_FIRST: u8 = 1;
pub(crate) const OTHERS_FIRST: u8 = 2;

/// The field (Eq. P23) up to `degree` at two vectors of points. `rows` gives the coefficients of an order, of the next and of the one before, from the degree
/// of the order on.
#[inline(always)]
pub(crate) fn fields_of_rows<'a, S: Simd, const WHICH: u8>(
    simd: S,
    places: &[Place<S>; 2],
    degree: usize,
    rows: impl Fn(usize) -> [&'a [[f64; 2]]; 3],
) -> [[Lanes<S>; 3]; 2] {
    let (zero, one) = (Lanes::<S>::splat(simd, 0.0), Lanes::<S>::splat(simd, 1.0));
    let mut phase = [[one, zero]; 2];
    let mut field = [[zero; 3]; 2];
    for order in 0..=degree {
        let count = degree + 1 - order;
        let factors = &RECURRENCE[row(order)..row(order) + count];
        let sums = row_sums::<S, WHICH>(simd, places, rows(order).map(|row| &row[..count]), factors);
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
            let [across_x, across_y] = places[at].across;
            phase[at] = [re.mul_sub(across_x, im * across_y), re.mul_add(across_y, im * across_x)];
        }
    }
    field
}

/// Sums over degrees of polynomial times moment, at two vectors of points: each moment is fetched once for both.
#[inline(always)]
fn row_sums<S: Simd, const WHICH: u8>(
    simd: S,
    places: &[Place<S>; 2],
    rows: [&[[f64; 2]]; 3],
    factors: &[f64],
) -> [[Lanes<S>; 6]; 2] {
    let mut row = Row::new(simd);
    let [own, above, below] = rows;
    let (mut own, mut above, mut below) = (own.chunks_exact(2), above.chunks_exact(2), below.chunks_exact(2));
    let mut factors = factors.chunks_exact(2);
    for (((own, above), below), factors) in (&mut own).zip(&mut above).zip(&mut below).zip(&mut factors) {
        if WHICH != OTHERS_FIRST {
            row.add_own(simd, own[0]);
        }
        if WHICH != OWN_FIRST {
            row.add_others(simd, above[0], below[0]);
        }
        row.go_on(places, factors[0]);
        if WHICH != OWN_FIRST {
            row.add_own(simd, own[1]);
        }
        if WHICH != OTHERS_FIRST {
            row.add_others(simd, above[1], below[1]);
        }
        row.go_on(places, factors[1]);
    }
    if let ([own], [above], [below]) = (own.remainder(), above.remainder(), below.remainder()) {
        if WHICH != OTHERS_FIRST {
            row.add_own(simd, *own);
        }
        if WHICH != OWN_FIRST {
            row.add_others(simd, *above, *below);
        }
    }
    row.sums
}

/// A row's sums so far, at two vectors of points: of the order itself, of the next and of the one before.
struct Row<S: Simd> {
    last: [Lanes<S>; 2],
    polynomial: [Lanes<S>; 2],
    sums: [[Lanes<S>; 6]; 2],
}

impl<S: Simd> Row<S> {
    #[inline(always)]
    fn new(simd: S) -> Row<S> {
        let (zero, one) = (Lanes::<S>::splat(simd, 0.0), Lanes::<S>::splat(simd, 1.0));
        Row { last: [zero; 2], polynomial: [one; 2], sums: [[zero; 6]; 2] }
    }

    #[inline(always)]
    fn add(&mut self, simd: S, part: usize, moment: f64) {
        let moment = Lanes::<S>::splat(simd, moment);
        self.sums[0][part] = self.polynomial[0].mul_add(moment, self.sums[0][part]);
        self.sums[1][part] = self.polynomial[1].mul_add(moment, self.sums[1][part]);
    }

    #[inline(always)]
    fn add_own(&mut self, simd: S, [re, im]: [f64; 2]) {
        self.add(simd, 0, re);
        self.add(simd, 1, im);
    }

    #[inline(always)]
    fn add_others(&mut self, simd: S, above: [f64; 2], below: [f64; 2]) {
        self.add(simd, 2, above[0]);
        self.add(simd, 3, above[1]);
        self.add(simd, 4, below[0]);
        self.add(simd, 5, below[1]);
    }

    /// To the next degree.
    #[inline(always)]
    fn go_on(&mut self, places: &[Place<S>; 2], factor: f64) {
        for (place, (last, polynomial)) in places.iter().zip(self.last.iter_mut().zip(&mut self.polynomial)) {
            let next = polynomial.mul_add(place.along, (place.square * *last) * -factor);
            (*last, *polynomial) = (*polynomial, next);
        }
    }
}

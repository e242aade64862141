//! The field of tiles far away around a point without tiles: an expansion in regular solid harmonics, in the lanes of a vector (docs/physics.md,
//! section 5.2).

use std::sync::LazyLock;

use fearless_simd::prelude::*;
use glam::DVec3;
use magsplice_simd::lanes::{Lanes, Number};
use magsplice_simd::pairwise::Pairwise;

use crate::rows::{ALL, Place, fields_of_rows};
use crate::tolerances::HIGHEST_LOCAL_DEGREE;

/// R_lm over the polynomial of the recurrence times (x + i y)^m (Eq. P24 with z and r^2), row after row of equal degree: (2l - 1)!! / (l + m)! (l - m)!.
static LEADING: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let mut factors = vec![1.0];
    for l in 1..=HIGHEST_LOCAL_DEGREE {
        for m in 0..l {
            factors.push(factors[place(l - 1, m)] * (2 * l - 1) as f64 / ((l + m) * (l - m)) as f64);
        }
        factors.push(factors[place(l - 1, l - 1)] * 0.5 / l as f64);
    }
    factors
});

/// Where a pair of degree and order is in rows of equal degree.
pub fn place(l: usize, m: usize) -> usize {
    l * (l + 1) / 2 + m
}

/// A field that is a polynomial.
#[derive(Debug)]
pub struct LocalExpansion {
    centre: DVec3,
    scale: f64,
    /// That of the field.
    degree: usize,
    /// Of each order by itself, of the next and of the one before: rows of equal order, by degree of the field from the order on.
    rows: [Vec<[f64; 2]>; 3],
}

impl LocalExpansion {
    /// From the coefficients of the regular harmonics in the potential, real and imaginary parts by degree and order as [`place`] has them; lengths are multiplied by `scale`.
    pub fn new(degree: usize, centre: DVec3, scale: f64, [re, im]: [&[f64]; 2]) -> LocalExpansion {
        let count = place(degree + 1, 0);
        let mut rows = [const { Vec::new() }; 3];
        rows.iter_mut().for_each(|row| row.reserve(count));
        let [own, above, below] = &mut rows;
        // Of each pair the field's share of the harmonic of one degree more and some order.
        for m in 0..=degree {
            for l in m..=degree {
                let factor = LEADING[place(l, m)];
                let at = place(l + 1, m);
                own.push([re[at] * -factor, im[at] * -factor]);
                above.push([re[at + 1] * factor, im[at + 1] * factor]);
                below.push(if m > 0 { [re[at - 1] * factor, im[at - 1] * factor] } else { [0.0; 2] });
            }
        }
        LocalExpansion { centre, scale, degree, rows }
    }

    #[inline(always)]
    fn place<S: Simd>(&self, mut point: [Lanes<S>; 3]) -> Place<S> {
        for (coordinate, centre) in point.iter_mut().zip(self.centre.to_array()) {
            *coordinate = (*coordinate - centre) * self.scale;
        }
        let [x, y, z] = point;
        Place { square: z.mul_add(z, y.mul_add(y, x * x)), along: z, across: [x, y] }
    }

    fn row_start(&self, order: usize) -> usize {
        order * (2 * self.degree + 3 - order) / 2
    }
}

impl<S: Simd> Pairwise<S> for LocalExpansion {
    #[inline(always)]
    fn fields(&self, simd: S, points: [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; 3]; 2] {
        let places = [self.place(points[0]), self.place(points[1])];
        fields_of_rows::<S, ALL>(simd, &places, self.degree, |order| {
            let start = self.row_start(order);
            [&self.rows[0][start..], &self.rows[1][start..], &self.rows[2][start..]]
        })
    }
}

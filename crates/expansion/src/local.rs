//! Local expansions: the field of distant sources around a point, in regular solid harmonics (L2P;
//! docs/physics.md, section 5.2).

use std::sync::LazyLock;

use fearless_simd::prelude::*;
use glam::DVec3;
use magsplice_simd::lanes::{Lanes, Number};
use magsplice_simd::pairwise::Pairwise;

use crate::rows::{ALL_COEFFICIENTS, HarmonicVariables, fields_of_rows};
use crate::tolerances::HIGHEST_LOCAL_DEGREE;

/// Leading coefficients of R_lm, (2l - 1)!! / (l + m)! (l - m)!, row after row of equal degree:
/// R_lm over (x + i y)^m and the polynomial of the recurrence (Eq. P24 with z and r^2).
static LEADING: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let mut factors = vec![1.0];
    for l in 1..=HIGHEST_LOCAL_DEGREE {
        for m in 0..l {
            factors.push(factors[local_index(l - 1, m)] * (2 * l - 1) as f64 / ((l + m) * (l - m)) as f64);
        }
        factors.push(factors[local_index(l - 1, l - 1)] * 0.5 / l as f64);
    }
    factors
});

/// Index of degree l and order m, 0 <= m <= l, in rows of equal degree.
pub fn local_index(l: usize, m: usize) -> usize {
    l * (l + 1) / 2 + m
}

/// The field around a centre as a harmonic polynomial.
///
/// The truncation error of a translation is bounded by Eq. P37.
#[derive(Debug)]
pub struct LocalExpansion {
    centre: DVec3,
    scale: f64,
    /// Degree of the field.
    degree: usize,
    /// Coefficients of each order, of the next and of the previous order: rows of equal order, by
    /// degree of the field from the order on.
    rows: [Vec<[f64; 2]>; 3],
}

impl LocalExpansion {
    /// The field of a potential around `centre`, in tesla.
    ///
    /// The last argument holds the real and imaginary parts of the potential's coefficients in
    /// regular harmonics, at [`local_index`], up to degree `degree` + 1, with lengths multiplied by
    /// `scale`.
    pub fn new(degree: usize, centre: DVec3, scale: f64, [re, im]: [&[f64]; 2]) -> LocalExpansion {
        let count = local_index(degree + 1, 0);
        let mut rows = [const { Vec::new() }; 3];
        rows.iter_mut().for_each(|row| row.reserve(count));
        let [own, above, below] = &mut rows;
        // The field of degree l and order m comes from the potential of degree l + 1 (Eq. P22).
        for m in 0..=degree {
            for l in m..=degree {
                let factor = LEADING[local_index(l, m)];
                let at = local_index(l + 1, m);
                own.push([re[at] * -factor, im[at] * -factor]);
                above.push([re[at + 1] * factor, im[at + 1] * factor]);
                below.push(if m > 0 { [re[at - 1] * factor, im[at - 1] * factor] } else { [0.0; 2] });
            }
        }
        LocalExpansion { centre, scale, degree, rows }
    }

    #[inline(always)]
    fn variables<S: Simd>(&self, mut point: [Lanes<S>; 3]) -> HarmonicVariables<S> {
        for (coordinate, centre) in point.iter_mut().zip(self.centre.to_array()) {
            *coordinate = (*coordinate - centre) * self.scale;
        }
        let [x, y, z] = point;
        HarmonicVariables { square: z.mul_add(z, y.mul_add(y, x * x)), z, xy: [x, y] }
    }

    fn row_start(&self, order: usize) -> usize {
        order * (2 * self.degree + 3 - order) / 2
    }
}

impl<S: Simd> Pairwise<S> for LocalExpansion {
    #[inline(always)]
    fn fields(&self, simd: S, points: [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; 3]; 2] {
        let variables = [self.variables(points[0]), self.variables(points[1])];
        fields_of_rows::<S, ALL_COEFFICIENTS>(simd, &variables, self.degree, |order| {
            let start = self.row_start(order);
            [&self.rows[0][start..], &self.rows[1][start..], &self.rows[2][start..]]
        })
    }
}

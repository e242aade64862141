//! Multipole expansions: the field of sources outside a sphere around them, in irregular solid
//! harmonics (M2P; docs/physics.md, section 2.8).

use fearless_simd::prelude::*;
use magsplice_simd::lanes::{Lanes, Number};
use magsplice_simd::pairwise::each_pair;

use crate::moments::{Moments, Parity};
use crate::rows::{ALL_COEFFICIENTS, HarmonicVariables, NEIGHBOURS_FIRST, OWN_ORDER_FIRST, fields_of_rows};
use crate::tolerances::POINTS_PER_DEGREE;

/// The field of sources outside a sphere around them.
///
/// The truncation error is bounded by Eq. P29.
#[derive(Clone, Debug)]
pub struct MultipoleExpansion {
    centre: [f64; 3],
    scale: f64,
    /// Degree of the potential.
    degree: usize,
    /// Real and imaginary parts of (2l - 1)!! M_(l-1)m, row after row of equal order m; see
    /// [`MultipoleExpansion::row`].
    moments: Vec<[f64; 2]>,
    parity: Parity,
}

impl MultipoleExpansion {
    /// The expansion with these moments about `centre`, whose lengths were multiplied by `scale`.
    pub fn from_moments(moments: &Moments, centre: [f64; 3], scale: f64) -> MultipoleExpansion {
        let degree = moments.degree();
        let mut odd_factorials = vec![1.0];
        for l in 1..=degree + 1 {
            odd_factorials.push(odd_factorials[l - 1] * (2 * l - 1) as f64);
        }
        let rows = (0..=degree + 2).flat_map(|order| (first_degree(order)..=degree + 1).map(move |l| (order, l)));
        let coefficients = rows
            .map(
                |(order, l)| {
                    if l < 2 { [0.0; 2] } else { moments.at(l - 1, order).map(|part| part * odd_factorials[l]) }
                },
            )
            .collect();
        MultipoleExpansion { centre, scale, degree, moments: coefficients, parity: moments.parity() }
    }

    /// Degree of the potential.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Parity of the potential, by which half of the moments vanish.
    pub fn parity(&self) -> Parity {
        self.parity
    }

    /// The same expansion, evaluated without its parity. Its values are bit-identical.
    pub fn without_parity(self) -> MultipoleExpansion {
        MultipoleExpansion { parity: Parity::Neither, ..self }
    }

    /// Coefficients of an order, from degree `from` of the field on.
    #[inline(always)]
    fn row(&self, order: usize, from: usize) -> &[[f64; 2]] {
        let (first, last) = (first_degree(order), self.degree + 1);
        let before = order * (last + 1) - first * first.saturating_sub(1) / 2;
        &self.moments[before + from - first..before + last + 1 - first]
    }

    /// Writes mu0 H in tesla, in the frame of the sources, at points given by axis.
    ///
    /// `degrees` has the degree of the potential for each [`POINTS_PER_DEGREE`] points, at most
    /// [`MultipoleExpansion::degree`].
    #[inline(never)]
    pub fn fields<S: Simd>(&self, simd: S, degrees: &[usize], points: [&[f64]; 3], fields: [&mut [f64]; 3]) {
        simd.vectorize(
            #[inline(always)]
            || {
                each_pair(
                    simd,
                    #[inline(always)]
                    |first, pair| self.fields_of_pair(simd, degrees[first / POINTS_PER_DEGREE], pair),
                    points,
                    fields,
                );
            },
        );
    }

    /// mu0 H in tesla at two vectors of points, from the potential up to `degree`.
    #[inline(always)]
    pub fn fields_of_pair<S: Simd>(&self, simd: S, degree: usize, points: [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; 3]; 2] {
        // A loop instead of `map`: the compiler does not inline operations on vectors in a closure.
        let (first, over_first) = self.variables(simd, points[0]);
        let (second, over_second) = self.variables(simd, points[1]);
        // Coefficients of the order, of the next and of the previous order.
        let rows = |order: usize| [order, order + 1, order.saturating_sub(1)].map(|other| self.row(other, order));
        let variables = [first, second];
        let fields = match self.parity {
            Parity::Neither => fields_of_rows::<S, ALL_COEFFICIENTS>(simd, &variables, degree + 1, rows),
            Parity::Even => fields_of_rows::<S, NEIGHBOURS_FIRST>(simd, &variables, degree + 1, rows),
            Parity::Odd => fields_of_rows::<S, OWN_ORDER_FIRST>(simd, &variables, degree + 1, rows),
        };
        let [[x, y, z], [x_2, y_2, z_2]] = fields;
        [[x * over_first, y * over_first, z * over_first], [x_2 * over_second, y_2 * over_second, z_2 * over_second]]
    }

    /// Variables of the polynomials at a vector of points, and 1 / r.
    #[inline(always)]
    fn variables<S: Simd>(&self, simd: S, mut point: [Lanes<S>; 3]) -> (HarmonicVariables<S>, Lanes<S>) {
        for (coordinate, centre) in point.iter_mut().zip(&self.centre) {
            *coordinate = (*coordinate - *centre) * self.scale;
        }
        let [x, y, z] = point;
        let square = Lanes::<S>::splat(simd, 1.0).over(z.mul_add(z, y.mul_add(y, x * x)));
        (HarmonicVariables { square, z: z * square, xy: [x * square, y * square] }, square.sqrt())
    }
}

/// Lowest degree of the field to which the potential's moments of an order contribute.
fn first_degree(order: usize) -> usize {
    order.saturating_sub(1)
}

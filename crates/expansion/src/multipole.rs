//! Tiles together far away: the expansion of their field in irregular solid harmonics, in the lanes of a vector (docs/physics.md,
//! section 2.8).

use fearless_simd::prelude::*;
use magsplice_simd::lanes::{Lanes, Number};
use magsplice_simd::pairwise::each_pair;

use crate::moments::{Moments, Parity};
use crate::rows::{ALL, OTHERS_FIRST, OWN_FIRST, Place, fields_of_rows};
use crate::tolerances::POINTS_PER_DEGREE;

/// The field of tiles outside a sphere around them.
#[derive(Clone, Debug)]
pub struct Expansion {
    centre: [f64; 3],
    scale: f64,
    /// That of the potential.
    degree: usize,
    /// Real and imaginary parts of (2l - 1)!! M_(l-1)m, row after row of equal order m, see [`Expansion::row`].
    moments: Vec<[f64; 2]>,
    parity: Parity,
}

impl Expansion {
    /// Of the moments about a point of what has been scaled.
    pub fn from_moments(moments: &Moments, centre: [f64; 3], scale: f64) -> Expansion {
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
        Expansion { centre, scale, degree, moments: coefficients, parity: moments.parity() }
    }

    /// The degree of the potential.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The moments that vanish by symmetry.
    pub fn parity(&self) -> Parity {
        self.parity
    }

    /// The same expansion evaluated without use of its parity, which gives the same digits.
    pub fn without_parity(self) -> Expansion {
        Expansion { parity: Parity::Neither, ..self }
    }

    /// The moments of an order, for the degrees of the field from `from` on.
    #[inline(always)]
    fn row(&self, order: usize, from: usize) -> &[[f64; 2]] {
        let (first, last) = (first_degree(order), self.degree + 1);
        let before = order * (last + 1) - first * first.saturating_sub(1) / 2;
        &self.moments[before + from - first..before + last + 1 - first]
    }

    /// mu0 H of the tiles, in their frame, at points given by axis, from the potential up to the degrees that each [`POINTS_PER_DEGREE`] points have.
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

    /// The same at two vectors of points.
    #[inline(always)]
    pub fn fields_of_pair<S: Simd>(&self, simd: S, degree: usize, points: [[Lanes<S>; 3]; 2]) -> [[Lanes<S>; 3]; 2] {
        // Not by `map`: operations on vectors in a closure are calls.
        let (first, over_first) = self.place(simd, points[0]);
        let (second, over_second) = self.place(simd, points[1]);
        // Those of the own order, of the next and of the one before.
        let rows = |order: usize| [order, order + 1, order.saturating_sub(1)].map(|other| self.row(other, order));
        let places = [first, second];
        let fields = match self.parity {
            Parity::Neither => fields_of_rows::<S, ALL>(simd, &places, degree + 1, rows),
            Parity::Even => fields_of_rows::<S, OTHERS_FIRST>(simd, &places, degree + 1, rows),
            Parity::Odd => fields_of_rows::<S, OWN_FIRST>(simd, &places, degree + 1, rows),
        };
        let [[x, y, z], [x_2, y_2, z_2]] = fields;
        [[x * over_first, y * over_first, z * over_first], [x_2 * over_second, y_2 * over_second, z_2 * over_second]]
    }

    /// Where a point lies relative to the centre, and the inverse of its distance.
    #[inline(always)]
    fn place<S: Simd>(&self, simd: S, mut point: [Lanes<S>; 3]) -> (Place<S>, Lanes<S>) {
        for (coordinate, centre) in point.iter_mut().zip(&self.centre) {
            *coordinate = (*coordinate - *centre) * self.scale;
        }
        let [x, y, z] = point;
        let square = Lanes::<S>::splat(simd, 1.0).over(z.mul_add(z, y.mul_add(y, x * x)));
        (Place { square, along: z * square, across: [x * square, y * square] }, square.sqrt())
    }
}

/// The lowest degree of the field to which an order of the potential's moments belongs.
fn first_degree(order: usize) -> usize {
    order.saturating_sub(1)
}

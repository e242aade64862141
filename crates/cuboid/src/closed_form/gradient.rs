//! The gradient of the closed form in vectors (docs/physics.md, section 2.9).
//!
//! The third derivatives of the potential are algebraic functions of the distances from the
//! corners. They are differences over the sides of the cuboid. Each difference is divided by its
//! step before any rounding, so no digit is lost inside a cuboid of any shape, close to it or far
//! away.

use std::f64::consts::PI;

use magsplice_simd::lanes::Number;

use super::elements::CornerGeometry;
use super::positive::Octant;

/// Number of components of a gradient.
pub const COMPONENTS: usize = 6;

/// A cuboid's data for the gradient from tables of planes and corners.
#[derive(Clone, Copy, Debug)]
pub struct GradientTerms {
    /// Axes a, b, c of the tables.
    axes: [usize; 3],
    /// Sides along a, b, c, scaled.
    sides: [f64; 3],
    /// J / 4 pi along a, b, c, in tesla times the scale.
    weights: [f64; 3],
}

impl GradientTerms {
    /// The terms of a cuboid with these scaled sides and this J in tesla, both along `axes`.
    pub fn new(axes: [usize; 3], sides: [f64; 3], polarization_t: [f64; 3], scale: f64) -> GradientTerms {
        GradientTerms { axes, sides, weights: polarization_t.map(|j| j * scale / (4.0 * PI)) }
    }

    /// Adds the gradient of B outside the cuboid, in tesla per length, in its frame: xx, yy, zz,
    /// yz, xz, xy.
    #[inline(always)]
    pub fn add<N: Number>(&self, simd: N::Instructions, place: &CornerGeometry<N>, sum: &mut [N; COMPONENTS]) {
        let mut own = [N::splat(simd, 0.0); COMPONENTS];
        Octant::from_corners(simd, place, self.sides).add_gradient(simd, self.weights, &mut own);
        for (n, axis) in self.axes.into_iter().enumerate() {
            sum[axis] = sum[axis] + own[n];
            sum[3 + axis] = sum[3 + axis] + own[3 + n];
        }
    }
}

/// A function of the squares of the offsets along i and j: its values, by side along i and along j,
/// and its divided differences.
struct Divided<N> {
    values: [[N; 2]; 2],
    /// Differences over i over the step of the square, by side along j.
    by_i: [N; 2],
    /// Differences over j likewise, by side along i.
    by_j: [N; 2],
    /// The difference over j of the differences over i, over both steps.
    mixed: N,
}

impl<N: Number> Divided<N> {
    /// The product of two functions.
    #[inline(always)]
    fn times(&self, other: &Divided<N>) -> Divided<N> {
        let (f, g) = (self, other);
        let mut product = Divided { values: f.values, by_i: f.by_i, by_j: f.by_j, mixed: f.mixed };
        for side in 0..2 {
            for other_side in 0..2 {
                product.values[side][other_side] = f.values[side][other_side] * g.values[side][other_side];
            }
            product.by_i[side] = f.by_i[side].mul_add(g.values[1][side], f.values[0][side] * g.by_i[side]);
            product.by_j[side] = f.by_j[side].mul_add(g.values[side][1], f.values[side][0] * g.by_j[side]);
        }
        let across = f.by_j[0].mul_add(g.by_i[1], f.by_i[0] * g.by_j[1]);
        product.mixed = f.mixed.mul_add(g.values[1][1], f.values[0][0].mul_add(g.mixed, across));
        product
    }

    /// The sum of two functions.
    #[inline(always)]
    fn plus(&self, other: &Divided<N>) -> Divided<N> {
        let (f, g) = (self, other);
        let mut sum = Divided { values: f.values, by_i: f.by_i, by_j: f.by_j, mixed: f.mixed + g.mixed };
        for side in 0..2 {
            for other_side in 0..2 {
                sum.values[side][other_side] = f.values[side][other_side] + g.values[side][other_side];
            }
            sum.by_i[side] = f.by_i[side] + g.by_i[side];
            sum.by_j[side] = f.by_j[side] + g.by_j[side];
        }
        sum
    }

    /// The product of all values at the near side along i, and at the far side.
    #[inline(always)]
    fn products(&self) -> [N; 2] {
        let [near, far] = self.values;
        [near[0] * near[1], far[0] * far[1]]
    }
}

/// 1 / (r + r') of the distances from two corners at both ends of each edge along an axis, by the
/// sides along the next two axes.
type InverseSums<N> = [[N; 2]; 2];

impl<N: Number> Octant<N> {
    /// Adds the derivatives of T J for J over 4 pi: xx, yy, zz, yz, xz, xy.
    #[inline(always)]
    pub fn add_gradient(&self, simd: N::Instructions, j: [f64; 3], sum: &mut [N; COMPONENTS]) {
        let zero = N::splat(simd, 0.0);
        let inverse_sums = [self.inverse_sums(simd, 0), self.inverse_sums(simd, 1), self.inverse_sums(simd, 2)];
        let mut derivatives = ThirdDerivatives { twice: [[zero; 3]; 3], mixed: zero, has_mixed: false };
        // No loop, so that all indices of vectors are constants.
        derivatives.add::<0>(simd, self, &inverse_sums, j);
        derivatives.add::<1>(simd, self, &inverse_sums, j);
        derivatives.add::<2>(simd, self, &inverse_sums, j);
        let ThirdDerivatives { twice, mixed, .. } = derivatives;
        for a in 0..3 {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            let own = zero - (twice[b][a] + twice[c][a]);
            sum[a] = own.scale_add(j[a], twice[a][b].scale_add(j[b], twice[a][c].scale_add(j[c], sum[a])));
            // The index of a component is its missing axis.
            let across = twice[b][c].scale_add(j[b], twice[c][b].scale_add(j[c], sum[3 + a]));
            sum[3 + a] = mixed.scale_add(j[a], across);
        }
    }

    #[inline(always)]
    fn inverse_sums(&self, simd: N::Instructions, axis: usize) -> InverseSums<N> {
        let r = &self.distances;
        let (own, next, last) = (1 << axis, 1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        let (a, b) = (r[0] + r[own], r[last] + r[last | own]);
        let (c, d) = (r[next] + r[next | own], r[next | last] + r[next | last | own]);
        let (ab, cd) = (a * b, c * d);
        let inverse = N::splat(simd, 1.0).over(ab * cd);
        let (over_ab, over_cd) = (inverse * cd, inverse * ab);
        [[over_ab * b, over_ab * a], [over_cd * d, over_cd * c]]
    }
}

/// The third derivatives of the potential that a polarization needs.
struct ThirdDerivatives<N> {
    /// 4 pi T_aab by [a][b].
    twice: [[N; 3]; 3],
    /// 4 pi T_xyz.
    mixed: N,
    has_mixed: bool,
}

impl<N: Number> ThirdDerivatives<N> {
    /// Adds the derivatives from the edges along axis `K`, if J needs them.
    #[inline(always)]
    fn add<const K: usize>(
        &mut self,
        simd: N::Instructions,
        place: &Octant<N>,
        inverse_sums: &[InverseSums<N>; 3],
        j: [f64; 3],
    ) {
        let (a, b) = ((K + 1) % 3, (K + 2) % 3);
        if j[a] == 0.0 && j[b] == 0.0 {
            return;
        }
        let pair = AxisPair::new(place, inverse_sums, K);
        (self.twice[a][b], self.twice[b][a]) = pair.twice(simd, place, K);
        if !self.has_mixed {
            (self.has_mixed, self.mixed) = (true, pair.mixed(simd, place));
        }
    }
}

/// The edges along an axis k and their distances from a point, as functions of the offsets along
/// the next two axes i and j.
struct AxisPair<N> {
    /// S, the sum of the distances from both ends of an edge.
    sum: Divided<N>,
    /// P, their product.
    product: Divided<N>,
}

impl<N: Number> AxisPair<N> {
    #[inline(always)]
    fn new(place: &Octant<N>, inverse_sums: &[InverseSums<N>; 3], k: usize) -> AxisPair<N> {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let (by_i, by_j) = (&inverse_sums[i], &inverse_sums[j]);
        let near = Self::distance(place, [by_i[0][0], by_i[1][0]], by_j[0], [i, j], 0);
        let far = Self::distance(place, [by_i[0][1], by_i[1][1]], by_j[1], [i, j], 1 << k);
        AxisPair { sum: near.plus(&far), product: near.times(&far) }
    }

    /// The distance from the end of the edges in `corner`.
    #[inline(always)]
    fn distance(place: &Octant<N>, by_i: [N; 2], by_j: [N; 2], [i, j]: [usize; 2], corner: usize) -> Divided<N> {
        let r = &place.distances;
        let values = [[r[corner], r[corner | 1 << j]], [r[corner | 1 << i], r[corner | 1 << i | 1 << j]]];
        Divided { values, by_i, by_j, mixed: (by_j[0] * by_j[1]) * (by_i[0] + by_i[1]) * -1.0 }
    }

    /// Half of Q = S^2 - l^2, which is x^2 + y^2 + z_0 z_1 + P (section 2.9): its value at the near
    /// edge has no cancellation, and its differences are those of x^2 + y^2 + P.
    #[inline(always)]
    fn excess(&self, simd: N::Instructions, place: &Octant<N>, k: usize) -> Divided<N> {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let (zero, one) = (N::splat(simd, 0.0), N::splat(simd, 1.0));
        let [near, far] = place.faces[k];
        let beside = near.where_at_least(0.0, near, zero - near);
        let overhang = near.where_at_least(0.0, near, zero);
        let (x, y) = (place.faces[i][0], place.faces[j][0]);
        let (a, b) = (place.distances[0] + beside, place.distances[1 << k] + far);
        let half_minus = (x.mul_add(x, y * y) * (a + b) * 0.5).over(a * b) + overhang;
        let least = half_minus * (self.sum.values[0][0] - -place.size[k]);
        let by_i = [self.product.by_i[0] + one, self.product.by_i[1] + one];
        let by_j = [self.product.by_j[0] + one, self.product.by_j[1] + one];
        let (d_i, d_j) = (place.square_step(i), place.square_step(j));
        let other = d_i.mul_add(by_i[0], least);
        let values = [[least, d_j.mul_add(by_j[0], least)], [other, d_j.mul_add(by_j[1], other)]];
        Divided { values, by_i, by_j, mixed: self.product.mixed }
    }

    /// 4 pi T_iij and 4 pi T_ijj.
    #[inline(always)]
    fn twice(&self, simd: N::Instructions, place: &Octant<N>, k: usize) -> (N, N) {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        // l S / X is the integral of 1 / r^3 along an edge.
        let (s, x) = (&self.sum, self.product.times(&self.excess(simd, place, k)));
        let y_near = s.values[0][0].mul_sub(x.by_j[0], s.by_j[0] * x.values[0][0]);
        let y_far = s.values[1][0].mul_sub(x.by_j[1], s.by_j[1] * x.values[1][0]);
        let z_far = s.values[0][1].mul_sub(x.by_i[1], s.by_i[1] * x.values[0][1]);
        let y_step = s.by_i[0].mul_add(x.by_j[1], s.values[0][0] * x.mixed)
            - s.mixed.mul_add(x.values[1][0], s.by_j[0] * x.by_i[0]);
        let [near, far] = x.products();
        let step = x.by_i[0].mul_add(x.values[1][1], x.values[0][0] * x.by_i[1]);
        let bend = y_near.mul_sub(step, y_step * near);
        let volume = place.size[0] * place.size[1] * place.size[2];
        let common = N::splat(simd, volume).over(near * far);
        let (step_i, step_j) = (place.steps[i], place.steps[j]);
        let own = y_far.mul_sub(near, place.faces[i][0] * step_i * bend) * (common * step_j);
        let other = z_far.mul_sub(x.values[0][0] * x.values[1][0], place.faces[j][0] * step_j * bend);
        (own * place.signs[j], other * (common * step_i) * place.signs[i])
    }

    /// 4 pi T_xyz.
    #[inline(always)]
    fn mixed(&self, simd: N::Instructions, place: &Octant<N>) -> N {
        let f = self.sum.times(&self.product);
        let [near, far] = f.products();
        let step = f.by_i[0].mul_add(f.values[1][1], f.values[0][0] * f.by_i[1]);
        let bend = f.mixed.mul_sub(near, f.by_j[0] * step);
        let volume = place.size[0] * place.size[1] * place.size[2];
        let steps = (place.steps[0] * place.steps[1]) * place.steps[2];
        let signs = (place.signs[0] * place.signs[1]) * place.signs[2];
        N::splat(simd, volume).over(near * far) * (steps * signs * bend)
    }
}

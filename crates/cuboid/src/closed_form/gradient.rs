//! The gradient of the closed form in vectors (docs/physics.md, section 2.9).
//!
//! The third derivatives of the potential are algebraic. The integral of an edge has two
//! differences, over the sides along i and j. The difference over the shorter side j is taken
//! before any rounding; the other loses a factor of distance over the side along i.

use std::f64::consts::PI;

use magsplice_simd::differentiated::Differentiated;
use magsplice_simd::lanes::Number;

use super::elements::CornerGeometry;
use super::rod::ratios_of_rod;
use super::terms::{BB, BC, Form};
use crate::block::Block;
use crate::tolerances::{LONGEST_GRADIENT_ROD, NEAR_FRACTION, NEAR_GRADIENT_ASPECT, THINNEST_GRADIENT};

/// Number of components of a gradient.
pub const COMPONENTS: usize = 6;

/// Whether the closed form keeps its bound for a cuboid with these sides, longest first.
pub fn has_gradient([a, b, _]: [f64; 3]) -> bool {
    a <= LONGEST_GRADIENT_ROD * b
}

/// The cuboid's data for the gradient.
#[derive(Clone, Copy, Debug)]
pub struct GradientTerms {
    /// Axes a, b, c, whose sides decrease.
    axes: [usize; 3],
    /// Sides along a, b, c, scaled.
    sides: [f64; 3],
    /// J / 4 pi along a, b, c, in tesla times the scale.
    weights: [f64; 3],
    form: Form,
}

impl GradientTerms {
    /// The terms of a cuboid with these scaled sides and this J in tesla, both along `axes`.
    pub fn new(axes: [usize; 3], sides: [f64; 3], polarization_t: [f64; 3], scale: f64, form: Form) -> GradientTerms {
        GradientTerms { axes, sides, weights: polarization_t.map(|j| j * scale / (4.0 * PI)), form }
    }

    /// The terms of a block whose lengths `scale` brings to order one.
    pub fn from_block(block: &Block, scale: f64, form: Form) -> GradientTerms {
        let mut axes = [0, 1, 2];
        axes.sort_by(|&a, &b| block.size[b].total_cmp(&block.size[a]));
        let along = |values: [f64; 3]| axes.map(|axis| values[axis]);
        GradientTerms::new(
            axes,
            along(block.size).map(|s| s * scale),
            along(block.polarization_t.to_array()),
            scale,
            form,
        )
    }

    /// Whether the closed form keeps its bound.
    pub fn has_closed_form(&self) -> bool {
        has_gradient(self.sides)
    }

    /// Largest distance from the cuboid, scaled, at which the closed form for points inside and
    /// close to it keeps its bound.
    pub fn near_reach(&self) -> f64 {
        let [a, _, c] = self.sides;
        NEAR_FRACTION * if c >= NEAR_GRADIENT_ASPECT * a { a } else { c }
    }

    /// Whether products of the closed form close to the cuboid are normal numbers.
    pub fn is_resolved(&self) -> bool {
        let [a, _, c] = self.sides;
        c >= THINNEST_GRADIENT * a
    }

    /// Adds the gradient of B, in tesla per length, in the frame of the cuboid: xx, yy, zz, yz, xz,
    /// xy. Points inside the cuboid and close to it come with `steps`, twice their offsets from its
    /// centre.
    #[inline(always)]
    pub fn add<N: Number>(
        &self,
        simd: N::Instructions,
        place: &CornerGeometry<N>,
        steps: Option<&[N; 3]>,
        sum: &mut [N; COMPONENTS],
    ) {
        let [ja, jb, jc] = self.weights;
        let zero = N::splat(simd, 0.0);
        let (mut ab, mut ac, mut bc) = ([zero; 3], [zero; 3], [zero; 3]);
        if ja != 0.0 || jb != 0.0 {
            ab = self.edges(simd, place, [0, 1, 2], steps);
        }
        if ja != 0.0 || jc != 0.0 {
            ac = self.edges(simd, place, [0, 2, 1], steps);
        }
        if jb != 0.0 || jc != 0.0 {
            let by_ends = steps.is_none() && self.form == Form::Rod;
            bc = if by_ends { self.edges_of_rod(simd, place) } else { self.edges(simd, place, [1, 2, 0], steps) };
        }
        let ([aab, abb, mixed], [aac, acc, other_mixed], [bbc, bcc, _]) = (ab, ac, bc);
        let abc = if ja != 0.0 || jb != 0.0 { mixed } else { other_mixed };
        let (aaa, bbb) = (abb + acc, aab + bcc);
        let [a, b, c] = self.axes;
        let diagonal_a = aab.scale_add(jb, aac.scale_add(jc, aaa * -ja));
        let diagonal_b = abb.scale_add(ja, bbc.scale_add(jc, bbb * -jb));
        sum[a] = sum[a] + diagonal_a;
        sum[b] = sum[b] + diagonal_b;
        sum[c] = sum[c] - (diagonal_a + diagonal_b);
        // The index of a component is its missing axis.
        sum[3 + c] = aab.scale_add(ja, abb.scale_add(jb, abc.scale_add(jc, sum[3 + c])));
        sum[3 + b] = aac.scale_add(ja, abc.scale_add(jb, acc.scale_add(jc, sum[3 + b])));
        sum[3 + a] = abc.scale_add(ja, bbc.scale_add(jb, bcc.scale_add(jc, sum[3 + a])));
    }

    /// 4 pi T_iij, 4 pi T_ijj and 4 pi T_ijk from the four edges along k (Eqs. P42 to P44).
    #[inline(always)]
    fn edges<N: Number>(
        &self,
        simd: N::Instructions,
        place: &CornerGeometry<N>,
        [i, j, k]: [usize; 3],
        steps: Option<&[N; 3]>,
    ) -> [N; 3] {
        let at = |bi: usize, bj: usize, bk: usize| (bi << (2 - i)) | (bj << (2 - j)) | (bk << (2 - k));
        let (side_j, side_k) = (self.sides[j], self.sides[k]);
        let [[i0, i0_square], [i1, i1_square]] = place.planes[i];
        let [[j0, j0_square], [j1, j1_square]] = place.planes[j];
        let [[k0, _], [k1, _]] = place.planes[k];
        let [step_i, step_j, step_k] =
            steps.map_or([i0 + i1, j0 + j1, k0 + k1], |steps| [steps[i], steps[j], steps[k]]);
        let r = &place.distances;
        let low_r = [[r[at(0, 0, 0)], r[at(0, 0, 1)]], [r[at(0, 1, 0)], r[at(0, 1, 1)]]];
        let high_r = [[r[at(1, 0, 0)], r[at(1, 0, 1)]], [r[at(1, 1, 0)], r[at(1, 1, 1)]]];
        let (low, high) = (EdgePair { r: low_r }, EdgePair { r: high_r });
        let beside = Beside::new(simd, [k0, k1]);
        let low_excesses = [
            beside.excess(low.r[0], i0_square + j0_square, side_k),
            beside.excess(low.r[1], i0_square + j1_square, side_k),
        ];
        let high_excesses = [
            beside.excess(high.r[0], i1_square + j0_square, side_k),
            beside.excess(high.r[1], i1_square + j1_square, side_k),
        ];
        let (low, high) = (low.terms(low_excesses, step_j, side_k), high.terms(high_excesses, step_j, side_k));
        let inverse = N::splat(simd, 1.0).over(low.below * low.sums * (high.below * high.sums));
        let (over_low, over_high) = (inverse * (high.below * high.sums), inverse * (low.below * low.sums));
        // 1 / W and 1 / X of both pairs of edges.
        let (w_low, w_high) = (over_low * low.sums, over_high * high.sums);
        let (x_low, x_high) = (over_low * low.excesses, over_high * high.excesses);
        let along_i = (i1 * high.bend).mul_sub(w_high, i0 * low.bend * w_low) * step_j;
        let along_k = high.mixed.mul_sub(x_high, low.mixed * x_low) * (step_j * step_k);
        let factor = -2.0 * side_k * side_j;
        let along_j = if steps.is_some() {
            // The same edges as pairs along i: inside the cuboid nothing cancels, so that the
            // gradient keeps its digits where it vanishes, around the centre.
            let (r, excesses) = ([low_r, high_r], [low_excesses, high_excesses]);
            let across = |side: usize| EdgePair { r: [r[0][side], r[1][side]] };
            let own = |side: usize| across(side).terms([excesses[0][side], excesses[1][side]], step_i, side_k);
            let (low, high) = (own(0), own(1));
            let inverse = N::splat(simd, 1.0).over(low.below * high.below);
            let along_j = (j1 * high.bend).mul_sub(inverse * low.below, j0 * low.bend * (inverse * high.below));
            along_j * step_i * (-2.0 * side_k * self.sides[i])
        } else {
            // Close to the nearer plane its edge dominates, and its offset is small.
            let nearer = step_j.where_at_least(0.0, j1, j0) * step_j;
            let (low_j, high_j) = (nearer.mul_sub(low.bend, low.rest), nearer.mul_sub(high.bend, high.rest));
            high_j.mul_sub(w_high, low_j * w_low) * factor
        };
        [along_i * factor, along_j, along_k * (0.5 * factor)]
    }

    /// 4 pi T_bbc, 4 pi T_bcc and 4 pi T_abc of a rod, by differentiation of its T_bc.
    #[inline(always)]
    fn edges_of_rod<N: Number>(&self, simd: N::Instructions, place: &CornerGeometry<N>) -> [N; 3] {
        let zero = Differentiated::<N>::splat(simd, 0.0);
        let mut planes = [[[zero; 2]; 2]; 3];
        for (axis, (planes, from)) in planes.iter_mut().zip(&place.planes).enumerate() {
            for (plane, [offset, square]) in planes.iter_mut().zip(from) {
                let offset = Differentiated::coordinate(simd, *offset, axis);
                *plane = [offset, offset * offset];
                plane[1].value = *square;
            }
        }
        let mut distances = [zero; 8];
        for (corner, (distance, r)) in distances.iter_mut().zip(&place.distances).enumerate() {
            let over = N::splat(simd, 1.0).over(*r);
            let slope = [
                place.planes[0][corner >> 2][0] * over,
                place.planes[1][corner >> 1 & 1][0] * over,
                place.planes[2][corner & 1][0] * over,
            ];
            *distance = Differentiated { value: *r, slope };
        }
        let [_, b, c] = self.sides;
        let (mut factors, mut squares) = ([0.0; 6], [0.0; 3]);
        (factors[BC], factors[BB], squares[2]) = (b * c, b * c, c * c);
        let [[n, m], _] = ratios_of_rod(simd, &CornerGeometry { planes, distances }, &factors, &squares);
        let rate = N::splat(simd, 2.0).over((m.value - n.value) * (m.value + n.value));
        let mut slopes = [rate; 3];
        for (slope, (n_slope, m_slope)) in slopes.iter_mut().zip(n.slope.into_iter().zip(m.slope)) {
            *slope = rate * n_slope.mul_sub(m.value, n.value * m_slope);
        }
        let [a, b, c] = slopes;
        [b, c, a]
    }
}

/// The two edges on one side along i: distances from their ends, by the side along j.
struct EdgePair<N> {
    r: [[N; 2]; 2],
}

/// The terms of Eqs. P42 to P44 of one side along i.
struct PairTerms<N> {
    /// K.
    bend: N,
    /// S u_0 u_1 of the edge farther along j, times P Q of the nearer edge.
    rest: N,
    /// M.
    mixed: N,
    /// W.
    below: N,
    /// S_0 S_1.
    sums: N,
    /// Q_0 Q_1.
    excesses: N,
}

impl<N: Number> EdgePair<N> {
    #[inline(always)]
    fn terms(&self, [q0, q1]: [N; 2], step_j: N, length: f64) -> PairTerms<N> {
        let [[r00, r01], [r10, r11]] = self.r;
        let (s0, s1) = (r00 + r01, r10 + r11);
        let (p0, p1) = (r00 * r01, r10 * r11);
        let (u0, u1) = (r00 + r10, r01 + r11);
        let common = (u0 + u1) * p0;
        let cross = r11.mul_add(u1, r00 * u0);
        let (sums, uu, excesses) = (s0 * s1, u0 * u1, q0 * q1);
        PairTerms {
            bend: common.mul_add(sums - -(length * length), (s0 * cross) * q1),
            rest: step_j.where_at_least(0.0, s0 * (p1 * q1), s1 * (p0 * q0)) * uu,
            mixed: s1.mul_add(cross, common),
            below: uu * (p0 * p1) * excesses,
            sums,
            excesses,
        }
    }
}

/// Position of points along the edges of an axis.
struct Beside<N> {
    /// Distances along the axis from the planes through both ends.
    heights: [N; 2],
    /// Twice the distance beyond the nearer end; zero beside the edge.
    overhang: N,
}

impl<N: Number> Beside<N> {
    /// Offsets from the low and the high end.
    #[inline(always)]
    fn new(simd: N::Instructions, [low, high]: [N; 2]) -> Beside<N> {
        let zero = N::splat(simd, 0.0);
        let (below, above) = (zero - low, zero - high);
        let beyond = high.where_at_least(0.0, high, below.where_at_least(0.0, below, zero));
        Beside {
            heights: [low.where_at_least(0.0, low, below), high.where_at_least(0.0, high, above)],
            overhang: beyond * 2.0,
        }
    }

    /// S^2 - l^2 of an edge at the distance `rho`, without cancellation.
    #[inline(always)]
    fn excess(&self, [r_low, r_high]: [N; 2], rho_squared: N, length: f64) -> N {
        let (a, b) = (r_low + self.heights[0], r_high + self.heights[1]);
        let product = a * b;
        let minus = rho_squared.mul_add(a + b, self.overhang * product).over(product);
        minus * (r_low + r_high - -length)
    }
}

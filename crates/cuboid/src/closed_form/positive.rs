//! The elements of the demagnetizing tensor by sums of positive terms, in vectors (docs/physics.md,
//! sections 2.1 and 2.6).
//!
//! No digit is lost inside a cuboid of any shape or close to it. The logarithms lose none anywhere.

use super::elements::CornerGeometry;
use magsplice_simd::functions::{Functions, logarithm_of_tangent_or_ratio};
use magsplice_simd::lanes::Number;

/// Position of points relative to a cuboid, mirrored into the octant beyond its centre.
#[derive(Clone, Copy)]
pub struct Octant<N> {
    /// Offsets from the nearer and the farther face along each axis; the nearer offset is negative
    /// between the faces.
    pub faces: [[N; 2]; 3],
    /// Twice the offsets from the centre.
    pub steps: [N; 3],
    /// -1 where the point was mirrored, else 1.
    pub signs: [N; 3],
    /// Distances from the corners; the bit of an axis is set for its farther face.
    pub distances: [N; 8],
    /// Sides of the cuboid.
    pub size: [f64; 3],
}

impl<N: Number> Octant<N> {
    /// Mirrors points with these offsets from the low and the high faces. `steps` are twice the
    /// offsets from the centre.
    #[inline(always)]
    pub fn new(simd: N::Instructions, offsets: [[N; 2]; 3], steps: [N; 3], size: [f64; 3]) -> Octant<N> {
        let (zero, one) = (N::splat(simd, 0.0), N::splat(simd, 1.0));
        let mut place = Octant { faces: offsets, steps, signs: [one; 3], distances: [zero; 8], size };
        for axis in 0..3 {
            let ([low, high], step) = (offsets[axis], steps[axis]);
            place.faces[axis] =
                [step.where_at_least(0.0, high, zero - low), step.where_at_least(0.0, low, zero - high)];
            place.steps[axis] = step.where_at_least(0.0, step, zero - step);
            place.signs[axis] = step.where_at_least(0.0, one, zero - one);
        }
        for (corner, distance) in place.distances.iter_mut().enumerate() {
            let [x, y, z] = [place.faces[0][corner & 1], place.faces[1][corner >> 1 & 1], place.faces[2][corner >> 2]];
            *distance = x.mul_add(x, y.mul_add(y, z * z)).root(simd);
        }
        place
    }

    /// Mirrors points outside a cuboid with these offsets from its planes and distances from its
    /// corners.
    #[inline(always)]
    pub fn from_corners(simd: N::Instructions, from: &CornerGeometry<N>, size: [f64; 3]) -> Octant<N> {
        let (zero, one) = (N::splat(simd, 0.0), N::splat(simd, 1.0));
        let r = from.distances;
        let mut place = Octant {
            faces: [[zero; 2]; 3],
            steps: [zero; 3],
            signs: [one; 3],
            // The bits of axes increase here and decrease there.
            distances: [r[0], r[4], r[2], r[6], r[1], r[5], r[3], r[7]],
            size,
        };
        for axis in 0..3 {
            let [[low, _], [high, _]] = from.planes[axis];
            let step = low + high;
            place.faces[axis] =
                [step.where_at_least(0.0, high, zero - low), step.where_at_least(0.0, low, zero - high)];
            place.steps[axis] = step.where_at_least(0.0, step, zero - step);
            place.signs[axis] = step.where_at_least(0.0, one, zero - one);
            for corner in (0..8).filter(|corner| corner & 1 << axis == 0) {
                let (low, high) = (place.distances[corner], place.distances[corner | 1 << axis]);
                place.distances[corner] = step.where_at_least(0.0, high, low);
                place.distances[corner | 1 << axis] = step.where_at_least(0.0, low, high);
            }
        }
        place
    }

    /// far^2 - near^2.
    #[inline(always)]
    pub(super) fn square_step(&self, axis: usize) -> N {
        self.steps[axis] * self.size[axis]
    }

    /// 2 pi |T_ij| from the edges along k (Eqs. P5 to P9): numerator and denominator of its
    /// hyperbolic tangent, and of its exponential squared.
    #[inline(always)]
    pub fn edges(&self, simd: N::Instructions, [i, j, k]: [usize; 3]) -> [[N; 2]; 2] {
        let (zero, length) = (N::splat(simd, 0.0), N::splat(simd, self.size[k]));
        let corner = |bi: usize, bj: usize, bk: usize| bi << i | bj << j | bk << k;
        let r = &self.distances;
        let [near_k, far_k] = self.faces[k];
        let beside = near_k.where_at_least(0.0, near_k, zero - near_k);
        let overhang = near_k.where_at_least(0.0, near_k * 2.0, zero);
        let (mut minus, mut sums, mut plus) = ([[zero; 2]; 2], [[zero; 2]; 2], [[zero; 2]; 2]);
        for bi in 0..2 {
            for bj in 0..2 {
                let (first, second) = (r[corner(bi, bj, 0)], r[corner(bi, bj, 1)]);
                let (x, y) = (self.faces[i][bi], self.faces[j][bj]);
                let (a, b) = (first + beside, second + far_k);
                minus[bi][bj] = (x.mul_add(x, y * y) * (a + b)).over(a * b) + overhang;
                sums[bi][bj] = first + second;
                plus[bi][bj] = sums[bi][bj] + length;
            }
        }
        // Increments of S along i and along j, and its negative mixed second difference.
        let (d_i, d_j) = (self.square_step(i), self.square_step(j));
        let (mut a, mut step_j, mut bend) = ([zero; 2], [zero; 2], zero);
        for bk in 0..2 {
            let along_i = [r[corner(0, 0, bk)] + r[corner(1, 0, bk)], r[corner(0, 1, bk)] + r[corner(1, 1, bk)]];
            let along_j = [r[corner(0, 0, bk)] + r[corner(0, 1, bk)], r[corner(1, 0, bk)] + r[corner(1, 1, bk)]];
            let per_i = d_i.over(along_i[0] * along_i[1]);
            let per_j = d_j.over(along_j[0] * along_j[1]);
            a = [per_i.mul_add(along_i[1], a[0]), per_i.mul_add(along_i[0], a[1])];
            let (first, second) = (per_j * along_j[1], per_j * along_j[0]);
            step_j = [step_j[0] + first, step_j[1] + second];
            bend = per_i.mul_add(first + second, bend);
        }
        let b = [minus[0][0].mul_add(plus[1][0], length * a[0]), minus[0][1].mul_add(plus[1][1], length * a[1])];
        let b_step = step_j[0].mul_add(sums[1][1], sums[0][0] * step_j[1]);
        let numerator = length * a[0].mul_add(b_step, b[0] * bend);
        let denominator = (minus[0][0] * plus[1][0]).mul_add(b[1], length * a[0] * (minus[0][1] * plus[1][1]));
        let above = (plus[0][0] * plus[1][1]) * (minus[0][1] * minus[1][0]);
        let below = (minus[0][0] * minus[1][1]) * (plus[0][1] * plus[1][0]);
        [[numerator, denominator], [above, below]]
    }
}

impl<N: Functions> Octant<N> {
    /// 2 pi T_ij.
    #[inline(always)]
    pub fn off_diagonal(&self, simd: N::Instructions, [i, j, k]: [usize; 3]) -> N {
        let [tangent, ratio] = self.edges(simd, [i, j, k]);
        logarithm_of_tangent_or_ratio(simd, tangent, ratio) * (self.signs[i] * self.signs[j])
    }

    /// 4 pi T_xx as a sum of arctangents of y z / (x R) over the corners. The difference over z,
    /// the axis of the shortest side, is taken before the arctangent: z R' - z' R = (x^2 + y^2)
    /// (z^2 - z'^2) / (z R' + z' R).
    #[inline(always)]
    pub fn diagonal(&self, simd: N::Instructions, [x, y, z]: [usize; 3]) -> N {
        let zero = N::splat(simd, 0.0);
        let [z_near, z_far] = self.faces[z];
        let product = z_near * z_far;
        let mut sum = zero;
        for bx in 0..2 {
            for by in 0..2 {
                let corner = bx << x | by << y;
                let (near, far) = (self.distances[corner], self.distances[corner | 1 << z]);
                let (own, other) = (self.faces[x][bx], self.faces[y][by]);
                let (own_square, other_square) = (own * own, other * other);
                let (first, second) = (z_near * far, z_far * near);
                // Between the faces both terms have one sign.
                let beyond = (own_square + other_square) * self.square_step(z);
                let divisor = z_near.where_at_least(0.0, first + second, N::splat(simd, 1.0));
                let difference = z_near.where_at_least(0.0, beyond.over(divisor), second - first);
                let re = own_square.mul_add(near * far, other_square * product);
                let angle = N::angle(simd, re, own * other * difference).divided(simd);
                sum = if bx == by { sum - angle } else { sum + angle };
            }
        }
        sum
    }
}

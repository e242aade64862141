//! The elements T_bc and T_bb of a rod, whose longest side is along a (docs/physics.md, section
//! 2.6).
//!
//! A rod is the difference of two half-infinite rods that begin at its ends. The differences along
//! b and c are taken before the logarithm and the arctangent, so that the error does not grow with
//! the distance over these sides. The remaining difference of the two ends loses a factor of
//! distance over the longest side.

use magsplice_simd::lanes::Number;

use super::elements::CornerGeometry;
use super::terms::{BB, BC};

/// The numerators and denominators of T_bc and T_bb, in the form of [`CornerGeometry::ratio`] for
/// the other elements.
///
/// `factors` and `squares` come from [`Terms`](super::terms::Terms).
#[inline(always)]
pub fn ratios_of_rod<N: Number>(
    simd: N::Instructions,
    place: &CornerGeometry<N>,
    factors: &[f64; 6],
    squares: &[f64; 3],
) -> [[N; 2]; 2] {
    let (r, [[a0, a1], [b0, b1], [c0, c1]]) = (&place.distances, place.planes);
    let zero = N::splat(simd, 0.0);
    // Coordinates of the ends along a, relative to the point and mirrored so that the second is
    // positive and not nearer.
    let middle = a0[0] + a1[0];
    let near_end = middle.where_at_least(0.0, a1[0], zero - a0[0]);
    let far_end = middle.where_at_least(0.0, a0[0], zero - a1[0]);
    let mut near = [zero; 4];
    let mut far = [zero; 4];
    for corner in 0..4 {
        near[corner] = middle.where_at_least(0.0, r[4 + corner], r[corner]);
        far[corner] = middle.where_at_least(0.0, r[corner], r[4 + corner]);
    }
    // R + x along each edge of a half-infinite rod that begins at x; (y^2 + z^2) / (R - x) beside
    // it.
    let from_edges = [b0[1] + c0[1], b0[1] + c1[1], b1[1] + c0[1], b1[1] + c1[1]];
    let beside = near_end.where_at_least(0.0, near_end, zero - near_end);
    let (mut near_sums, mut far_sums) = ([zero; 4], [zero; 4]);
    for corner in 0..4 {
        let sum = near[corner] + beside;
        near_sums[corner] = near_end.where_at_least(0.0, sum, from_edges[corner].over(sum));
        far_sums[corner] = far[corner] + far_end;
    }
    let section = CrossSection { b: [b0, b1], c_product: c0[0] * c1[0], area: factors[BB], c_side_squared: squares[2] };
    let (near, far) = (section.end(near, near_sums), section.end(far, far_sums));
    let step = (b0[0] + b1[0]) * (c0[0] + c1[0]) * factors[BC];
    let (low, high) = (near.edges[0] * step, far.edges[0] * step);
    let (angle, angle_2) = (near.faces, far.faces);
    [
        [low.mul_sub(far.edges[1], high * near.edges[1]), near.edges[1].mul_sub(far.edges[1], low * high)],
        [angle[0].mul_sub(angle_2[1], angle[1] * angle_2[0]), angle[1].mul_add(angle_2[1], angle[0] * angle_2[0])],
    ]
}

/// Position of points relative to the cross-section of a rod.
struct CrossSection<N> {
    /// Offset and its square along b.
    b: [[N; 2]; 2],
    /// Product of the offsets along c.
    c_product: N,
    /// Product of the sides, with the sign of the term.
    area: f64,
    /// Square of the side along c.
    c_side_squared: f64,
}

/// A half-infinite rod.
struct RodEnd<N> {
    /// Numerator, over the step, and denominator of the hyperbolic tangent of minus the second
    /// difference of ln(R + x) / 2 (Eq. P40).
    edges: [N; 2],
    /// Numerator and denominator of the tangent of the difference of half the solid angles of the
    /// faces normal to b (Eq. P41).
    faces: [N; 2],
}

impl<N: Number> CrossSection<N> {
    /// The half-infinite rod with distances `r` from its corners, and R + x in `sums`; at b0c0,
    /// b0c1, b1c0, b1c1.
    #[inline(always)]
    fn end(&self, r: [N; 4], sums: [N; 4]) -> RodEnd<N> {
        let (along_b, along_c) = ([r[0] + r[2], r[1] + r[3]], r[2] + r[3]);
        let product = along_b[0] * along_b[1];
        let logarithm = (along_b[0] + along_b[1]) * (sums[0] + sums[1] + along_c);
        let across = sums[0].mul_add(sums[3], sums[1] * sums[2]) * 2.0;
        let [[b0, square_0], [b1, square_1]] = self.b;
        // N of Eq. P41 at both faces, and its step over the step of y^2.
        let low = sums[0].mul_add(sums[1], square_0 + self.c_product);
        let high = sums[2].mul_add(sums[3], square_1 + self.c_product);
        let step = along_b[1].mul_add(sums[3], along_b[0].mul_add(sums[0], product));
        // Computed from the nearer face, which may be much nearer than the other.
        let middle = b0 + b1;
        let (offset, nearer) = (middle.where_at_least(0.0, b1, b0), middle.where_at_least(0.0, high, low));
        let difference = (offset * middle).mul_sub(step, nearer * product);
        RodEnd {
            edges: [logarithm, across * (r[0] + r[1]) * along_c * product],
            faces: [difference * self.area, low.mul_add(high, (b0 * b1) * self.c_side_squared) * product],
        }
    }
}

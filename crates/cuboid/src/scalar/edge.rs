//! Off-diagonal elements of the demagnetizing tensor: logarithms of the four edges parallel to an
//! axis.
//!
//! With X, Y, Z the offsets from the point to the faces, s = +1 at the near and -1 at the far face,
//!
//! ```text
//! 4 pi T_xy = sum over the 4 edges parallel to z of s_x s_y F(X, Y),
//! F(X, Y)   = integral over the edge of dw / R = ln((S + l) / (S - l)),   S = R_1 + R_2,
//! ```
//!
//! R_1 and R_2 are the distances to the two ends, and l is the length of the edge (docs/physics.md,
//! Eq. P4). The textbook second difference of logarithms loses two digits per decade of distance.
//! Here it is taken before the logarithm: F = 2 artanh(l / S), differences of artanh follow the
//! addition theorem, and every difference of S is rationalised, e.g. R_2 - R_1 = (X_2^2 - X_1^2) /
//! (R_1 + R_2). In the octant x, y, z >= 0 every term that is then added is positive, so the result
//! keeps full relative accuracy at any distance, for any aspect ratio and on every edge extension
//! (docs/physics.md, Eqs. P6 to P9).

use super::number::Scalar;
use super::offsets::Offsets;
use crate::tolerances::ARTANH_TO_PRODUCT;

/// 4 pi |T_ij| of the tile, from the edges parallel to axis `k`. It is never negative; the octant
/// of the point gives the sign.
///
/// `radius` holds the distances to the eight corners; the bit of an axis is set for its far face.
pub(super) fn edge_logarithm<S: Scalar>(offsets: &[Offsets<S>; 3], radius: &[S; 8], [i, j, k]: [usize; 3]) -> S {
    let length = S::constant(offsets[k].size);
    let corner = |bi: usize, bj: usize, bk: usize| radius[bi << i | bj << j | bk << k];
    let (near_k, far_k) = (offsets[k].near, offsets[k].far);
    let overhang = if near_k.value() > 0.0 { near_k.scale(2.0) } else { S::constant(0.0) };

    // S - l and S + l of the edge (bi, bj).
    let excess = |bi: usize, bj: usize| {
        let rho_squared = offsets[i].face(bi).square() + offsets[j].face(bj).square();
        rho_squared * sum_of_reciprocals(corner(bi, bj, 0) + near_k.abs(), corner(bi, bj, 1) + far_k) + overhang
    };
    let sum = |bi: usize, bj: usize| corner(bi, bj, 0) + corner(bi, bj, 1);
    let minus = [[excess(0, 0), excess(0, 1)], [excess(1, 0), excess(1, 1)]];
    let sums = [[sum(0, 0), sum(0, 1)], [sum(1, 0), sum(1, 1)]];
    let plus = sums.map(|row| row.map(|s| s + length));

    // Increments of S along i and along j, and the negative mixed second difference of S, end by
    // end of the edges: R rises along i by D_i / (R_0 + R_1).
    let end = |bk: usize| {
        let along_i = [0, 1].map(|bj| corner(0, bj, bk) + corner(1, bj, bk));
        let along_j = [0, 1].map(|bi| corner(bi, 0, bk) + corner(bi, 1, bk));
        let per_i = offsets[i].square_step().over(along_i[0] * along_i[1]);
        let per_j = offsets[j].square_step().over(along_j[0] * along_j[1]);
        let step_i = [per_i * along_i[1], per_i * along_i[0]];
        let step_j = [per_j * along_j[1], per_j * along_j[0]];
        (step_i, step_j, per_i * (step_j[0] + step_j[1]))
    };
    let ((near_i, near_j, near_bend), (far_i, far_j, far_bend)) = (end(0), end(1));
    let step_j = [near_j[0] + far_j[0], near_j[1] + far_j[1]];
    let bend = near_bend + far_bend;

    // First difference, along i: artanh(l A_j / B_j), B_j = S_0j S_1j - l^2.
    let a = [near_i[0] + far_i[0], near_i[1] + far_i[1]];
    let b = [0, 1].map(|bj| minus[0][bj] * plus[1][bj] + length * a[bj]);
    let b_step = step_j[0] * sums[1][1] + sums[0][0] * step_j[1];
    // Second difference, along j.
    let numerator = length * (a[0] * b_step + b[0] * bend);
    let denominator = minus[0][0] * plus[1][0] * b[1] + length * a[0] * minus[0][1] * plus[1][1];
    if numerator.value() < ARTANH_TO_PRODUCT * denominator.value() {
        numerator.scale(2.0).over(denominator - numerator).ln_1p()
    } else {
        let above = plus[0][0] * plus[1][1] * minus[0][1] * minus[1][0];
        let below = minus[0][0] * minus[1][1] * plus[0][1] * plus[1][0];
        above.over(below).ln()
    }
}

/// 1 / a + 1 / b with one division.
fn sum_of_reciprocals<S: Scalar>(a: S, b: S) -> S {
    (a + b).over(a * b)
}

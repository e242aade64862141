//! Off-diagonal elements of the demagnetizing tensor: logarithms of the four edges parallel to an axis.
//!
//! With X, Y, Z the offsets from the point to the faces, s = +1 at the near and -1 at the far face,
//!
//! ```text
//! 4 pi T_xy = sum over the 4 edges parallel to z of s_x s_y F(X, Y),
//! F(X, Y)   = integral over the edge of dw / R = ln((S + l) / (S - l)),   S = R_1 + R_2,
//! ```
//!
//! R_1, R_2 the distances to the two ends and l the length of the edge (docs/physics.md, Eq. P4). The textbook
//! second difference of logarithms loses two digits per decade of distance. Here it is taken before the logarithm:
//! F = 2 artanh(l / S), differences of artanh follow the addition theorem, and every difference of S is rationalised,
//! e.g. R_2 - R_1 = (X_2^2 - X_1^2) / (R_1 + R_2). In the octant x, y, z >= 0 every term that is then added is positive,
//! so the result keeps full relative accuracy at any distance, for any aspect ratio and on every edge extension
//! (docs/physics.md, Eqs. P6 to P9).

use super::offsets::Offsets;
use super::scalar::Scalar;
use crate::tolerances::ARTANH_TO_PRODUCT;

/// 4 pi |T_ij| of the tile, from the edges parallel to axis `k`, and never negative; the sign is that of the octant.
///
/// `radius` holds the distances to the eight corners, the bit of an axis set for its far face.
pub(crate) fn edge_logarithm<S: Scalar>(offsets: &[Offsets<S>; 3], radius: &[S; 8], [i, j, k]: [usize; 3]) -> S {
    let length = S::constant(offsets[k].size);
    let corner = |bi: usize, bj: usize, bk: usize| radius[bi << i | bj << j | bk << k];
    let (near_k, far_k) = (offsets[k].near, offsets[k].far);
    let overhang = if near_k.value() > 0.0 { near_k.scale(2.0) } else { S::constant(0.0) };

    // S - l and S + l of the edge (bi, bj).
    let excess = |bi: usize, bj: usize| {
        let rho_squared = offsets[i].face(bi).square() + offsets[j].face(bj).square();
        let near = (corner(bi, bj, 0) + near_k.abs()).recip();
        let far = (corner(bi, bj, 1) + far_k).recip();
        rho_squared * (near + far) + overhang
    };
    let sum = |bi: usize, bj: usize| corner(bi, bj, 0) + corner(bi, bj, 1);
    let minus = [[excess(0, 0), excess(0, 1)], [excess(1, 0), excess(1, 1)]];
    let sums = [[sum(0, 0), sum(0, 1)], [sum(1, 0), sum(1, 1)]];
    let plus = sums.map(|row| row.map(|s| s + length));

    // Increments of the corner distances along i and along j, and of S.
    let square_step_i = offsets[i].square_step();
    let square_step_j = offsets[j].square_step();
    let pair_i = |bj: usize, bk: usize| corner(0, bj, bk) + corner(1, bj, bk);
    let pair_j = |bi: usize, bk: usize| corner(bi, 0, bk) + corner(bi, 1, bk);
    let step_i = |bj: usize| square_step_i * (pair_i(bj, 0).recip() + pair_i(bj, 1).recip());
    let step_j_at = |bi: usize, bk: usize| square_step_j.over(pair_j(bi, bk));
    let step_j = |bi: usize| step_j_at(bi, 0) + step_j_at(bi, 1);
    // step_i(0) - step_i(1), the negative mixed second difference of S.
    let bend_at = |bk: usize| square_step_i * (step_j_at(0, bk) + step_j_at(1, bk)).over(pair_i(0, bk) * pair_i(1, bk));
    let bend = bend_at(0) + bend_at(1);

    // First difference, along i: artanh(l A_j / B_j), B_j = S_0j S_1j - l^2.
    let a = [step_i(0), step_i(1)];
    let b = [0, 1].map(|bj| minus[0][bj] * plus[1][bj] + length * a[bj]);
    let b_step = step_j(0) * sums[1][1] + sums[0][0] * step_j(1);
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

//! The mean demagnetizing tensor of two boxes with parallel edges, in closed form.
//!
//! A. J. Newell, W. Williams, D. J. Dunlop, "A generalization of the demagnetizing tensor for
//! nonuniform magnetization", J. Geophys. Res. 98 (1993) 9551, for boxes of different sizes: the
//! second differences of their functions f and g become sums over the 64 differences of corners.
//! With r = |u|, L_a = artanh(u_a / r) and A_a = arctan(u_b u_c / (u_a r)), their functions are
//!
//! ```text
//! 6 f_a  = 3 u_b (u_c^2 - u_a^2) L_b + 3 u_c (u_b^2 - u_a^2) L_c - 6 u_a u_b u_c A_a
//!          - (u_b^2 + u_c^2 - 2 u_a^2) r
//! 6 g_ab = u_b (3 u_c^2 - u_b^2) L_a + u_a (3 u_c^2 - u_a^2) L_b + 6 u_a u_b u_c L_c
//!          - u_c (3 u_a^2 A_a + 3 u_b^2 A_b + u_c^2 A_c) - 2 u_a u_b r
//! ```
//!
//! Where L or A have no value their polynomials vanish, and so does the limit of the product: any
//! finite value of them does.

use std::f64::consts::PI;

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::DVec3;
use magsplice_simd::functions::{angle, half_logarithm_of_ratio};
use magsplice_simd::lanes::{LONGEST_VECTOR, Lanes, Number};

use crate::symmetric_tensor::SymmetricTensor;

/// The functions f and g of Newell et al. are multiplied by this.
const DENOMINATOR: f64 = 6.0;

/// Number of differences of corners.
const CORNERS: usize = 64;

/// Added to denominators: below every square and product of lengths that has an effect.
const TINY: f64 = 1e-290;

/// The tensor that takes the polarization of the source to minus the mean of mu0 H over the
/// receiver. `offset` leads from the centre of the source to that of the receiver. Lengths are at
/// most 1.
pub(crate) fn mean_tensor(receiver: DVec3, source: DVec3, offset: DVec3) -> SymmetricTensor {
    let differences = [0, 1, 2].map(|axis: usize| {
        let (sum, difference) = (0.5 * (receiver + source)[axis], 0.5 * (receiver - source)[axis]);
        // Differences of faces: both lower, both upper, and mixed, which have the sign -1.
        [offset[axis] - difference, offset[axis] + difference, offset[axis] - sum, offset[axis] + sum]
    });
    let faces = |corner: usize| [corner >> 4, corner >> 2 & 3, corner & 3];
    let along = |axis: usize| std::array::from_fn(|corner| differences[axis][faces(corner)[axis]]);
    let sign = |corner: usize| {
        let mixed = faces(corner).into_iter().filter(|face| *face >= 2).count();
        if mixed.is_multiple_of(2) { 1.0 } else { -1.0 }
    };
    let corners = [along(0), along(1), along(2), std::array::from_fn(sign)];
    let sums = dispatch!(Level::new(), simd => sums(simd, &corners));
    let total = SymmetricTensor {
        diagonal: DVec3::new(sums[0], sums[1], sums[2]),
        off_diagonal: DVec3::new(sums[3], sums[4], sums[5]),
    };
    total * (1.0 / (DENOMINATOR * 4.0 * PI * receiver.element_product()))
}

/// The sums of 6 f_a and 6 g_bc over the differences of corners, with their signs.
///
/// Closures are not inlined everywhere, and calls of vector operations cost more than these.
#[inline(always)]
fn sums<S: Simd>(simd: S, corners: &[[f64; CORNERS]; 4]) -> [f64; 6] {
    let mut sums = [Lanes::<S>::splat(simd, 0.0); 6];
    for start in (0..CORNERS).step_by(Lanes::<S>::LEN) {
        let end = start + Lanes::<S>::LEN;
        let u = [
            Lanes::load(simd, &corners[0][start..end]),
            Lanes::load(simd, &corners[1][start..end]),
            Lanes::load(simd, &corners[2][start..end]),
        ];
        let sign = Lanes::load(simd, &corners[3][start..end]);
        let values = functions(simd, u);
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum = value.mul_add(sign, *sum);
        }
    }
    let mut totals = [0.0; 6];
    for (total, sum) in totals.iter_mut().zip(sums) {
        let mut lanes = [0.0; LONGEST_VECTOR];
        sum.store(&mut lanes[..Lanes::<S>::LEN]);
        *total = lanes.iter().sum();
    }
    totals
}

/// 6 f_a, then 6 g_bc across each axis, of differences of corners.
#[inline(always)]
fn functions<S: Simd>(simd: S, u: [Lanes<S>; 3]) -> [Lanes<S>; 6] {
    let zero = Lanes::<S>::splat(simd, 0.0);
    let tiny = Lanes::<S>::splat(simd, TINY);
    let s = [u[0] * u[0], u[1] * u[1], u[2] * u[2]];
    let r = (s[0] + s[1] + s[2]).sqrt();
    let (mut l, mut t, mut st) = ([zero; 3], [zero; 3], [zero; 3]);
    for a in 0..3 {
        let (b, c) = ((a + 1) % 3, (a + 2) % 3);
        let (magnitude, sign) = (u[a].abs(), u[a].sign(simd));
        let end = r + magnitude;
        l[a] = half_logarithm_of_ratio(simd, end * end + tiny, s[b] + s[c] + tiny) * sign;
        t[a] = angle(simd, magnitude * r + tiny, u[b] * u[c]) * sign;
        st[a] = s[a] * t[a];
    }
    let volume = u[0] * u[1] * u[2];
    let mut values = [zero; 6];
    for a in 0..3 {
        let (b, c) = ((a + 1) % 3, (a + 2) % 3);
        values[a] = (u[b] * (s[c] - s[a]) * l[b] + u[c] * (s[b] - s[a]) * l[c]) * 3.0
            - volume * t[a] * 6.0
            - (s[b] + s[c] - s[a] * 2.0) * r;
        // Of the axes b and c, across a.
        values[3 + a] = u[c] * (s[a] * 3.0 - s[c]) * l[b] + u[b] * (s[a] * 3.0 - s[b]) * l[c] + volume * l[a] * 6.0
            - u[a] * ((st[b] + st[c]) * 3.0 + st[a])
            - u[b] * u[c] * r * 2.0;
    }
    values
}

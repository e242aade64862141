//! The functions of the distance of two corners whose sums are tensors, forces and torques.
//!
//! G(u, v, w) is the function with d^6 G / (du^2 dv^2 dw^2) = 1 / r. The interaction energy of two
//! charged boxes is a sum of G over the 64 differences of their corners. The energy of polarized
//! boxes and their mean tensor are sums of second derivatives, which are the functions f and g of
//! Newell, Williams and Dunlop (1993). Forces are sums of third derivatives [Akoun and Yonnet 1984;
//! Yonnet and Allag 2009]. Torques need integrals of third derivatives along one axis, for the
//! lever.
//!
//! With u = (u_x, u_y, u_z), r = |u|, L_a = artanh(u_a / r) and A_a = arctan(u_b u_c / (u_a r)),
//! every function here is a sum of products of polynomials with L, A and r. Products whose
//! polynomial vanishes on the line where L is infinite are zero there: their limit.

use fearless_simd::prelude::*;
use magsplice_simd::functions::{angle, half_logarithm_of_ratio};
use magsplice_simd::lanes::{Lanes, Number};

use crate::real::{Arithmetic, Real};

/// Factor of every function, for which most coefficients are integers.
pub(crate) const MULTIPLIER: f64 = 6.0;

/// Added to denominators in vectors: below every square and product of lengths that has an effect.
const TINY: f64 = 1e-290;

/// Difference of two corners, with its logarithms and arctangents.
pub(crate) struct CornerDifference<N> {
    u: [N; 3],
    squares: [N; 3],
    volume: N,
    r: N,
    log: [N; 3],
    angle: [N; 3],
}

impl<N: Real> CornerDifference<N> {
    /// A difference of corners. `sides` holds the sign of each zero coordinate, for the side from
    /// which the corners approached each other.
    pub(crate) fn new(u: [N; 3], sides: [f64; 3]) -> CornerDifference<N> {
        let squares = u.map(N::squared);
        let r = (squares[0] + squares[1] + squares[2]).sqrt();
        let log = [0, 1, 2].map(|a: usize| {
            let (b, c) = others(a);
            let across = squares[b] + squares[c];
            if u[a].is_zero() || across.is_zero() {
                return N::ZERO;
            }
            let half = ((u[a].abs() + r).squared() / across).ln().scaled(0.5);
            if u[a].to_f64() < 0.0 { -half } else { half }
        });
        let angle = [0, 1, 2].map(|a: usize| {
            let (b, c) = others(a);
            let area = u[b] * u[c];
            if area.is_zero() {
                return N::ZERO;
            }
            let sign = if u[a].is_zero() { sides[a] } else { u[a].to_f64() };
            let angle = if u[a].is_zero() { N::HALF_PI } else { N::arctangent(area.abs(), u[a].abs() * r) };
            if (sign < 0.0) == (area.to_f64() < 0.0) { angle } else { -angle }
        });
        let volume = u[0] * u[1] * u[2];
        CornerDifference { u, squares, volume, r, log, angle }
    }
}

impl<S: Simd> CornerDifference<Lanes<S>> {
    /// A difference of corners in each lane, of lengths up to about 1.
    ///
    /// Where L or A are undefined their polynomials in second derivatives vanish, and so does the
    /// limit of the product. Any finite value serves there.
    #[inline(always)]
    pub(crate) fn in_lanes(simd: S, u: [Lanes<S>; 3]) -> CornerDifference<Lanes<S>> {
        let (zero, tiny) = (Lanes::<S>::splat(simd, 0.0), Lanes::<S>::splat(simd, TINY));
        let squares = [u[0] * u[0], u[1] * u[1], u[2] * u[2]];
        let r = (squares[0] + squares[1] + squares[2]).sqrt();
        let (mut log, mut angles) = ([zero; 3], [zero; 3]);
        for a in 0..3 {
            let (b, c) = others(a);
            let (magnitude, sign) = (u[a].abs(), u[a].sign(simd));
            let end = r + magnitude;
            log[a] = half_logarithm_of_ratio(simd, end * end + tiny, squares[b] + squares[c] + tiny) * sign;
            angles[a] = angle(simd, magnitude * r + tiny, u[b] * u[c]) * sign;
        }
        CornerDifference { u, squares, volume: u[0] * u[1] * u[2], r, log, angle: angles }
    }
}

impl<N: Arithmetic> CornerDifference<N> {
    /// d^2 G / (du_a du_b), times [`MULTIPLIER`].
    #[inline(always)]
    pub(crate) fn second(&self, a: usize, b: usize) -> N {
        let (u, s, l, t) = (&self.u, &self.squares, &self.log, &self.angle);
        if a == b {
            let (p, q) = others(a);
            let logs = u[p] * (s[q] - s[a]) * l[p] + u[q] * (s[p] - s[a]) * l[q];
            let root = (s[p] + s[q] - s[a].scaled(2.0)) * self.r;
            return logs.times(3.0) - (self.volume * t[a]).times(6.0) - root;
        }
        let q = 3 - a - b;
        let logs = u[b] * (s[q].times(3.0) - s[b]) * l[a] + u[a] * (s[q].times(3.0) - s[a]) * l[b];
        let angles = (s[a] * t[a] + s[b] * t[b]).times(3.0) + s[q] * t[q];
        logs + (self.volume * l[q]).times(6.0) - angles * u[q] - (u[a] * u[b] * self.r).scaled(2.0)
    }

    /// d^3 G / (du_a du_b du_c), times [`MULTIPLIER`].
    pub(crate) fn third(&self, a: usize, b: usize, c: usize) -> N {
        let (u, s, l, t) = (&self.u, &self.squares, &self.log, &self.angle);
        match twice_and_once(a, b, c) {
            Some((a, b)) if a == b => {
                let (p, q) = others(a);
                let along = u[a] * (u[p] * l[p] + u[q] * l[q] - self.r);
                (along + u[p] * u[q] * t[a]).times(-6.0)
            }
            Some((a, b)) => {
                let q = 3 - a - b;
                let logs = (s[q] - s[a]) * l[b] + (u[b] * u[q] * l[q]).scaled(2.0);
                (logs - (u[a] * u[q] * t[a]).scaled(2.0) - self.r * u[b]).times(3.0)
            }
            None => {
                let logs = u[1] * u[2] * l[0] + u[2] * u[0] * l[1] + u[0] * u[1] * l[2];
                let angles = s[0] * t[0] + s[1] * t[1] + s[2] * t[2];
                (logs.scaled(2.0) - angles).times(3.0)
            }
        }
    }

    /// The integral of d^3 G / (du_a du_b du_c) along u_k, with k different from a, b and c, times
    /// [`MULTIPLIER`].
    pub(crate) fn third_along(&self, [a, b, c]: [usize; 3], k: usize) -> N {
        let (u, s, l, t) = (&self.u, &self.squares, &self.log, &self.angle);
        let Some((a, b)) = twice_and_once(a, b, c) else {
            unreachable!("three axes of which none is k are not all different");
        };
        if a == b {
            let p = 3 - a - k;
            let angle = u[p] * (s[a] - s[k]) * t[a];
            let along = u[a] * (s[a] - s[p] - s[k].scaled(2.0)) * l[k];
            return angle.times(3.0) - (self.volume * l[p]).times(6.0)
                + along.times(1.5)
                + (u[a] * u[k] * self.r).times(4.5);
        }
        let angle = u[a] * (s[a] - s[k].times(3.0)) * t[a];
        let across = u[k] * (s[k] - s[a].times(3.0)) * l[b];
        let along = u[b] * (s[k].times(6.0) - s[b] - s[a].times(3.0)) * l[k];
        angle + across + along.scaled(0.5) - (u[b] * u[k] * self.r).times(2.5)
    }
}

/// The two other axes.
#[inline(always)]
fn others(axis: usize) -> (usize, usize) {
    ((axis + 1) % 3, (axis + 2) % 3)
}

/// The axis that occurs at least twice, and the remaining one; `None` if all differ.
fn twice_and_once(a: usize, b: usize, c: usize) -> Option<(usize, usize)> {
    if a == b {
        Some((a, c))
    } else if a == c {
        Some((a, b))
    } else if b == c {
        Some((b, a))
    } else {
        None
    }
}

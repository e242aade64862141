//! The functions of the distance of two corners whose sums are forces and torques.
//!
//! G(u, v, w) is the function with d^6 G / (du^2 dv^2 dw^2) = 1 / r. The interaction energy of two
//! charged boxes is a sum of G over the 64 differences of their corners, that of polarized boxes a
//! sum of second derivatives, and forces are sums of third derivatives [Akoun and Yonnet 1984;
//! Yonnet and Allag 2009]. Torques need integrals of these along one axis, for the lever.
//!
//! With u = (u_x, u_y, u_z), r = |u|, L_a = artanh(u_a / r) and A_a = arctan(u_b u_c / (u_a r)),
//! every function here is a sum of products of polynomials with L, A and r. All are multiplied by
//! 12, which makes their coefficients integers. Products whose polynomial vanishes on the line
//! where L is infinite are zero there: their limit.

use crate::real::Real;

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
    /// A difference of corners. `sides` holds the sign of each coordinate that is zero: that of the
    /// side from which the corners approached each other.
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

    /// 12 d^2 G / (du_a du_b).
    pub(crate) fn second(&self, a: usize, b: usize) -> N {
        let (u, s, l, t) = (&self.u, &self.squares, &self.log, &self.angle);
        if a == b {
            let (p, q) = others(a);
            let logs = u[p] * (s[q] - s[a]) * l[p] + u[q] * (s[p] - s[a]) * l[q];
            let root = (s[p] + s[q] - s[a].scaled(2.0)) * self.r;
            return logs.times(6.0) - (self.volume * t[a]).times(12.0) - root.scaled(2.0);
        }
        let q = 3 - a - b;
        let logs =
            u[b] * (s[q].times(6.0) - s[b].scaled(2.0)) * l[a] + u[a] * (s[q].times(6.0) - s[a].scaled(2.0)) * l[b];
        let angles = (s[a] * t[a] + s[b] * t[b]).times(6.0) + (s[q] * t[q]).scaled(2.0);
        logs + (self.volume * l[q]).times(12.0) - angles * u[q] - (u[a] * u[b] * self.r).scaled(4.0)
    }

    /// 12 d^3 G / (du_a du_b du_c).
    pub(crate) fn third(&self, a: usize, b: usize, c: usize) -> N {
        let (u, s, l, t) = (&self.u, &self.squares, &self.log, &self.angle);
        match twice_and_once(a, b, c) {
            Some((a, b)) if a == b => {
                let (p, q) = others(a);
                let along = u[a] * (u[p] * l[p] + u[q] * l[q] - self.r);
                (along + u[p] * u[q] * t[a]).times(-12.0)
            }
            Some((a, b)) => {
                let q = 3 - a - b;
                let logs = (s[q] - s[a]) * l[b] + (u[b] * u[q] * l[q]).scaled(2.0);
                (logs - (u[a] * u[q] * t[a]).scaled(2.0) - self.r * u[b]).times(6.0)
            }
            None => {
                let logs = u[1] * u[2] * l[0] + u[2] * u[0] * l[1] + u[0] * u[1] * l[2];
                let angles = s[0] * t[0] + s[1] * t[1] + s[2] * t[2];
                (logs.scaled(2.0) - angles).times(6.0)
            }
        }
    }

    /// 12 times the integral of d^3 G / (du_a du_b du_c) along u_k, of which none of a, b, c is k.
    pub(crate) fn third_along(&self, [a, b, c]: [usize; 3], k: usize) -> N {
        let (u, s, l, t) = (&self.u, &self.squares, &self.log, &self.angle);
        let Some((a, b)) = twice_and_once(a, b, c) else {
            unreachable!("three axes of which none is k are not all different");
        };
        if a == b {
            let p = 3 - a - k;
            let angle = u[p] * (s[a] - s[k]) * t[a];
            let along = u[a] * (s[a] - s[p] - s[k].scaled(2.0)) * l[k];
            return angle.times(6.0) - (self.volume * l[p]).times(12.0)
                + along.times(3.0)
                + (u[a] * u[k] * self.r).times(9.0);
        }
        let angle = u[a] * (s[a] - s[k].times(3.0)) * t[a];
        let across = u[k] * (s[k] - s[a].times(3.0)) * l[b];
        let along = u[b] * (s[k].times(6.0) - s[b] - s[a].times(3.0)) * l[k];
        (angle + across).scaled(2.0) + along - (u[b] * u[k] * self.r).times(5.0)
    }
}

/// The two other axes.
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

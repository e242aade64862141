//! Diagonal elements of the demagnetizing tensor: solid angles of two opposite faces.
//!
//! `4 pi T_xx = W(X_near) - W(X_far)`, where W(X) is the signed solid angle of a face at the
//! distance X (docs/physics.md, Eq. P5). The textbook sum of eight arctangents cancels outside the
//! shadow of the faces and far away. Here the faces are cut where the foot of the point falls, so
//! that each piece spans [y1, y2] x [z1, z2] with 0 <= y1, z1. Each piece is halved into two
//! triangles, whose angle is (van Oosterom and Strackee 1983, for a right angle at corner 1)
//!
//! ```text
//! tan(W / 2) = X |u| |v| / D,   D = (R_1 + R_2) (R_1 + R_3) (R_1 + p / (R_1 + R_2) + q / (R_1 + R_3)),
//! ```
//!
//! where u and v are the legs, p = r_1 . u, q = r_1 . v. For the triangle at the nearest corner p,
//! q >= 0. For the triangle at the farthest corner the bracket is rearranged into positive terms
//! (Eq. P12). The difference over X is taken by the addition theorem, with D_far - D_near as a sum
//! of rationalised increments, all positive. One subtraction remains, 3 x^2 - r^2 of the dipole
//! itself (Eqs. P10 to P14).

use super::number::Scalar;
use super::offsets::Offsets;

/// 4 pi T_ii of the tile, from the two faces normal to axis `i`.
pub(super) fn face_angles<S: Scalar>(offsets: &[Offsets<S>; 3], [i, j, k]: [usize; 3]) -> S {
    let mut half_sum = S::constant(0.0);
    for span_j in spans(&offsets[j]).into_iter().flatten() {
        for span_k in spans(&offsets[k]).into_iter().flatten() {
            let piece = Piece { y: span_j, z: span_k };
            let angle = if offsets[i].within() {
                -(piece.half_angle(-offsets[i].near) + piece.half_angle(offsets[i].far))
            } else {
                piece.half_angle_difference(&offsets[i])
            };
            half_sum = half_sum + angle;
        }
    }
    half_sum.scale(2.0)
}

/// An interval of a face along one axis, on one side of the foot of the point.
#[derive(Clone, Copy)]
struct Span<S> {
    /// `None` where the interval begins at the foot.
    low: Option<S>,
    high: S,
    width: S,
}

impl<S: Scalar> Span<S> {
    /// The ends and the width as fractions of low + high.
    fn shares(&self) -> Shares<S> {
        let Some(low) = self.low else {
            let one = S::constant(1.0);
            return Shares { low: S::constant(0.0), high: one, width: one };
        };
        let per_sum = (low + self.high).recip();
        Shares { low: low * per_sum, high: self.high * per_sum, width: self.width * per_sum }
    }
}

struct Shares<S> {
    low: S,
    high: S,
    width: S,
}

fn spans<S: Scalar>(offsets: &Offsets<S>) -> [Option<Span<S>>; 2] {
    let from_foot = |high: S| Span { low: None, high, width: high };
    if offsets.within() {
        [Some(from_foot(offsets.far)), Some(from_foot(-offsets.near))]
    } else {
        let width = S::constant(offsets.size);
        [Some(Span { low: Some(offsets.near), high: offsets.far, width }), None]
    }
}

/// A rectangle of a face within one quadrant about the foot of the point.
struct Piece<S> {
    y: Span<S>,
    z: Span<S>,
}

/// Distances from the point to the corners of a piece; 1 is the end nearer to the foot, first along
/// y.
#[derive(Clone, Copy)]
struct Corners<S> {
    r11: S,
    r12: S,
    r21: S,
    r22: S,
}

impl<S: Scalar> Corners<S> {
    /// R_12 + R_21 - R_22, which is never negative:
    /// (R_12 + R_21)^2 - R_22^2 = R_11^2 + 2 R_12 R_21.
    fn detour(&self) -> S {
        (self.r11.square() + (self.r12 * self.r21).scale(2.0)).over(self.r12 + self.r21 + self.r22)
    }

    fn bracket(&self, [w12, w21, w_detour]: [S; 3]) -> S {
        w12 * self.r12 + w21 * self.r21 + w_detour * self.detour()
    }
}

impl<S: Scalar> Piece<S> {
    fn area(&self) -> S {
        self.y.width * self.z.width
    }

    /// Whether the foot of the point is the corner 11.
    fn at_foot(&self) -> bool {
        self.y.low.is_none() && self.z.low.is_none()
    }

    /// Distances to the corners from a point `height` above the face.
    fn corners(&self, height: S) -> Corners<S> {
        let h2 = height.square();
        let (y1, y2) = (self.y.low.map(S::square), self.y.high.square());
        let (z1, z2) = (self.z.low.map(S::square), self.z.high.square());
        let plus = |base: S, extra: Option<S>| extra.map_or(base, |e| base + e);
        let r11 = if self.at_foot() { height } else { plus(plus(h2, y1), z1).sqrt() };
        Corners { r11, r12: plus(h2 + z2, y1).sqrt(), r21: plus(h2 + y2, z1).sqrt(), r22: (h2 + y2 + z2).sqrt() }
    }

    /// D of the triangle at the nearest corner.
    fn nearest(&self, c: &Corners<S>) -> S {
        let (u, v) = (c.r11 + c.r21, c.r11 + c.r12);
        let mut d = c.r11 * u * v;
        if let Some(y1) = self.y.low {
            d = d + self.y.width * y1 * v;
        }
        if let Some(z1) = self.z.low {
            d = d + self.z.width * z1 * u;
        }
        d
    }

    /// Weights of R_12, R_21 and of the detour in the bracket of the farthest triangle; they sum to
    /// one.
    fn weights(&self) -> [S; 3] {
        let (y, z) = (self.y.shares(), self.z.shares());
        [z.low, y.low, y.width * z.high + y.low * z.width]
    }

    /// D of the triangle at the farthest corner.
    fn farthest(&self, c: &Corners<S>) -> S {
        (c.r22 + c.r12) * (c.r22 + c.r21) * c.bracket(self.weights())
    }

    /// Half the solid angle of the piece, seen from `height` > 0 above its plane.
    fn half_angle(&self, height: S) -> S {
        let c = self.corners(height);
        let area = self.area();
        let near = if self.at_foot() {
            area.over((height + c.r21) * (height + c.r12))
        } else {
            (height * area).over(self.nearest(&c))
        };
        let far = (height * area).over(self.farthest(&c));
        near.atan() + far.atan()
    }

    /// Half the difference of the solid angles seen from the near and from the far height, both
    /// positive.
    fn half_angle_difference(&self, x: &Offsets<S>) -> S {
        let (near, far) = (self.corners(x.near), self.corners(x.far));
        let step = x.square_step();
        let size = S::constant(x.size);
        let rise = Corners {
            r11: if self.at_foot() { size } else { step.over(near.r11 + far.r11) },
            r12: step.over(near.r12 + far.r12),
            r21: step.over(near.r21 + far.r21),
            r22: step.over(near.r22 + far.r22),
        };
        self.nearest_difference(x, &near, &far, &rise) + self.farthest_difference(x, &near, &far, &rise)
    }

    fn nearest_difference(&self, x: &Offsets<S>, near: &Corners<S>, far: &Corners<S>, rise: &Corners<S>) -> S {
        let (u, v) = (near.r11 + near.r21, near.r11 + near.r12);
        let (u_far, v_far) = (far.r11 + far.r21, far.r11 + far.r12);
        let (du, dv) = (rise.r11 + rise.r21, rise.r11 + rise.r12);
        let uv_step = du * v_far + u * dv;
        let area = self.area();
        if self.at_foot() {
            // R_11 is the height and divides out of the tangent: tan(W / 2) = |u| |v| / (u v).
            return (area * uv_step).over(u * v * u_far * v_far + area.square()).atan();
        }
        let mut step = rise.r11 * u_far * v_far + near.r11 * uv_step;
        if let Some(y1) = self.y.low {
            step = step + self.y.width * y1 * dv;
        }
        if let Some(z1) = self.z.low {
            step = step + self.z.width * z1 * du;
        }
        triangle_difference(x, area, self.nearest(near), step)
    }

    fn farthest_difference(&self, x: &Offsets<S>, near: &Corners<S>, far: &Corners<S>, rise: &Corners<S>) -> S {
        let weights @ [w12, w21, w_detour] = self.weights();
        let (m, n, g) = (near.r22 + near.r12, near.r22 + near.r21, near.bracket(weights));
        let (n_far, g_far) = (far.r22 + far.r21, far.bracket(weights));
        let (dm, dn) = (rise.r22 + rise.r12, rise.r22 + rise.r21);
        let dg = w12 * rise.r12 + w21 * rise.r21 + w_detour * (rise.r12 + rise.r21 - rise.r22);
        let step = dm * n_far * g_far + m * (dn * g_far + n * dg);
        triangle_difference(x, self.area(), m * n * g, step)
    }
}

/// Half the difference of a triangle's solid angles over X, from D at the near height and its
/// increase to the far height.
fn triangle_difference<S: Scalar>(x: &Offsets<S>, area: S, d_near: S, d_step: S) -> S {
    let d_far = d_near + d_step;
    let above = area * (x.near * d_step - d_near.scale(x.size));
    let below = d_near * d_far + x.near * x.far * area.square();
    above.over(below).atan()
}

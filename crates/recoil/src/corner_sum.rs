//! The mean demagnetizing tensor of two boxes with parallel edges, in closed form.
//!
//! A. J. Newell, W. Williams, D. J. Dunlop, "A generalization of the demagnetizing tensor for nonuniform
//! magnetization", J. Geophys. Res. 98 (1993) 9551, for boxes of different sizes: the second differences
//! of their functions f and g become sums over the 64 differences of corners. With r = |u|,
//! L_a = artanh(u_a / r) and A_a = arctan(u_b u_c / (u_a r)), their functions are
//!
//! ```text
//! 6 f_a  = 3 u_b (u_c^2 - u_a^2) L_b + 3 u_c (u_b^2 - u_a^2) L_c - 6 u_a u_b u_c A_a
//!          - (u_b^2 + u_c^2 - 2 u_a^2) r
//! 6 g_ab = u_b (3 u_c^2 - u_b^2) L_a + u_a (3 u_c^2 - u_a^2) L_b + 6 u_a u_b u_c L_c
//!          - u_c (3 u_a^2 A_a + 3 u_b^2 A_b + u_c^2 A_c) - 2 u_a u_b r
//! ```
//!
//! Products whose polynomial vanishes where L or A have no value are zero there: their limit.

use std::f64::consts::PI;

use glam::DVec3;

use crate::symmetric_tensor::SymmetricTensor;

/// The functions f and g of Newell et al. are multiplied by this.
const DENOMINATOR: f64 = 6.0;

/// The tensor that takes the polarization of the source to minus the mean of mu0 H over the receiver.
/// `offset` leads from the centre of the source to that of the receiver.
pub(crate) fn mean_tensor(receiver: DVec3, source: DVec3, offset: DVec3) -> SymmetricTensor {
    let differences = [0, 1, 2].map(|axis: usize| {
        let (sum, difference) = (0.5 * (receiver + source)[axis], 0.5 * (receiver - source)[axis]);
        // Differences of faces with the product of their signs: both lower, both upper, and mixed.
        [
            (offset[axis] - difference, 1.0),
            (offset[axis] + difference, 1.0),
            (offset[axis] - sum, -1.0),
            (offset[axis] + sum, -1.0),
        ]
    });
    let mut total = SymmetricTensor::ZERO;
    for (x, sign_x) in differences[0] {
        for (y, sign_y) in differences[1] {
            for (z, sign_z) in differences[2] {
                total += functions(DVec3::new(x, y, z)) * (sign_x * sign_y * sign_z);
            }
        }
    }
    total * (1.0 / (DENOMINATOR * 4.0 * PI * receiver.element_product()))
}

/// 6 f_a and 6 g_ab of one difference of corners.
fn functions(u: DVec3) -> SymmetricTensor {
    let s = u * u;
    let r = (s.x + s.y + s.z).sqrt();
    let log = |along: f64, across_squared: f64| {
        if across_squared > 0.0 { (along / across_squared.sqrt()).asinh() } else { 0.0 }
    };
    let angle = |a: f64, b: f64, c: f64| if a == 0.0 { 0.0 } else { (b * c / (a * r)).atan() };
    let l = DVec3::new(log(u.x, s.y + s.z), log(u.y, s.z + s.x), log(u.z, s.x + s.y));
    let t = DVec3::new(angle(u.x, u.y, u.z), angle(u.y, u.z, u.x), angle(u.z, u.x, u.y));
    let volume = u.x * u.y * u.z;
    let (next, last) = (|v: DVec3| DVec3::new(v.y, v.z, v.x), |v: DVec3| DVec3::new(v.z, v.x, v.y));
    let (u_b, u_c, s_b, s_c, l_b, l_c) = (next(u), last(u), next(s), last(s), next(l), last(l));
    let diagonal = 3.0 * (u_b * (s_c - s) * l_b + u_c * (s_b - s) * l_c) - 6.0 * volume * t - (s_b + s_c - 2.0 * s) * r;
    // Of the axes b and c, across a.
    let st = s * t;
    let off_diagonal = u_c * (3.0 * s - s_c) * l_b + u_b * (3.0 * s - s_b) * l_c + 6.0 * volume * l
        - u * (3.0 * (next(st) + last(st)) + st)
        - 2.0 * u_b * u_c * r;
    SymmetricTensor { diagonal, off_diagonal }
}

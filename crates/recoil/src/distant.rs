//! The mean demagnetizing tensor of two distant boxes with parallel edges.
//!
//! The mean over both boxes of a function of the difference of two points is a mean over that
//! difference. Along each axis its density is the convolution of two intervals: a trapezoid. A
//! Gaussian rule of two to five nodes for this density takes the mean of the tensor of a dipole,
//! without cancellation.

use std::f64::consts::PI;

use glam::DVec3;

use crate::symmetric_tensor::SymmetricTensor;

/// A node and its weight.
type Node = (f64, f64);

/// The error of a rule of n nodes, relative to the tensor, is below this over the 2n-th power of
/// the ratio of the distance of the centres to the largest half side of the box of all differences
/// of points. It is largest for two nodes: 0.7, and 0.03 for five of a small box beside a long one.
const RULE_ERROR: f64 = 1.5;

/// The mean tensor, as [`crate::corner_sum::mean_tensor`], to an error relative to its norm. `None`
/// if the boxes are too near.
pub(crate) fn mean_tensor(receiver: DVec3, source: DVec3, offset: DVec3, error: f64) -> Option<SymmetricTensor> {
    let ratio = offset.length() / (0.5 * (receiver + source)).max_element();
    let square = ratio * ratio;
    let allowed = error / RULE_ERROR * square * square;
    // Powers of the ratio one by one: most pairs are beyond the first limits.
    let mean = if allowed >= 1.0 {
        mean_of_rule(receiver, source, offset, rule_of_two)
    } else if allowed * square >= 1.0 {
        mean_of_rule(receiver, source, offset, rule_of_three)
    } else if allowed * square * square >= 1.0 {
        mean_of_rule(receiver, source, offset, rule_of_four)
    } else if allowed * square * square * square >= 1.0 {
        mean_of_rule(receiver, source, offset, rule_of_five)
    } else {
        return None;
    };
    Some(mean)
}

fn mean_of_rule<const NODES: usize>(
    receiver: DVec3,
    source: DVec3,
    offset: DVec3,
    rule: impl Fn(f64, f64) -> [Node; NODES],
) -> SymmetricTensor {
    let [x, y, z] = [0, 1, 2].map(|axis: usize| rule(0.5 * receiver[axis], 0.5 * source[axis]));
    let mut total = SymmetricTensor::ZERO;
    for (dx, weight_x) in x {
        for (dy, weight_y) in y {
            for (dz, weight_z) in z {
                total += dipole(offset + DVec3::new(dx, dy, dz)) * (weight_x * weight_y * weight_z);
            }
        }
    }
    total * (source.element_product() / (4.0 * PI))
}

/// Minus the second derivatives of 1 / r.
pub(crate) fn dipole(u: DVec3) -> SymmetricTensor {
    let square = u.length_squared();
    let inverse_cube = 1.0 / (square * square.sqrt());
    let scaled = u * (-3.0 * inverse_cube / square);
    SymmetricTensor {
        diagonal: scaled * u + DVec3::splat(inverse_cube),
        off_diagonal: DVec3::new(scaled.y * u.z, scaled.z * u.x, scaled.x * u.y),
    }
}

/// The length a + b, and the even moments from the second to the eighth of the sum of two uniform
/// numbers on [-a, a] and [-b, b], in that length.
fn moments(a: f64, b: f64) -> (f64, [f64; 4]) {
    let scale = a + b;
    let (a, b) = ((a / scale) * (a / scale), (b / scale) * (b / scale));
    let m2 = (a + b) / 3.0;
    let m4 = (a * a + b * b) / 5.0 + 2.0 * a * b / 3.0;
    let m6 = (a * a * a + b * b * b) / 7.0 + a * b * (a + b);
    let m8 = (a.powi(4) + b.powi(4)) / 9.0 + 4.0 / 3.0 * a * b * (a * a + b * b) + 14.0 / 5.0 * a * a * b * b;
    (scale, [m2, m4, m6, m8])
}

/// The Gaussian rule of two nodes for that sum.
fn rule_of_two(a: f64, b: f64) -> [Node; 2] {
    let (scale, [m2, ..]) = moments(a, b);
    let node = scale * m2.sqrt();
    [(-node, 0.5), (node, 0.5)]
}

/// The Gaussian rule of three nodes for that sum.
fn rule_of_three(a: f64, b: f64) -> [Node; 3] {
    let (scale, [m2, m4, ..]) = moments(a, b);
    let (node, weight) = (scale * (m4 / m2).sqrt(), 0.5 * m2 * m2 / m4);
    [(-node, weight), (0.0, 1.0 - 2.0 * weight), (node, weight)]
}

/// The Gaussian rule of four nodes for that sum. The polynomial t^4 + p t^2 + q is orthogonal to 1
/// and t^2.
fn rule_of_four(a: f64, b: f64) -> [Node; 4] {
    let (scale, [m2, m4, m6, _]) = moments(a, b);
    let p = (m2 * m4 - m6) / (m4 - m2 * m2);
    let [outer, inner] = squares_of_nodes(p, -m4 - p * m2);
    let of_outer = 0.5 * (m2 - inner) / (outer - inner);
    let of_inner = 0.5 - of_outer;
    let (outer, inner) = (scale * outer.sqrt(), scale * inner.sqrt());
    [(-outer, of_outer), (-inner, of_inner), (inner, of_inner), (outer, of_outer)]
}

/// The Gaussian rule of five nodes for that sum. The polynomial t (t^4 + p t^2 + q) is orthogonal
/// to t and t^3.
fn rule_of_five(a: f64, b: f64) -> [Node; 5] {
    let (scale, [m2, m4, m6, m8]) = moments(a, b);
    let determinant = m2 * m6 - m4 * m4;
    let [outer, inner] = squares_of_nodes((m4 * m6 - m2 * m8) / determinant, (m4 * m8 - m6 * m6) / determinant);
    // Weights of the pairs, exact for t^2 and t^4.
    let of_outer = (m4 - inner * m2) / (2.0 * outer * (outer - inner));
    let of_inner = (outer * m2 - m4) / (2.0 * inner * (outer - inner));
    let (outer, inner) = (scale * outer.sqrt(), scale * inner.sqrt());
    let centre = 1.0 - 2.0 * (of_outer + of_inner);
    [(-outer, of_outer), (-inner, of_inner), (0.0, centre), (inner, of_inner), (outer, of_outer)]
}

/// The roots of x^2 + p x + q, the larger one first.
fn squares_of_nodes(p: f64, q: f64) -> [f64; 2] {
    let outer = -0.5 * p + (0.25 * p * p - q).max(0.0).sqrt();
    [outer, q / outer]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rule integrates even powers below twice its nodes over two intervals, and its nodes are
    /// inside.
    fn check<const NODES: usize>(rule: impl Fn(f64, f64) -> [Node; NODES]) {
        for (a, b) in [(0.5, 0.5), (1.0, 1e-6), (0.3, 2.0)] {
            let rule = rule(a, b);
            assert!(rule.iter().all(|(t, weight)| t.abs() < a + b && *weight > 0.0), "{rule:?}");
            for power in (0..2 * NODES as i32).step_by(2) {
                // The mean of (s + t)^n over both intervals, by its antiderivatives.
                let n = f64::from(power);
                let corner = |x: f64| x.powi(power + 2) / ((n + 1.0) * (n + 2.0));
                let mean = (corner(a + b) - corner(a - b) - corner(b - a) + corner(-a - b)) / (4.0 * a * b);
                let sum: f64 = rule.iter().map(|(t, weight)| weight * t.powi(power)).sum();
                let allowed = 1e-12 * (a + b).powi(power) * (1.0 + 1e-3 / (a * b));
                assert!((sum - mean).abs() <= allowed, "{a} {b} {power}: {sum} {mean}");
            }
        }
    }

    #[test]
    fn rules_are_exact_below_twice_their_nodes() {
        check(rule_of_two);
        check(rule_of_three);
        check(rule_of_four);
        check(rule_of_five);
    }
}

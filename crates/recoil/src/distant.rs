//! The mean demagnetizing tensor of two distant boxes with parallel edges.
//!
//! The mean over both boxes of a function of the difference of two points is a mean over that difference.
//! Along each axis its density is the convolution of two intervals: a trapezoid. The Gaussian rule of
//! five nodes for this density takes the mean of the tensor of a dipole, without cancellation.

use std::f64::consts::PI;

use glam::DVec3;

use crate::symmetric_tensor::SymmetricTensor;

/// Nodes of the rule.
const NODES: usize = 5;

/// The mean tensor, as [`crate::corner_sum::mean_tensor`].
pub(crate) fn mean_tensor(receiver: DVec3, source: DVec3, offset: DVec3) -> SymmetricTensor {
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

/// The Gaussian rule for the sum of two uniform numbers on [-a, a] and [-b, b]: nodes and weights.
///
/// The polynomial t (t^4 + p t^2 + q) that is orthogonal to t and t^3 follows from the moments.
fn rule(a: f64, b: f64) -> [(f64, f64); NODES] {
    let scale = a + b;
    let (a, b) = ((a / scale) * (a / scale), (b / scale) * (b / scale));
    let m2 = (a + b) / 3.0;
    let m4 = (a * a + b * b) / 5.0 + 2.0 * a * b / 3.0;
    let m6 = (a * a * a + b * b * b) / 7.0 + a * b * (a + b);
    let m8 = (a.powi(4) + b.powi(4)) / 9.0 + 4.0 / 3.0 * a * b * (a * a + b * b) + 14.0 / 5.0 * a * a * b * b;
    let determinant = m2 * m6 - m4 * m4;
    let p = (m4 * m6 - m2 * m8) / determinant;
    let q = (m4 * m8 - m6 * m6) / determinant;
    let root = (0.25 * p * p - q).max(0.0).sqrt();
    let outer = -0.5 * p + root;
    let inner = q / outer;
    // Weights of the pairs, exact for t^2 and t^4.
    let of_outer = (m4 - inner * m2) / (2.0 * outer * (outer - inner));
    let of_inner = (outer * m2 - m4) / (2.0 * inner * (outer - inner));
    let (outer, inner) = (scale * outer.sqrt(), scale * inner.sqrt());
    let centre = 1.0 - 2.0 * (of_outer + of_inner);
    [(-outer, of_outer), (-inner, of_inner), (0.0, centre), (inner, of_inner), (outer, of_outer)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rule integrates even powers to the eighth over two intervals, and its nodes are inside.
    #[test]
    fn rule_is_exact_to_the_ninth_degree() {
        for (a, b) in [(0.5, 0.5), (1.0, 1e-6), (0.3, 2.0)] {
            let rule = rule(a, b);
            assert!(rule.iter().all(|(t, weight)| t.abs() < a + b && *weight > 0.0), "{rule:?}");
            for power in [0, 2, 4, 6, 8] {
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
}

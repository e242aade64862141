//! Force and torque of two distant cuboids with parallel edges.
//!
//! The double integral of a function of x - x' over two boxes is one integral of it, weighted along
//! each axis by the convolution of two intervals. The dipole force is smooth far away, so that the
//! Gauss rule of this weight with five nodes along each axis integrates it to round-off. The lever
//! x_k of a torque is integrated by parts: x = -d/dx (a^2 / 4 - x^2) / 2 in an interval of length
//! a.

use glam::DVec3;
use magsplice_magnet::MU_0;

use crate::aligned_pair::AlignedPair;
use crate::load::Load;

/// Least distance of the centres over half the sum of the diagonals. The rule of five nodes on half
/// a length h is off by about (h / 2D)^10 times the binomial 14 over 4, below 1e-15 from D = 32 h.
const LEAST_RATIO: f64 = 32.0;

/// Nodes along an axis.
const NODES: usize = 5;

/// A rule along one axis: nodes and weights, whose sum is 1.
type Rule = [(f64, f64); NODES];

/// Whether the rule of five nodes is exact to round-off.
pub(crate) fn is_distant(pair: &AlignedPair) -> bool {
    let reach = 0.5 * (pair.sizes[0].length() + pair.sizes[1].length());
    offset(pair).length() >= LEAST_RATIO * reach
}

/// The load on the first cuboid by the second, in the scaled lengths of the pair.
pub(crate) fn load(pair: &AlignedPair) -> Load {
    let [first, second] = pair.polarizations_t;
    let at = offset(pair);
    let uniform = [0, 1, 2].map(|k: usize| rule(pair.sizes[0][k], pair.sizes[1][k], uniform_moments));
    let levered = [0, 1, 2].map(|k: usize| rule(pair.sizes[0][k], pair.sizes[1][k], parabola_moments));
    let force = integral(at, uniform, |u| dipole_force(first, second, u));
    let mut torque = first.cross(integral(at, uniform, |u| dipole_field(second, u)));
    for k in 0..3 {
        let mut rules = uniform;
        rules[k] = levered[k];
        let along_k = integral(at, rules, |u| force_derivative(first, second, u, k));
        let moment = pair.sizes[0][k].powi(2) / 12.0 * along_k;
        torque += DVec3::AXES[k].cross(moment);
    }
    let volumes = pair.sizes[0].element_product() * pair.sizes[1].element_product();
    let factor = volumes / (4.0 * std::f64::consts::PI * MU_0);
    Load { force: force * factor, torque: torque * factor }
}

fn offset(pair: &AlignedPair) -> DVec3 {
    DVec3::from_array(pair.offset.map(|d| d.to_f64()))
}

fn integral(at: DVec3, [x, y, z]: [Rule; 3], function: impl Fn(DVec3) -> DVec3) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for (shift_x, weight_x) in x {
        for (shift_y, weight_y) in y {
            for (shift_z, weight_z) in z {
                let weight = weight_x * weight_y * weight_z;
                sum += weight * function(at + DVec3::new(shift_x, shift_y, shift_z));
            }
        }
    }
    sum
}

/// 4 pi mu0 H of the unit dipole moment J' at the origin: J'_b d^2 (1 / r) / (du_a du_b).
fn dipole_field(source: DVec3, u: DVec3) -> DVec3 {
    let r2 = u.length_squared();
    (3.0 * source.dot(u) / r2 * u - source) / (r2 * r2.sqrt())
}

/// J_a J'_b d^3 (1 / r) / (du_a du_b du_c): the force on the dipole J by J' at the origin.
fn dipole_force(dipole: DVec3, source: DVec3, u: DVec3) -> DVec3 {
    let r2 = u.length_squared();
    let (along, source_along) = (dipole.dot(u), source.dot(u));
    let linear = dipole.dot(source) * u + source_along * dipole + along * source;
    (3.0 * linear - 15.0 * along * source_along / r2 * u) / (r2 * r2 * r2.sqrt())
}

/// The derivative of [`dipole_force`] along the axis `k`.
fn force_derivative(dipole: DVec3, source: DVec3, u: DVec3, k: usize) -> DVec3 {
    let r2 = u.length_squared();
    let (along, source_along, dot) = (dipole.dot(u), source.dot(u), dipole.dot(source));
    let (e, u_k) = (DVec3::AXES[k], u[k]);
    let fourth = 105.0 * along * source_along * u_k / r2 * u;
    let second = dot * u_k * u
        + source_along * (u_k * dipole + dipole[k] * u)
        + along * (u_k * source + source[k] * u)
        + along * source_along * e;
    let constant = dot * e + source[k] * dipole + dipole[k] * source;
    (fourth / r2 - 15.0 * second / r2 + 3.0 * constant) / (r2 * r2 * r2.sqrt())
}

/// Means of x^2, x^4, x^6 and x^8 over an interval of half length 1.
fn uniform_moments() -> [f64; 5] {
    [1.0, 1.0 / 3.0, 1.0 / 5.0, 1.0 / 7.0, 1.0 / 9.0]
}

/// The same with the weight 1 - x^2.
fn parabola_moments() -> [f64; 5] {
    [1.0, 3.0 / 15.0, 3.0 / 35.0, 3.0 / 63.0, 3.0 / 99.0]
}

/// The Gauss rule for x - x' with x in an interval of length `first` and with the moments
/// `moments`, and x' uniform in an interval of length `second`.
fn rule(first: f64, second: f64, moments: fn() -> [f64; 5]) -> Rule {
    let largest = first.max(second);
    let (a, b) = ((first / largest).powi(2), (second / largest).powi(2));
    let (of_first, of_second) = (moments(), uniform_moments());
    // Moments of u^2 for lengths in units of half the largest.
    let moment = |n: usize| -> f64 {
        (0..=n)
            .map(|j| EVEN_BINOMIALS[n][j] * of_first[j] * a.powi(j as i32) * of_second[n - j] * b.powi((n - j) as i32))
            .sum()
    };
    let [m1, m2, m3, m4] = [1, 2, 3, 4].map(moment);
    // The nodes are 0 and the square roots of the zeros of s^2 - p s + q, orthogonal to 1 and s
    // with the weight s.
    let determinant = m1 * m3 - m2 * m2;
    let p = (m1 * m4 - m2 * m3) / determinant;
    let q = (m2 * m4 - m3 * m3) / determinant;
    let root = (0.25 * p * p - q).max(0.0).sqrt();
    let outer = 0.5 * p + root;
    let inner = q / outer;
    let outer_weight = (m2 - inner * m1) / (outer - inner) / outer;
    let inner_weight = (outer * m1 - m2) / (outer - inner) / inner;
    let (far, near) = (outer.sqrt() * 0.5 * largest, inner.sqrt() * 0.5 * largest);
    let middle = 1.0 - outer_weight - inner_weight;
    [
        (-far, 0.5 * outer_weight),
        (-near, 0.5 * inner_weight),
        (0.0, middle),
        (near, 0.5 * inner_weight),
        (far, 0.5 * outer_weight),
    ]
}

/// The binomials 2n over 2j.
const EVEN_BINOMIALS: [[f64; 5]; 5] = [
    [1.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 1.0, 0.0, 0.0, 0.0],
    [1.0, 6.0, 1.0, 0.0, 0.0],
    [1.0, 15.0, 15.0, 1.0, 0.0],
    [1.0, 28.0, 70.0, 28.0, 1.0],
];

#[cfg(test)]
mod tests {
    use magsplice_magnet::Tile;

    use super::*;
    use crate::closed_form;
    use crate::double_double::DoubleDouble;

    /// The rules are exact up to the ninth power, so that errors of force and torque fall with the
    /// tenth power of the distance: by 1024 where it doubles, and by 64 if the sixth moment were
    /// wrong.
    #[test]
    fn error_falls_with_the_tenth_power_of_the_distance() {
        let first = Tile::new(DVec3::ZERO, DVec3::new(2.0, 3.0, 1.0), DVec3::new(0.1, -0.05, 0.2)).unwrap();
        let errors = |direction: DVec3, distance: f64| {
            let position = distance * direction.normalize();
            let second = Tile::new(position, DVec3::new(1.0, 1.5, 2.5), DVec3::new(-0.07, 0.15, 0.11)).unwrap();
            let pair = AlignedPair::new(&first, &second).unwrap();
            let (fast, exact) = (load(&pair), closed_form::load::<DoubleDouble>(&pair));
            let relative = |fast: DVec3, exact: DVec3| (fast - exact).length() / exact.length();
            [relative(fast.force, exact.force), relative(fast.torque, exact.torque)]
        };
        for direction in [DVec3::new(1.0, 0.3, -0.6), DVec3::new(0.1, 1.0, 0.2), DVec3::new(-0.5, 0.4, 1.0)] {
            let (near, far) = (errors(direction, 12.0), errors(direction, 24.0));
            for (near, far) in near.into_iter().zip(far) {
                assert!(near < 1e-6 && far < near / 512.0, "{direction}: {near:e} {far:e}");
            }
        }
    }
}

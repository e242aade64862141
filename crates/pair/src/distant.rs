//! Mean tensor, force and torque of two distant cuboids with parallel edges.
//!
//! Dipoles at the nodes of Gauss rules for the difference of two points, without cancellation. The
//! lever x_k of a torque is integrated by parts: x = -d/dx (a^2 / 4 - x^2) / 2 in an interval of
//! length a.

use std::f64::consts::PI;
use std::ops::{AddAssign, Mul};

use glam::DVec3;
use magsplice_magnet::MU_0;

use crate::aligned_pair::AlignedPair;
use crate::gauss::{Node, SumOfTwo};
use crate::load::Load;
use crate::symmetric_tensor::SymmetricTensor;
use crate::tolerances::{DISTANT_LOAD, RULE_ERROR};

/// The tensor of [`crate::closed_form::mean_tensor`], to an error relative to its norm. `None` if
/// the boxes are too near.
pub(crate) fn mean_tensor(receiver: DVec3, source: DVec3, offset: DVec3, error: f64) -> Option<SymmetricTensor> {
    let ratio = offset.length() / (0.5 * (receiver + source)).max_element();
    let square = ratio * ratio;
    let allowed = error / RULE_ERROR * square * square;
    let along = |axis: usize| SumOfTwo::uniform(0.5 * receiver[axis], 0.5 * source[axis]);
    let sums = || [along(0), along(1), along(2)];
    // Powers of the ratio are computed one by one, because most pairs are beyond the first limits.
    let mean = if allowed >= 1.0 {
        mean(offset, sums().map(SumOfTwo::rule_of_two), dipole)
    } else if allowed * square >= 1.0 {
        mean(offset, sums().map(SumOfTwo::rule_of_three), dipole)
    } else if allowed * square * square >= 1.0 {
        mean(offset, sums().map(SumOfTwo::rule_of_four), dipole)
    } else if allowed * square * square * square >= 1.0 {
        mean(offset, sums().map(SumOfTwo::rule_of_five), dipole)
    } else {
        return None;
    };
    Some(mean * (source.element_product() / (4.0 * PI)))
}

/// Whether force and torque by rules of five nodes are exact to round-off.
pub(crate) fn is_distant(pair: &AlignedPair) -> bool {
    let reach = 0.5 * (pair.sizes[0].length() + pair.sizes[1].length());
    offset(pair).length() >= DISTANT_LOAD * reach
}

/// The load on the first cuboid by the second, in the scaled lengths of the pair.
pub(crate) fn load(pair: &AlignedPair) -> Load {
    let at = offset(pair);
    let [first, second] = pair.polarizations_t;
    let halves = pair.sizes.map(|size| 0.5 * size);
    let uniform = [0, 1, 2].map(|k: usize| SumOfTwo::uniform(halves[0][k], halves[1][k]).rule_of_five());
    let force = mean(at, uniform, |u| dipole_force(first, second, u));
    let mut torque = mean(at, uniform, dipole).apply(second).cross(first);
    for k in 0..3 {
        let mut rules = uniform;
        rules[k] = SumOfTwo::parabolic_and_uniform(halves[0][k], halves[1][k]).rule_of_five();
        let along_k = mean(at, rules, |u| force_derivative(first, second, u, k));
        let moment = halves[0][k].powi(2) / 3.0 * along_k;
        torque += DVec3::AXES[k].cross(moment);
    }
    let volumes = pair.sizes[0].element_product() * pair.sizes[1].element_product();
    let factor = volumes / (4.0 * PI * MU_0);
    Load { force: force * factor, torque: torque * factor }
}

fn offset(pair: &AlignedPair) -> DVec3 {
    DVec3::from_array(pair.offset.map(|d| d.to_f64()))
}

/// The mean of a function by the rules of the three axes about a point.
#[inline]
fn mean<T: Default + AddAssign + Mul<f64, Output = T>, const NODES: usize>(
    at: DVec3,
    [x, y, z]: [[Node; NODES]; 3],
    function: impl Fn(DVec3) -> T,
) -> T {
    let mut sum = T::default();
    for (dx, weight_x) in x {
        for (dy, weight_y) in y {
            for (dz, weight_z) in z {
                sum += function(at + DVec3::new(dx, dy, dz)) * (weight_x * weight_y * weight_z);
            }
        }
    }
    sum
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

#[cfg(test)]
mod tests {
    use magsplice_magnet::Tile;

    use super::*;
    use crate::closed_form;
    use crate::double_double::DoubleDouble;

    /// The rules are exact up to the ninth power, so errors of force and torque fall with the tenth
    /// power of the distance: by 1024 where it doubles. They would fall by 64 if the sixth moment
    /// were wrong.
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

    /// At the smallest distance of their use, errors are round-off of the sums.
    #[test]
    fn rules_are_exact_to_round_off_where_they_are_used() {
        for n in 0..200_i32 {
            let wave = |k: f64| {
                DVec3::new((k * f64::from(n)).sin(), (k * f64::from(n) + 1.0).cos(), (2.0 * k * f64::from(n)).sin())
            };
            let size = |k: f64| wave(k) * 0.9 + DVec3::splat(1.0);
            let (sizes, first_t, second_t) = ([size(0.7), size(1.1)], wave(1.7), wave(2.3));
            let position = wave(3.1).normalize() * (DISTANT_LOAD * 0.5 * (sizes[0].length() + sizes[1].length()));
            let first = Tile::new(DVec3::ZERO, sizes[0], first_t).unwrap();
            let second = Tile::new(1.0001 * position, sizes[1], second_t).unwrap();
            let pair = AlignedPair::new(&first, &second).unwrap();
            assert!(is_distant(&pair));
            let (fast, exact) = (load(&pair), closed_form::load::<DoubleDouble>(&pair));
            let arm = offset(&pair).length();
            println!(
                "{n} {:e} {:e} {:e}",
                (fast.force - exact.force).length() / exact.force.length(),
                (fast.torque - exact.torque).length() / exact.torque.length(),
                (fast.torque - exact.torque).length() / exact.torque.length().max(exact.force.length() * arm)
            );
        }
    }
}

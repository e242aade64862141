//! Units. Lengths in millimetres and polarizations in tesla pass through unchanged, because the
//! field depends on ratios of lengths only. Rotation angles in degrees become quaternions here.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4};

use glam::{DQuat, DVec3};

/// A unit that the end of a key states.
pub(crate) struct KeyUnit {
    /// The end of the key.
    pub(crate) suffix: &'static str,
    /// Words for the unit.
    pub(crate) words: &'static str,
    /// Units that people write beside a number, and their factors.
    pub(crate) others: &'static [(&'static str, f64)],
}

/// The units of keys. A unit whose name ends like another's comes before it.
pub(crate) const KEY_UNITS: [KeyUnit; 5] = [
    KeyUnit {
        suffix: "_mm",
        words: "mm",
        others: &[("mm", 1.0), ("cm", 10.0), ("um", 1e-3), ("\u{b5}m", 1e-3), ("m", 1e3)],
    },
    KeyUnit { suffix: "_t", words: "tesla", others: &[("mT", 1e-3), ("kG", 1e-1), ("G", 1e-4), ("T", 1.0)] },
    KeyUnit { suffix: "_ut", words: "microtesla", others: &[("uT", 1.0), ("\u{b5}T", 1.0), ("mT", 1e3)] },
    KeyUnit { suffix: "_mt", words: "millitesla", others: &[("mT", 1.0), ("uT", 1e-3)] },
    KeyUnit { suffix: "_deg", words: "degrees", others: &[("degrees", 1.0), ("deg", 1.0), ("\u{b0}", 1.0)] },
];

/// The rotation by `angle_deg` degrees, right-handed, about a unit vector.
///
/// The angle is first reduced to one turn, which is exact, so that 720 degrees are the identity.
pub(crate) fn rotation_from_degrees(axis: DVec3, angle_deg: f64) -> DQuat {
    DQuat::from_axis_angle(axis, (angle_deg % 360.0).to_radians())
}

/// The unit vector along `vector`, or `None` if that is zero or not finite.
///
/// Scaled by the largest component first, so that squares neither overflow nor underflow.
pub(crate) fn unit_vector(vector: [f64; 3]) -> Option<DVec3> {
    let vector = DVec3::from(vector);
    let largest = vector.abs().max_element();
    // is_finite catches NaN, which max_element may skip.
    (vector.is_finite() && largest > 0.0).then(|| (vector / largest).normalize())
}

/// The unit vector at an angle in the xy plane, from x towards y, and an angle out of it towards z,
/// both in degrees.
///
/// It lies exactly along an axis where the angles are multiples of 90 degrees. Angles that are
/// mirror images of each other in an axis or in a diagonal give vectors that are so to the last
/// digit, if the angles have at most ten decimals.
pub fn direction_from_degrees([direction_deg, tilt_deg]: [f64; 2]) -> DVec3 {
    let [(along, across), (plane, height)] = [direction_deg, tilt_deg].map(cos_sin);
    DVec3::new(plane * along, plane * across, height)
}

/// Cosine and sine, from an angle within half a right angle.
fn cos_sin(angle_deg: f64) -> (f64, f64) {
    let turn = angle_deg % 360.0;
    let quarters = (turn / 90.0).round();
    // Ten decimals remove the round-off of the difference.
    let rest = ten_decimals(turn - 90.0 * quarters).to_radians();
    // Half a right angle has one digit for both, which two functions need not give.
    let (cos, sin) = match rest.abs() == FRAC_PI_4 {
        true => (FRAC_1_SQRT_2, FRAC_1_SQRT_2.copysign(rest)),
        false => (rest.cos(), rest.sin()),
    };
    match quarters.rem_euclid(4.0) as u8 {
        0 => (cos, sin),
        1 => (-sin, cos),
        2 => (-cos, -sin),
        _ => (sin, -cos),
    }
}

/// The number rounded to ten decimals, which removes round-off: 0.1 + 0.2 becomes 0.3. Negative
/// zero becomes zero.
pub fn ten_decimals(value: f64) -> f64 {
    decimals(value, 10)
}

/// The number rounded to so many decimals. Negative zero becomes zero.
pub(crate) fn decimals(value: f64, count: usize) -> f64 {
    format!("{value:.count$}").parse::<f64>().unwrap_or(value) + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_keep_symmetry_to_the_last_digit() {
        assert_eq!(direction_from_degrees([450.0, 0.0]), DVec3::Y);
        assert_eq!(direction_from_degrees([12.0, -90.0]), -DVec3::Z);
        assert_eq!(direction_from_degrees([45.0, 0.0]).x, direction_from_degrees([45.0, 0.0]).y);
        for angle in [0.01, 12.34, 39.27, 44.99, 50.73, 89.99] {
            let v = direction_from_degrees([angle, 0.0]);
            let (sin, cos) = f64::to_radians(angle).sin_cos();
            assert!((v - DVec3::new(cos, sin, 0.0)).length() < 1e-15, "{angle}: {v}");
            let image = |degrees: f64| direction_from_degrees([ten_decimals(degrees), 0.0]);
            assert_eq!(image(90.0 - angle), DVec3::new(v.y, v.x, 0.0));
            assert_eq!(image(180.0 - angle), DVec3::new(-v.x, v.y, 0.0));
            assert_eq!(image(-angle), DVec3::new(v.x, -v.y, 0.0));
            assert_eq!(image(angle - 180.0), DVec3::new(-v.x, -v.y, 0.0));
        }
    }

    #[test]
    fn rotations_are_right_handed_and_reduced_to_a_turn() {
        let quarter = rotation_from_degrees(DVec3::Z, 90.0);
        assert!((quarter * DVec3::X - DVec3::Y).length() < 1e-15);
        assert_eq!(rotation_from_degrees(DVec3::Z, 3690.0), quarter);
        assert_eq!(
            rotation_from_degrees(DVec3::Z, -270.0) * DVec3::X,
            rotation_from_degrees(DVec3::Z, -630.0) * DVec3::X
        );
        assert_eq!(rotation_from_degrees(DVec3::Z, 720.0), DQuat::IDENTITY);
    }

    #[test]
    fn unit_vectors_are_those_of_any_finite_vector() {
        for scale in [1e-300, 0.5, 1.0, 1e300] {
            let unit = unit_vector([3.0 * scale, 0.0, -4.0 * scale]).expect("finite");
            assert!((unit - DVec3::new(0.6, 0.0, -0.8)).length() < 1e-15, "{unit}");
        }
        for vector in [[0.0; 3], [f64::NAN, 1.0, 0.0], [f64::INFINITY, 1.0, 0.0]] {
            assert_eq!(unit_vector(vector), None);
        }
    }
}

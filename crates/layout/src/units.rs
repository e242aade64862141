//! Units. Lengths in millimetres and polarizations in tesla pass through unchanged, because the
//! field depends on ratios of lengths only. Rotation angles in degrees become quaternions here.

use glam::{DQuat, DVec3};

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

#[cfg(test)]
mod tests {
    use super::*;

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

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

//! Rotations that share a frame.

use glam::{DQuat, DVec3};
use magsplice_direct::prepare::orientation::Orientations;
use magsplice_magnet::tolerances::SAME_ROTATION;

#[test]
fn equal_rotations_share_a_frame_up_to_quarter_turns() {
    let oblique = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    let other = DQuat::from_rotation_z(1e-6);
    let half = DQuat::from_rotation_x(std::f64::consts::PI);
    let eighth = DQuat::from_rotation_y(std::f64::consts::FRAC_PI_4);
    let rotations = [half, oblique, other, oblique * half, eighth, eighth.inverse(), oblique * other];
    let found = Orientations::new(&rotations);
    let frame = |i: usize| found.members[i].0;
    assert_eq!(frame(0), 0);
    assert_eq!(frame(1), frame(3));
    assert_eq!(frame(4), frame(5));
    assert_eq!(found.frames.len(), 5);
    assert_eq!(found.members[0].1.vector(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(1.0, -2.0, -3.0));
    assert_eq!(found.frames[0], [0, 1, 2]);
}

/// Rotations that differ by less than, about, and more than the limit of equality.
#[test]
fn nearly_equal_rotations() {
    let axis = DVec3::new(1.0, 2.0, 3.0).normalize();
    let mut rotations = Vec::new();
    for n in 0..400 {
        rotations.push(DQuat::from_axis_angle(axis, 0.5 + 1e-16 * f64::from(n)));
    }
    let step = DQuat::from_axis_angle(axis, 10_f64.to_radians());
    let mut turned = DQuat::IDENTITY;
    for _ in 0..360 {
        turned = (turned * step).normalize();
        rotations.push(turned);
    }
    let found = Orientations::new(&rotations);
    for (rotation, (frame, turn)) in rotations.iter().zip(&found.members) {
        let own = DVec3::new(0.3, -0.4, 0.5);
        let error = found.matrix(*frame) * turn.vector(own) - *rotation * own;
        assert!(error.abs().max_element() <= 2.0 * SAME_ROTATION);
    }
}

#[test]
fn frames_turned_about_one_axis_share_it() {
    let about_z = [0.3, -1.9, 2.5].map(DQuat::from_rotation_z);
    let upside_down = DQuat::from_rotation_z(0.8) * DQuat::from_rotation_x(std::f64::consts::PI);
    let found = Orientations::new(&[about_z[0], about_z[1], about_z[2], upside_down]);
    assert!(found.members.iter().all(|(frame, _)| found.frames[*frame].contains(&2)));
    assert_eq!(found.directions.len(), 3 + 4 * 2);
    assert!(found.directions.iter().all(|d| d.x > 0.0 || (d.x == 0.0 && (d.y > 0.0 || (d.y == 0.0 && d.z > 0.0)))));
}

//! The mean tensor against tables, closed forms and laws.

use std::f64::consts::PI;

use glam::{DQuat, DVec3, EulerRot};
use magsplice_magnet::Tile;
use magsplice_pair::tolerances::{TENSOR_ERROR, TURNED_ERROR};
use magsplice_pair::{SymmetricTensor, mean_tensor, mean_tensor_of_boxes};

use crate::reference::rows;

fn tile(size: impl Into<DVec3>, position: impl Into<DVec3>) -> Tile {
    Tile::new(position.into(), size.into(), DVec3::Z).unwrap()
}

fn to_tensor_error(receiver: DVec3, source: DVec3, offset: DVec3) -> SymmetricTensor {
    mean_tensor_of_boxes(receiver, source, offset, TENSOR_ERROR)
}

fn relative_error(value: SymmetricTensor, exact: SymmetricTensor) -> f64 {
    (value + exact * -1.0).norm() / exact.norm()
}

/// All methods, by the distance of each pair.
#[test]
fn tensors_agree_with_eighty_digits() {
    for (tag, numbers) in rows("mean_tensors", 55) {
        let [receiver, source, offset, diagonal, off_diagonal] =
            [0, 3, 6, 9, 12].map(|n: usize| DVec3::from_slice(&numbers[n..]));
        let exact = SymmetricTensor { diagonal, off_diagonal };
        for allowed in [TENSOR_ERROR, 3e-7, 1e-4] {
            let error = relative_error(mean_tensor_of_boxes(receiver, source, offset, allowed), exact);
            assert!(error <= 0.5 * allowed, "{tag} {receiver} {source} {offset}: {error:e}");
        }
    }
}

/// The factor along z of a prism with the half sides a, b, c: A. Aharoni, "Demagnetizing factors
/// for rectangular ferromagnetic prisms", J. Appl. Phys. 83 (1998) 3432, Eq. 1.
fn aharoni([a, b, c]: [f64; 3]) -> f64 {
    let (ab, bc, ac) = (a.hypot(b), b.hypot(c), a.hypot(c));
    let abc = ab.hypot(c);
    let sum = (b * b - c * c) / (2.0 * b * c) * ((abc - a) / (abc + a)).ln()
        + (a * a - c * c) / (2.0 * a * c) * ((abc - b) / (abc + b)).ln()
        + b / (2.0 * c) * ((ab + a) / (ab - a)).ln()
        + a / (2.0 * c) * ((ab + b) / (ab - b)).ln()
        + c / (2.0 * a) * ((bc - b) / (bc + b)).ln()
        + c / (2.0 * b) * ((ac - a) / (ac + a)).ln()
        + 2.0 * (a * b / (c * abc)).atan()
        + (a.powi(3) + b.powi(3) - 2.0 * c.powi(3)) / (3.0 * a * b * c)
        + (a * a + b * b - 2.0 * c * c) / (3.0 * a * b * c) * abc
        + c / (a * b) * (ac + bc)
        - (ab.powi(3) + bc.powi(3) + ac.powi(3)) / (3.0 * a * b * c);
    sum / PI
}

#[test]
fn own_tensor_is_that_of_aharoni_with_trace_one() {
    for sides in [[1.0, 1.0, 1.0], [1.0, 2.0, 3.0], [3.3, 0.85, 1.0], [0.25, 4.0, 1.0], [5.0, 5.0, 1.0]] {
        let box_ = tile(sides, [7.0, -1.0, 0.5]);
        let own = mean_tensor(&box_, &box_).unwrap();
        assert!((own.diagonal.element_sum() - 1.0).abs() <= 1e-13, "{sides:?}: {own:?}");
        assert!(own.off_diagonal.length() <= 1e-15, "{sides:?}: {own:?}");
        assert!((own.diagonal.z - aharoni(sides)).abs() <= 1e-12, "{sides:?}: {own:?} {}", aharoni(sides));
    }
    let cube = mean_tensor(&tile(DVec3::ONE, DVec3::ZERO), &tile(DVec3::ONE, DVec3::ZERO)).unwrap();
    assert!((cube.diagonal - DVec3::splat(1.0 / 3.0)).length() <= 1e-15);
}

/// Near and far pairs with the same axes and with different axes.
fn pairs() -> Vec<[Tile; 2]> {
    let frame = DQuat::from_euler(EulerRot::XYZ, 0.3, -0.7, 1.1);
    let quarter = DQuat::from_rotation_y(0.5 * PI);
    let mut pairs = Vec::new();
    for position in [[1.6, 1.0, 0.25], [-4.0, 3.0, 1.0], [-20.0, 30.0, 5.0]] {
        let [first, second] = [tile([1.0, 1.5, 0.75], DVec3::ZERO), tile([1.5, 2.0, 1.0], position)];
        pairs.push([first, second]);
        pairs.push([first.rotated(frame).unwrap(), second.rotated(frame).unwrap()]);
        pairs.push([first, second.rotated(quarter).unwrap()]);
        pairs.push([first, second.rotated(frame).unwrap()]);
    }
    pairs
}

/// V_a N_ab = V_b N_ba. All tensors are symmetric already.
#[test]
fn tensors_are_reciprocal() {
    for [first, second] in pairs() {
        let there = mean_tensor(&first, &second).unwrap() * first.size().element_product();
        let back = mean_tensor(&second, &first).unwrap() * second.size().element_product();
        assert!(relative_error(there, back) <= 10.0 * TURNED_ERROR, "{first:?} {second:?}");
    }
}

/// The means over the parts of a box average to the mean over the box, and the fields of parts add
/// up.
#[test]
fn parts_add_up_to_the_whole() {
    let (whole, other) = (DVec3::new(1.0, 2.0, 0.5), DVec3::new(0.7, 0.3, 0.9));
    let cuts = [[-1.0, -0.9, -0.3, 0.4, 1.0], [-1.0, -0.5, 0.0, 0.8, 1.0], [-1.0, -0.2, 0.1, 0.9, 1.0]];
    for offset in [DVec3::ZERO, DVec3::new(0.85, 0.1, 0.2), DVec3::new(3.0, -2.0, 1.0), DVec3::new(9.0, 5.0, 1.0)] {
        let (mut mean, mut sum) = (SymmetricTensor::ZERO, SymmetricTensor::ZERO);
        for part in 0..64_usize {
            let ends = [0, 1, 2]
                .map(|axis: usize| (cuts[axis][part >> (2 * axis) & 3], cuts[axis][(part >> (2 * axis) & 3) + 1]));
            let size = 0.5 * whole * DVec3::from_array(ends.map(|(lower, upper)| upper - lower));
            let shift = 0.25 * whole * DVec3::from_array(ends.map(|(lower, upper)| upper + lower));
            let share = size.element_product() / whole.element_product();
            mean += to_tensor_error(size, other, offset + shift) * share;
            sum += to_tensor_error(other, size, offset - shift);
        }
        let error = relative_error(mean, to_tensor_error(whole, other, offset));
        assert!(error <= 2.0 * TENSOR_ERROR, "receiver at {offset}: {error:e}");
        let error = relative_error(sum, to_tensor_error(other, whole, offset));
        assert!(error <= 2.0 * TENSOR_ERROR, "source at {offset}: {error:e}");
    }
}

/// Far away the tensor equals the tensor of a dipole. Cubes have no quadrupole and no octupole, so
/// the error has the fourth power of side over distance.
#[test]
fn distant_cubes_are_dipoles() {
    for distance in [30.0, 1e3, 1e6] {
        let direction = DVec3::new(0.6, -0.48, 0.64);
        let value = to_tensor_error(DVec3::splat(0.5), DVec3::ONE, distance * direction);
        let dipole = SymmetricTensor {
            diagonal: DVec3::ONE - 3.0 * direction * direction,
            off_diagonal: -3.0
                * DVec3::new(direction.y * direction.z, direction.z * direction.x, direction.x * direction.y),
        } * (1.0 / (4.0 * PI * distance.powi(3)));
        let error = relative_error(value, dipole);
        assert!(error <= distance.powi(-4) + 1e-14, "{distance}: {error:e}");
    }
}

#[test]
fn overlapping_turned_tiles_are_averaged_or_refused() {
    let first = tile(DVec3::ONE, DVec3::ZERO);
    let second = tile(DVec3::ONE, DVec3::ZERO).rotated(DQuat::from_rotation_z(0.4)).unwrap();
    if let Err(error) = mean_tensor(&first, &second) {
        assert!(error.to_string().contains("must not overlap"), "{error}");
    }
}

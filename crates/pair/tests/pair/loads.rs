//! Forces and torques of pairs against independent references and laws.

use glam::{DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_magnet::{MU_0, Quantity, Tile};
use magsplice_pair::{Load, pair_loads};
use proptest::prelude::*;

use crate::reference::rows;

/// The tolerance of turned pairs in these tests.
const TOLERANCE: f64 = 1e-9;

fn tile(size: [f64; 3], polarization_t: [f64; 3], position: [f64; 3]) -> Tile {
    Tile::new(position.into(), size.into(), polarization_t.into()).unwrap()
}

fn loads(first: &Tile, second: &Tile) -> [Load; 2] {
    pair_loads(first, second, TOLERANCE).unwrap()
}

/// Difference of two loads over the larger of them; torques over the sum of the tiles' diagonals.
fn difference(a: Load, b: Load, arm: f64) -> f64 {
    let size = (b.force.length() * arm).max(b.torque.length());
    ((a.force - b.force).length() * arm).max((a.torque - b.torque).length()) / size
}

fn arm(first: &Tile, second: &Tile) -> f64 {
    0.5 * (first.size().length() + second.size().length())
}

/// Charges integrated in the field of the other cuboid with 30 digits: tests/reference/README.md.
#[test]
fn pairs_agree_with_integrals_of_thirty_digits() {
    for (tag, numbers) in rows("pair_loads", 12) {
        let vector = |n: usize| [numbers[n], numbers[n + 1], numbers[n + 2]];
        let first = tile(vector(0), vector(3), vector(6));
        let second = tile(vector(9), vector(12), vector(15));
        let exact = Load { force: vector(18).into(), torque: vector(21).into() };
        let error = difference(loads(&first, &second)[0], exact, arm(&first, &second));
        assert!(error < 1e-15, "{tag} {numbers:?}: {error:e}, {:?}", loads(&first, &second)[0]);
    }
}

/// Force along z on the second of two blocks magnetized along z, by the formula that Akoun and
/// Yonnet published, in their notation.
fn akoun_yonnet(first: &Tile, second: &Tile) -> DVec3 {
    let (a, big_a) = (0.5 * first.size(), 0.5 * second.size());
    let apart = second.position() - first.position();
    let mut sum = DVec3::ZERO;
    for n in 0..64_u32 {
        let sign = |bit: u32| if n >> bit & 1 == 1 { -1.0 } else { 1.0 };
        let u = apart.x + sign(0) * big_a.x - sign(1) * a.x;
        let v = apart.y + sign(2) * big_a.y - sign(3) * a.y;
        let w = apart.z + sign(4) * big_a.z - sign(5) * a.z;
        let r = (u * u + v * v + w * w).sqrt();
        let (log_u, log_v, angle) = ((r - u).ln(), (r - v).ln(), (u * v / (r * w)).atan());
        let phi = DVec3::new(
            0.5 * (v * v - w * w) * log_u + u * v * log_v + v * w * angle + 0.5 * r * u,
            0.5 * (u * u - w * w) * log_v + u * v * log_u + u * w * angle + 0.5 * r * v,
            -u * w * log_u - v * w * log_v + u * v * angle - r * w,
        );
        sum += if n.count_ones() % 2 == 0 { phi } else { -phi };
    }
    sum * first.polarization_t().z * second.polarization_t().z / (4.0 * std::f64::consts::PI * MU_0)
}

#[test]
fn forces_agree_with_akoun_and_yonnet() {
    // The example of their paper, two cuboids of 20 x 12 x 6 and 12 x 20 x 6 mm with 0.38 T, one
    // above the other, and further pairs.
    for (x, y, z) in [(-4.0, -4.0, 8.0), (3.1, -4.0, 8.0), (16.9, -4.0, 8.0), (1.3, 2.7, 7.0), (-9.0, 17.5, 1.0)] {
        let first = tile([20.0, 12.0, 6.0], [0.0, 0.0, 0.38], [0.0; 3]);
        let second = tile([12.0, 20.0, 6.0], [0.0, 0.0, 0.38], [x, y, z]);
        let (force, published) = (loads(&first, &second)[1].force, akoun_yonnet(&first, &second));
        // 64 terms of up to 25^2 ln 50 cancel to sums of about 100.
        assert!((force - published).length() < 1e-12 * published.length(), "{force} {published}");
    }
}

/// Gauss-Legendre nodes and weights on [-1, 1] by Newton's method.
fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let node = |k: usize| {
        let mut x = (std::f64::consts::PI * (k as f64 + 0.75) / (count as f64 + 0.5)).cos();
        let mut slope = 0.0;
        for _ in 0..20 {
            let (mut p0, mut p1) = (1.0, x);
            for n in 2..=count {
                (p0, p1) = (p1, ((2 * n - 1) as f64 * x * p1 - (n - 1) as f64 * p0) / n as f64);
            }
            slope = count as f64 * (x * p1 - p0) / (x * x - 1.0);
            x -= p1 / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(node).collect()
}

/// Energy of a tile in the field of another tile: -J . H over its volume.
fn energy(tile: &Tile, source: &Scene, rule: &[(f64, f64)]) -> f64 {
    let half = 0.5 * tile.size();
    let mut points = Vec::new();
    let mut weights = Vec::new();
    for (u, weight_u) in rule {
        for (v, weight_v) in rule {
            for (w, weight_w) in rule {
                points.push(tile.position() + tile.rotation() * (half * DVec3::new(*u, *v, *w)));
                weights.push(weight_u * weight_v * weight_w * half.element_product());
            }
        }
    }
    let field = source.field_at(Quantity::FieldStrength, &points).unwrap();
    let sum: f64 = weights.iter().zip(field).map(|(weight, h)| weight * tile.scene_polarization_t().dot(h)).sum();
    -sum
}

/// The derivative at 0, by differences of eighth order.
fn derivative(function: impl Fn(f64) -> f64) -> f64 {
    const STEP: f64 = 0.02;
    let weights = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let term = |(n, weight): (usize, &f64)| {
        let step = (n + 1) as f64 * STEP;
        weight * (function(step) - function(-step))
    };
    weights.iter().enumerate().map(term).sum::<f64>() / STEP
}

/// Force and torque are the derivatives of the energy by shifts and turns.
#[test]
fn loads_are_derivatives_of_the_energy() {
    let rule = gauss_legendre(14);
    let first = tile([1.0, 1.5, 0.75], [0.4, -0.3, 0.9], [0.0; 3]);
    for rotation in [DQuat::IDENTITY, DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -0.7, 1.1)] {
        let second = tile([1.25, 0.5, 1.0], [-0.2, 0.8, 0.5], [1.4, 1.6, -1.5]).rotated(rotation).unwrap();
        let source = Scene::new(&[second]);
        let [load, _] = loads(&first, &second);
        let along = |axis: DVec3| {
            -derivative(|s| {
                let moved = Tile::new(first.position() + s * axis, first.size(), first.polarization_t()).unwrap();
                energy(&moved, &source, &rule)
            })
        };
        let about = |axis: DVec3| {
            -derivative(|s| energy(&first.rotated(DQuat::from_axis_angle(axis, s)).unwrap(), &source, &rule))
        };
        let expected = Load {
            force: DVec3::from_array(DVec3::AXES.map(along)),
            torque: DVec3::from_array(DVec3::AXES.map(about)),
        };
        let error = difference(load, expected, arm(&first, &second));
        assert!(error < if rotation == DQuat::IDENTITY { 1e-10 } else { 1e-9 }, "{error:e}: {load:?} {expected:?}");
    }
}

/// Two tiles separated along x by more than their sides, so they do not overlap.
fn tiles_apart() -> impl Strategy<Value = (Tile, Tile)> {
    let side = || prop::array::uniform3(0.1..3.0_f64);
    let polarization = || prop::array::uniform3(-1.0..1.0_f64);
    (side(), polarization(), side(), polarization(), 0.0..2.0_f64, -4.0..4.0_f64, -4.0..4.0_f64).prop_map(
        |(size, j, other_size, other_j, gap, y, z)| {
            let x = 0.5 * (size[0] + other_size[0]) + gap;
            (tile(size, j, [0.0; 3]), tile(other_size, other_j, [x, y, z]))
        },
    )
}

/// The load with every product of components of the polarizations positive, which bounds the
/// cancelling terms.
fn scale_of(first: &Tile, second: &Tile) -> f64 {
    let near = arm(first, second).min((first.position() - second.position()).length());
    let j = first.polarization_t().length() * second.polarization_t().length();
    let distance = (first.position() - second.position()).length();
    let volumes = first.size().element_product() * second.size().element_product();
    j * volumes / (MU_0 * distance.powi(4)) * near.max(1e-3)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// Each tile computed in the frame of the other gives the same pair of forces.
    #[test]
    fn action_is_reaction((first, second) in tiles_apart()) {
        let ([on_first, on_second], [swapped_second, swapped_first]) = (loads(&first, &second), loads(&second, &first));
        prop_assert_eq!(on_first.force, -on_second.force);
        let scale = scale_of(&first, &second);
        for (a, b) in [(on_first, swapped_first), (on_second, swapped_second)] {
            prop_assert!((a.force - b.force).length() * arm(&first, &second) < 1e-12 * scale);
            prop_assert!((a.torque - b.torque).length() < 1e-12 * scale * 10.0);
        }
        let offset = second.position() - first.position();
        let turning = on_first.torque + on_second.torque + offset.cross(on_second.force);
        prop_assert!(turning.length() < 1e-13 * scale * 10.0);
    }

    /// A block has the load of the two blocks into which it is cut.
    #[test]
    fn cut_block_keeps_its_load((first, second) in tiles_apart(), axis in 0..3_usize, at in 0.1..0.9_f64) {
        let load = loads(&first, &second)[0];
        let mut sum = Load::ZERO;
        for (share, from) in [(at, 0.0), (1.0 - at, at)] {
            let (mut size, mut position) = (first.size(), first.position());
            size[axis] *= share;
            position[axis] += first.size()[axis] * (from + 0.5 * share - 0.5);
            let part = Tile::new(position, size, first.polarization_t()).unwrap();
            let [on_part, _] = loads(&part, &second);
            let torque = on_part.torque + (position - first.position()).cross(on_part.force);
            sum += Load { force: on_part.force, torque };
        }
        let scale = scale_of(&first, &second);
        prop_assert!((load.force - sum.force).length() * arm(&first, &second) < 1e-11 * scale);
        prop_assert!((load.torque - sum.torque).length() < 1e-11 * scale * 10.0);
    }

    /// Forces do not depend on the common position of both tiles, and grow with the square of their
    /// lengths.
    #[test]
    fn shifted_and_scaled_tiles_keep_their_loads((first, second) in tiles_apart(), power in -30..30_i32) {
        let factor = 2_f64.powi(power);
        let scaled = |t: &Tile| Tile::new(t.position() * factor, t.size() * factor, t.polarization_t()).unwrap();
        let ([load, _], [large, _]) = (loads(&first, &second), loads(&scaled(&first), &scaled(&second)));
        prop_assert_eq!(load.force * factor * factor, large.force);
        prop_assert_eq!(load.torque * factor * factor * factor, large.torque);
        // Positions of a few more bits than differences.
        let round = |t: &Tile| Tile::new((t.position() * 1024.0).round() / 1024.0, t.size(), t.polarization_t()).unwrap();
        let shift = DVec3::new(512.0, -64.0, 1024.0);
        let moved = |t: &Tile| Tile::new(t.position() + shift, t.size(), t.polarization_t()).unwrap();
        let (first, second) = (round(&first), round(&second));
        // A gap below the round-off of the shifted positions counts as contact.
        prop_assume!((second.position().x - 0.5 * (first.size().x + second.size().x)).abs() > 1e-9);
        prop_assert_eq!(loads(&first, &second), loads(&moved(&first), &moved(&second)));
    }

    /// Tiles turned together keep their loads, in the turned frame.
    #[test]
    fn tiles_turned_together_keep_their_loads((first, second) in tiles_apart(), angles in prop::array::uniform3(-3.0..3.0_f64)) {
        let rotation = DQuat::from_euler(glam::EulerRot::XYZ, angles[0], angles[1], angles[2]);
        let turned = |t: &Tile| {
            Tile::new(rotation * t.position(), t.size(), t.polarization_t()).unwrap().rotated(rotation).unwrap()
        };
        // Round-off of the turned positions moves faces by 1e-15, which matters at gaps of this
        // size.
        prop_assume!(second.position().x - 0.5 * (first.size().x + second.size().x) > 1e-3);
        let ([load, _], [seen, _]) = (loads(&first, &second), loads(&turned(&first), &turned(&second)));
        let scale = scale_of(&first, &second);
        prop_assert!((rotation * load.force - seen.force).length() * arm(&first, &second) < 1e-10 * scale);
        prop_assert!((rotation * load.torque - seen.torque).length() < 1e-10 * scale * 10.0);
    }

    /// Far away the load equals the load of two dipoles, up to the square of size over distance.
    #[test]
    fn distant_tiles_are_dipoles((first, second) in tiles_apart(), direction in prop::array::uniform3(-1.0..1.0_f64)) {
        let direction = DVec3::from_array(direction);
        prop_assume!(direction.length() > 0.1);
        let distance = 1e4;
        let offset = -direction.normalize() * distance;
        let second = Tile::new(-offset, second.size(), second.polarization_t()).unwrap();
        let moment = |t: &Tile| t.polarization_t() * t.size().element_product();
        let (m, source, e) = (moment(&first), moment(&second), offset / distance);
        let factor = 1.0 / (4.0 * std::f64::consts::PI * MU_0);
        let force = 3.0 * (m.dot(source) * e + source.dot(e) * m + m.dot(e) * source - 5.0 * m.dot(e) * source.dot(e) * e)
            * (factor / distance.powi(4));
        let torque = m.cross(3.0 * source.dot(e) * e - source) * (factor / distance.powi(3));
        let [load, _] = loads(&first, &second);
        let size = m.length() * source.length() * factor / distance.powi(3);
        prop_assert!((load.force - force).length() < 1e-6 * size / distance);
        prop_assert!((load.torque - torque).length() < 1e-6 * size);
    }
}

/// A tile turned by 90 degrees equals a tile with exchanged sides.
#[test]
fn quarter_turn_exchanges_sides() {
    let first = tile([3.25, 1.75, 1.0], [0.12, 0.05, -0.02], [0.0, 0.0, 0.5]);
    let turned = tile([1.0, 2.0, 3.0], [0.3, 0.1, -0.2], [2.75, 0.5, 0.25])
        .rotated(DQuat::from_rotation_z(90_f64.to_radians()))
        .unwrap();
    let exchanged = tile([2.0, 1.0, 3.0], [-0.1, 0.3, -0.2], [2.75, 0.5, 0.25]);
    assert_eq!(loads(&first, &turned), loads(&first, &exchanged));
}

/// Faces that touch up to round-off, from either side, have the force of contact.
#[test]
fn contact_does_not_depend_on_round_off() {
    let first = tile([1.0; 3], [0.0, 0.0, 1.0], [0.0; 3]);
    let at = |z: f64| loads(&first, &tile([1.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, z]))[0].force.z;
    for z in [1.0_f64.next_down(), 1.0_f64.next_up(), 1.0 + 1e-12] {
        assert!((at(z) - at(1.0)).abs() < 1e-10 * at(1.0), "{z}: {} {}", at(z), at(1.0));
        assert!((at(-z) + at(1.0)).abs() < 1e-10 * at(1.0));
    }
    // Two faces of one size and charge attract at least with J^2 A / (2 mu0) minus the force of the
    // far faces.
    assert!(at(1.0) > 0.0 && at(1.0) < 0.5 / MU_0);
}

/// The error of turned tiles whose force does not converge includes advice.
#[test]
fn turned_tiles_in_contact_may_not_converge() {
    let first = tile([2.0; 3], [0.0, 0.0, 1.0], [0.0; 3]);
    let second = tile([2.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, 2.0]).rotated(DQuat::from_rotation_z(0.4)).unwrap();
    let error = pair_loads(&first, &second, 1e-15).unwrap_err();
    assert!(error.reached > error.tolerance && error.to_string().contains("leave a gap"), "{error}");
    assert!(pair_loads(&first, &second, f64::NAN).is_err());
}

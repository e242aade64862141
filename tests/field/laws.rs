//! Physical laws on chosen scenes.

use std::f64::consts::PI;

use approx::assert_abs_diff_eq;
use glam::{DQuat, DVec3};
use magsplice_field::{MU_0, Quantity, Scene, Tile};

fn tile(position: DVec3, size: DVec3, polarization_t: DVec3) -> Tile {
    Tile::new(position, size, polarization_t).expect("a valid tile")
}

fn block() -> Tile {
    tile(DVec3::new(0.2, -0.1, 0.5), DVec3::new(3.3, 3.3, 1.0), DVec3::new(0.3, -0.5, 0.7))
}

/// Equal tiles that fill `whole`, `counts` along each axis.
fn divided(whole: &Tile, counts: [usize; 3]) -> Vec<Tile> {
    let n = DVec3::from(counts.map(|c| c as f64));
    let size = whole.size() / n;
    let corner = whole.position() - 0.5 * whole.size();
    let mut parts = Vec::new();
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            for k in 0..counts[2] {
                let index = DVec3::new(i as f64 + 0.5, j as f64 + 0.5, k as f64 + 0.5);
                parts.push(tile(corner + index * size, size, whole.polarization_t()));
            }
        }
    }
    parts
}

fn generic_points() -> Vec<DVec3> {
    let mut points = Vec::new();
    for i in 0..9 {
        for j in 0..9 {
            for k in 0..9 {
                // Points inside, near and outside, off every plane of the divisions.
                points.push(DVec3::new(
                    0.513 * f64::from(i) - 2.03,
                    0.527 * f64::from(j) - 2.11,
                    0.291 * f64::from(k) - 0.61,
                ));
            }
        }
    }
    points
}

fn b(scene: &Scene, point: DVec3) -> DVec3 {
    scene.field(Quantity::FluxDensity, point).expect("bounded")
}

/// A block is the sum of its parts.
#[test]
fn square_tile_is_the_sum_of_4_9_and_64_parts() {
    let whole = Scene::new(&[block()]);
    for counts in [[2, 2, 1], [3, 3, 1], [4, 4, 4]] {
        let parts = divided(&block(), counts);
        let scene = Scene::new(&parts);
        for point in generic_points() {
            // The error of each part is below 1e-14 of its own field here. The coordinates of the
            // parts are rounded, which moves faces by 1e-16 and changes B by this over the
            // distance.
            let magnitudes: f64 = parts.iter().map(|&part| b(&Scene::new(&[part]), point).length()).sum();
            let allowed = 1e-14 * magnitudes;
            assert_abs_diff_eq!(b(&scene, point).distance(b(&whole, point)), 0.0, epsilon = allowed);
        }
    }
}

/// Sixth-order central difference of a component.
fn derivative(f: impl Fn(DVec3) -> f64, at: DVec3, axis: usize, h: f64) -> f64 {
    let step = |n: f64| {
        let mut moved = at;
        moved[axis] += n * h;
        f(moved)
    };
    let odd = |n: f64| step(n) - step(-n);
    (45.0 * odd(1.0) - 9.0 * odd(2.0) + odd(3.0)) / (60.0 * h)
}

#[test]
fn div_b_and_curl_h_vanish() {
    let beside = tile(DVec3::new(0.2, 2.4, 0.5), DVec3::new(3.3, 1.7, 1.0), DVec3::new(0.0, 0.12, 0.0));
    let scene = Scene::new(&[block(), beside]);
    // Inside both tiles, beside and below them; at least 0.25 from every face.
    let points = [
        DVec3::new(0.3, 0.2, 0.5),
        DVec3::new(-0.9, -1.2, 0.45),
        DVec3::new(0.2, 2.3, 0.55),
        DVec3::new(2.5, 0.4, -0.7),
        DVec3::new(-2.2, 1.1, 0.3),
        DVec3::new(0.1, 0.2, -3.0),
    ];
    let d = |quantity: Quantity, component: usize, at: DVec3, axis: usize| {
        derivative(|p| scene.field(quantity, p).expect("bounded")[component], at, axis, 0.01)
    };
    // Truncation: h^6 / 140 times a seventh derivative, which at 0.25 from a face is below 7! |J| /
    // (4 pi 0.25^7): 4e-8. Rounding: 1e-15 |J| / h = 1e-13.
    let allowed = 5e-8;
    for at in points {
        let div: f64 = (0..3).map(|axis| d(Quantity::FluxDensity, axis, at, axis)).sum();
        assert_abs_diff_eq!(div, 0.0, epsilon = allowed);
        for (a, c) in [(0, 1), (1, 2), (2, 0)] {
            let curl = d(Quantity::FieldStrength, c, at, a) - d(Quantity::FieldStrength, a, at, c);
            assert_abs_diff_eq!(curl * MU_0, 0.0, epsilon = allowed);
        }
    }
}

/// Rotating tiles and points together rotates the field.
#[test]
fn rotated_scene_has_the_rotated_field() {
    let tiles = [
        block(),
        tile(DVec3::new(4.0, 1.0, -0.5), DVec3::new(1.0, 2.0, 0.3), DVec3::new(0.1, 0.2, -0.9))
            .rotated(DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -1.0).normalize(), 0.8))
            .unwrap(),
    ];
    let scene = Scene::new(&tiles);
    let axis = DVec3::new(0.3, -0.2, 0.9).normalize();
    for turn in [DQuat::from_axis_angle(axis, 1.1), DQuat::from_rotation_x(0.5 * PI), DQuat::from_rotation_z(1e-7)] {
        let turned = tiles.map(|t| {
            let own = Tile::new(turn * t.position(), t.size(), t.polarization_t()).unwrap();
            own.rotated(turn * t.rotation()).unwrap()
        });
        let turned = Scene::new(&turned);
        for point in generic_points() {
            let expected = turn * b(&scene, point);
            // Points move by a few 1e-16 of their distance of up to 5. The nearest face is 0.01
            // away, where the field changes by |J| over that distance.
            assert_abs_diff_eq!(b(&turned, turn * point).distance(expected), 0.0, epsilon = 5.0 * 8.0 * 1.1e-16 / 0.01);
        }
    }
}

/// B = mu0 H + J with J of the owner.
#[test]
fn b_is_mu0_h_plus_j() {
    let scene = Scene::new(&[block()]);
    let mut inside = 0;
    for point in generic_points() {
        let h = scene.field(Quantity::FieldStrength, point).unwrap();
        let j = scene.field(Quantity::Polarization, point).unwrap();
        inside += usize::from(j != DVec3::ZERO);
        // Three numbers of at most |J| = 0.91 with relative error 2e-14.
        assert_abs_diff_eq!((b(&scene, point) - MU_0 * h - j).length(), 0.0, epsilon = 1.2e-14);
    }
    assert!(inside > 50, "the points must be on both sides");
}

#[test]
fn distant_field_is_that_of_a_dipole() {
    let (scene, whole) = (Scene::new(&[block()]), block());
    let direction = DVec3::new(0.48, -0.6, 0.64);
    for distance in [1e3, 1e5, 1e9] {
        let moment = whole.polarization_t() * whole.size().element_product() / (4.0 * PI);
        let dipole = (3.0 * direction * moment.dot(direction) - moment) / f64::powi(distance, 3);
        let field = b(&scene, whole.position() + distance * direction);
        // The next multipole of a block is smaller by (size / distance)^2, times a coefficient of 5
        // to 10. The position is rounded.
        let allowed = 10.0 * (3.3 / distance).powi(2) + 1e-15;
        assert!((field - dipole).length() <= allowed * dipole.length(), "at {distance}");
    }
}

/// The sum over tiles is compensated: a weak tile keeps all its digits beside strong tiles that
/// cancel.
#[test]
fn weak_tile_keeps_its_digits_between_strong_ones() {
    let weak = tile(DVec3::new(3.0, 0.0, 0.0), DVec3::ONE, DVec3::new(1e-9, 2e-9, -1e-9));
    let strong = |sign: f64| tile(DVec3::ZERO, DVec3::ONE, sign * DVec3::new(0.9, -0.7, 0.8));
    let scene = Scene::new(&[strong(1.0), weak, strong(-1.0)]);
    // Near the strong tiles, where each tile is evaluated alone.
    let point = DVec3::new(0.53, 0.3, -0.2);
    let exact = b(&Scene::new(&[weak]), point);
    // The strong fields are opposite to the last bit, so one rounding remains.
    assert!((b(&scene, point) - exact).length() <= 2.3e-16 * exact.length());
}

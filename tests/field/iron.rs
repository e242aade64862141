//! Flat iron beside tiles.

use glam::{DQuat, DVec3};
use magsplice_field::{
    Accuracy, FittedFieldError, Grid, IronPlane, IronPlanes, MU_0, PointErrorCause, Quantity, Scene, Tile, Tolerance,
};

fn plane(z: f64, up: f64, mu_r: f64) -> IronPlane {
    IronPlane::new(DVec3::new(3.0, -1.0, z), DVec3::new(0.0, 0.0, up), mu_r).expect("a plane")
}

fn planes(planes: &[IronPlane]) -> IronPlanes {
    IronPlanes::new(planes.to_vec()).expect("parallel planes")
}

fn tile(position: [f64; 3], j_t: [f64; 3], turn: DQuat) -> Tile {
    let tile = Tile::new(position.into(), DVec3::new(3.0, 2.0, 1.0), j_t.into());
    tile.and_then(|tile| tile.rotated(turn)).expect("a tile")
}

fn tiles() -> Vec<Tile> {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 0.2);
    vec![
        tile([1.0, 2.0, 0.5], [0.1, 0.2, 0.3], DQuat::IDENTITY),
        tile([-2.0, 0.0, 0.0], [-0.3, 0.1, 0.2], turn),
        tile([0.0, -3.0, 0.4], [0.0, 0.0, 0.4], DQuat::from_rotation_z(0.4)),
    ]
}

/// The mirror image of a tile in a plane of constant z, from the rotation by the mirrored angles: a
/// reflection in z reverses rotations about x and y.
fn mirrored(tile: &Tile, z: f64, factor: f64) -> Tile {
    let (at, j_t, turn) = (tile.position(), tile.polarization_t(), tile.rotation());
    let image =
        Tile::new(DVec3::new(at.x, at.y, 2.0 * z - at.z), tile.size(), factor * DVec3::new(-j_t.x, -j_t.y, j_t.z));
    image.and_then(|image| image.rotated(DQuat::from_xyzw(-turn.x, -turn.y, turn.z, turn.w))).expect("an image")
}

fn points() -> Vec<DVec3> {
    Grid::new(DVec3::new(-3.0, -3.0, -4.0), DVec3::new(3.0, 3.0, -2.0), [9, 9, 4]).expect("a grid").points().collect()
}

/// The field beside one plane is that of a layout with the image tiles.
#[test]
fn a_plane_has_the_field_of_explicit_images() {
    for (mu_r, factor) in [(f64::INFINITY, 1.0), (1000.0, 999.0 / 1001.0), (3.0, 0.5)] {
        let images: Vec<Tile> = tiles().iter().map(|tile| mirrored(tile, 1.5, factor)).collect();
        let explicit = Scene::new(&[tiles(), images].concat());
        let scene = Scene::new(&tiles()).with_planes(&planes(&[plane(1.5, -1.0, mu_r)])).expect("before the plane");
        assert_eq!(scene.truncation_error_t(), 0.0);
        for quantity in [Quantity::FluxDensity, Quantity::FieldStrength] {
            let expected = explicit.field_at(quantity, &points()).expect("a field");
            let found = scene.field_at(quantity, &points()).expect("a field");
            for (found, expected) in found.iter().zip(&expected) {
                assert!((*found - *expected).length() <= 1e-13 * expected.length(), "{found} {expected}");
            }
        }
        let [found, expected] =
            [&scene, &explicit].map(|scene| scene.gradient_at(Quantity::FluxDensity, &points()).expect("a gradient"));
        for (found, expected) in found.iter().zip(&expected) {
            let largest = expected.to_cols_array().into_iter().fold(0.0_f64, |largest, of| largest.max(of.abs()));
            let difference = (*found - *expected).to_cols_array();
            assert!(difference.into_iter().all(|of| of.abs() <= 1e-13 * largest), "{found} {expected}");
        }
    }
}

/// On iron of infinite permeability, H has no component along the surface: at oblique planes, and
/// between two planes to the error of the series.
#[test]
fn field_lines_meet_ideal_iron_at_right_angles() {
    let normal = DVec3::new(0.2, -0.3, -1.0).normalize();
    let oblique = IronPlane::new(-2.5 * normal, normal, f64::INFINITY).expect("a plane");
    let facing = IronPlane::new(6.0 * normal, -normal, f64::INFINITY).expect("a plane");
    let (along, across) = (normal.any_orthonormal_pair().0, normal.any_orthonormal_pair().1);
    for iron in [planes(&[oblique]), planes(&[oblique, facing])] {
        let scene = Scene::new(&tiles()).with_planes(&iron).expect("before the planes");
        assert!(scene.truncation_error_t() < 2e-7, "{}", scene.truncation_error_t());
        for plane in iron.planes() {
            // A point on a plane is in the iron. Over 1e-9 mm the field varies by less than 1e-8.
            let point = |n: f64| plane.point() + (n - 4.0) * along + (0.3 * n - 1.0) * across + 1e-9 * plane.normal();
            let places: Vec<DVec3> = (0..9).map(|n| point(f64::from(n))).collect();
            for b_t in scene.field_at(Quantity::FluxDensity, &places).expect("a field") {
                let tangential_t = (b_t - b_t.dot(normal) * normal).length();
                assert!(tangential_t <= 1e-8 * b_t.length() + scene.truncation_error_t(), "{tangential_t} of {b_t}");
                assert!(b_t.length() > 1e-4, "{b_t}");
            }
        }
    }
}

/// The omitted images of two planes have less field than the stated error, which 20 000 images of
/// each tile show.
#[test]
fn omitted_images_keep_the_truncation_error() {
    let tiles = &tiles()[..1];
    for (mu_r, factor) in [(f64::INFINITY, 1.0), (100.0, 99.0 / 101.0)] {
        let iron = planes(&[plane(1.2, -1.0, mu_r), plane(-5.0, 1.0, mu_r)]);
        let scene = Scene::new(tiles).with_planes(&iron).expect("before the planes");
        let mut all = tiles.to_vec();
        for first in [0, 1] {
            let mut last = tiles.to_vec();
            for reflection in 0..10_000 {
                let z = [1.2, -5.0][(first + reflection) % 2];
                last = last.iter().map(|tile| mirrored(tile, z, factor)).collect();
                all.extend(&last);
            }
        }
        let places = [DVec3::new(0.5, 0.2, -2.0), DVec3::new(4.0, -1.0, -4.9), DVec3::new(20.0, 0.0, -1.0)];
        let [found_t, expected_t] =
            [&scene, &Scene::new(&all)].map(|scene| scene.field_at(Quantity::FluxDensity, &places).expect("a field"));
        for (found_t, expected_t) in found_t.iter().zip(&expected_t) {
            let error_t = (*found_t - *expected_t).length();
            assert!(error_t <= scene.truncation_error_t(), "{error_t} {}", scene.truncation_error_t());
        }
        let bounds_t = scene.error_bounds_t(&places);
        assert!(bounds_t.iter().all(|bound_t| *bound_t >= scene.truncation_error_t()));
    }
}

/// Points on and behind a plane are errors of their own in every call; other points keep their
/// values and errors.
#[test]
fn points_in_iron_are_refused() {
    let iron = planes(&[plane(-5.0, 1.0, 1000.0)]);
    let exact = Scene::new(&tiles()).with_planes(&iron).expect("before the plane");
    let tolerance = Accuracy::Within(Tolerance::relative(1e-6).expect("a tolerance"));
    let within = Scene::new(&tiles()).with_accuracy(tolerance).with_planes(&iron).expect("before the plane");
    let grid = Grid::new(DVec3::new(-1.0, 0.0, -6.0), DVec3::new(1.0, 0.0, -4.0), [3, 1, 3]).expect("a grid");
    for scene in [&exact, &within] {
        let mut field = vec![DVec3::ZERO; grid.len()];
        let errors = scene.field_on_grid_into(Quantity::FluxDensity, &grid, &mut field).expect_err("points in iron").0;
        let in_iron: Vec<usize> = (0..grid.len()).filter(|index| grid.point(*index).z <= -5.0).collect();
        assert_eq!(errors.iter().map(|error| error.index).collect::<Vec<_>>(), in_iron);
        assert!(errors.iter().all(|error| error.cause == PointErrorCause::InIron { plane: 0 }));
        assert!(field.iter().enumerate().all(|(index, b_t)| b_t.is_nan() == in_iron.contains(&index)));
    }
    let inside = DVec3::new(0.0, 0.0, -5.0);
    let outside = DVec3::new(0.0, 0.0, -4.0);
    assert_eq!(exact.field(Quantity::Polarization, inside), Err(PointErrorCause::InIron { plane: 0 }));
    assert_eq!(exact.gradient(Quantity::FluxDensity, inside), Err(PointErrorCause::InIron { plane: 0 }));
    let errors = exact.gradient_at(Quantity::FluxDensity, &[outside, inside, DVec3::NAN]).expect_err("two points").0;
    let causes: Vec<PointErrorCause> = errors.iter().map(|error| error.cause).collect();
    assert_eq!(causes, [PointErrorCause::InIron { plane: 0 }, PointErrorCause::OutOfRange]);
    let below = Tolerance::relative(1e-3).expect("a tolerance");
    let fitted = exact.fitted_field(DVec3::new(-1.0, -1.0, -5.5), DVec3::new(1.0, 1.0, -4.0), below);
    assert_eq!(fitted.err(), Some(FittedFieldError::InIron));
    // B = mu_0 H where no tile is, images or not.
    let [b_t, h_a_m] = [Quantity::FluxDensity, Quantity::FieldStrength]
        .map(|quantity| exact.field(quantity, outside).expect("a field"));
    assert!((b_t - MU_0 * h_a_m).length() < 1e-15);
}

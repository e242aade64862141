//! B, H and the gradient of one tile against the oracle of 130 digits, on the reference tables and
//! on random tiles and points.

use glam::{DMat3, DQuat, DVec3};
use magsplice_field::{EXACT_BOUND, GRADIENT_BOUND, MU_0, PointErrorCause, Quantity, Scene, Tile};
use magsplice_tests::oracle::Oracle;
use magsplice_tests::{cases, reference_tables, scenes, share};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

/// Largest relative error of |B| and |H|.
const FIELD: f64 = EXACT_BOUND;

/// Largest error of the gradient, as a fraction of its largest component.
const GRADIENT: f64 = GRADIENT_BOUND;

/// Error of the gradient in the middle of a tile, where it is zero by symmetry up to the round-off
/// of the oracle's differences.
const SYMMETRIC_ZERO: f64 = 1e-90;

/// The error bound of B at a point is at least the exact bound of the sum of the magnitudes of the
/// fields of the single components of J. It is proportional to J, and infinite at invalid points.
#[test]
fn error_bounds_are_at_least_the_exact_bound() {
    let (size, j) = (DVec3::new(3.3, 1.7, 1.0), DVec3::new(0.3, -0.5, 0.7));
    let scene = |j: DVec3| Scene::new(&[Tile::new(DVec3::ZERO, size, j).expect("a valid tile")]);
    let outside = |n: i32| DVec3::new(0.4 * f64::from(n) - 4.0, 0.9, -0.6 - 0.2 * f64::from(n));
    let points: Vec<DVec3> = (0..20).map(outside).collect();
    let bounds_t = scene(j).error_bounds_t(&points);
    let doubled_t = scene(2.0 * j).error_bounds_t(&points);
    for (n, point) in points.iter().enumerate() {
        let alone = |axis: usize| scene(j * DVec3::AXES[axis]).field(Quantity::FluxDensity, *point).expect("bounded");
        let magnitude_t: f64 = [0, 1, 2].into_iter().map(|axis| alone(axis).length()).sum();
        assert!(bounds_t[n] >= FIELD * magnitude_t, "{point}: {} of {magnitude_t}", bounds_t[n]);
        // A much larger bound would give no information about rounding.
        assert!(bounds_t[n] <= 10.0 * FIELD * magnitude_t, "{point}: {} of {magnitude_t}", bounds_t[n]);
        assert!((doubled_t[n] - 2.0 * bounds_t[n]).abs() <= 1e-6 * doubled_t[n], "{point}");
    }
    assert_eq!(scene(j).error_bounds_t(&[DVec3::splat(f64::NAN)]), [f64::INFINITY]);
}

/// The largest component of a matrix by magnitude.
fn largest(m: DMat3) -> f64 {
    m.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max)
}

fn distance(found: DVec3, exact: DVec3) -> f64 {
    (found - exact).length() / exact.length()
}

const TABLES: [(&str, usize); 6] =
    [("generic", 1379), ("far", 856), ("approach", 3016), ("thin", 900), ("offset", 400), ("scale", 1800)];

#[test]
fn oracle_agrees_with_the_tables() {
    let mut oracle = Oracle::new();
    for (table, rows) in TABLES {
        for row in reference_tables::read(table, rows).iter().step_by(5) {
            let b = oracle.field(&row.tile, row.point).flux_density_t;
            // Both values are rounded once.
            assert!(distance(b, row.flux_density_t(0)) <= 2.3e-16, "row {}", row.id);
        }
    }
}

#[test]
fn field_strength_agrees_on_the_tables() {
    let mut oracle = Oracle::new();
    for (table, rows) in TABLES {
        // Outside, H is B / mu0, which the golden tests cover.
        for row in share(&reference_tables::read(table, rows)).iter().filter(|row| row.region != "out") {
            let h = Scene::new(&[row.tile]).field(Quantity::FieldStrength, row.point).expect("bounded");
            let exact = oracle.field(&row.tile, row.point).strength_t;
            assert!(distance(MU_0 * h, exact) <= FIELD, "row {}: {:e}", row.id, distance(MU_0 * h, exact));
        }
    }
}

#[test]
fn gradient_agrees_on_the_tables() {
    let mut oracle = Oracle::new();
    for (table, rows) in TABLES {
        for row in share(&reference_tables::read(table, rows)).iter().step_by(7) {
            let gradient = Scene::new(&[row.tile]).gradient(Quantity::FluxDensity, row.point).expect("bounded");
            check_gradient(gradient, oracle.gradient(&row.tile, row.point))
                .unwrap_or_else(|e| panic!("row {}: {e}", row.id));
        }
    }
}

fn check_gradient(found: DMat3, exact: DMat3) -> Result<(), TestCaseError> {
    let error = largest(found - exact);
    prop_assert!(error <= GRADIENT * largest(exact) + SYMMETRIC_ZERO, "{found} is off by {error:e}");
    Ok(())
}

fn run<S: Strategy>(cases: u32, strategy: &S, mut test: impl FnMut(S::Value) -> Result<(), TestCaseError>) {
    let cell = std::cell::RefCell::new(&mut test);
    TestRunner::new(Config { cases, failure_persistence: None, ..Config::default() })
        .run(strategy, |value| (cell.borrow_mut())(value))
        .unwrap_or_else(|e| panic!("{e}"));
}

fn unbounded_at(tile: &Tile, point: DVec3) -> bool {
    let half = 0.5 * tile.size();
    // The comparison is exact, by the two-sum of centre and half size.
    let on = |axis: usize| {
        [-1.0, 1.0].into_iter().any(|s| {
            let (c, h) = (tile.position()[axis], s * half[axis]);
            point[axis] == c + h && (point[axis] - c) == h
        })
    };
    let j = tile.polarization_t();
    let faces = [0, 1, 2].map(on);
    (0..3).any(|k| faces[(k + 1) % 3] && faces[(k + 2) % 3] && (j[(k + 1) % 3] != 0.0 || j[(k + 2) % 3] != 0.0))
}

/// The sum of the magnitudes of the fields of the single components of J, the measure of accuracy
/// where these nearly cancel, as in the middle of a long tile.
fn sum_of_components(tile: &Tile, point: DVec3, quantity: Quantity) -> f64 {
    let unit = if quantity == Quantity::FieldStrength { MU_0 } else { 1.0 };
    let components = (0..3).map(|axis| {
        let mut j = DVec3::ZERO;
        j[axis] = tile.polarization_t()[axis];
        let alone = Tile::new(tile.position(), tile.size(), j).expect("a valid tile");
        Scene::new(&[alone]).field(quantity, point).map_or(f64::INFINITY, DVec3::length)
    });
    unit * components.sum::<f64>()
}

#[test]
fn field_of_random_tiles() {
    let mut oracle = Oracle::new();
    run(cases(10_000), &(scenes::tile(12.0), scenes::face_offsets()), |(tile, places)| {
        let (point, scene) = (scenes::point(&tile, places), Scene::new(&[tile]));
        match (scene.field(Quantity::FluxDensity, point), scene.field(Quantity::FieldStrength, point)) {
            (Ok(b), Ok(h)) => {
                let exact = oracle.field(&tile, point);
                for (found, exact, quantity) in [
                    (b, exact.flux_density_t, Quantity::FluxDensity),
                    (MU_0 * h, exact.strength_t, Quantity::FieldStrength),
                ] {
                    let error = (found - exact).length();
                    let allowed = FIELD * sum_of_components(&tile, point, quantity);
                    prop_assert!(error <= allowed, "{quantity:?}: {error:e} off, {allowed:e} allowed");
                }
            }
            (b, h) => {
                prop_assert_eq!(b, Err(PointErrorCause::Unbounded { tile: 0 }));
                prop_assert_eq!(h, Err(PointErrorCause::Unbounded { tile: 0 }));
                prop_assert!(unbounded_at(&tile, point), "reported as unbounded without reason");
            }
        }
        Ok(())
    });
}

#[test]
fn gradient_of_random_tiles() {
    let mut oracle = Oracle::new();
    run(cases(2_000), &(scenes::tile(12.0), scenes::face_offsets()), |(tile, places)| {
        let point = scenes::point(&tile, places);
        match Scene::new(&[tile]).gradient(Quantity::FluxDensity, point) {
            Ok(gradient) => check_gradient(gradient, oracle.gradient(&tile, point))?,
            Err(cause) => {
                prop_assert_eq!(cause, PointErrorCause::Unbounded { tile: 0 });
                prop_assert!(unbounded_at(&tile, point), "reported as unbounded without reason");
            }
        }
        Ok(())
    });
}

/// Beside a plane of symmetry a component of B nearly vanishes. Closer to a plate than 0.08 of its
/// thickness, where the scalar kernel evaluates it, its relative error is as small as for the other
/// components. Elsewhere its error is a fraction of the field.
#[test]
fn small_components_beside_a_plate_keep_their_digits() {
    let mut oracle = Oracle::new();
    let tile = Tile::new(DVec3::new(0.1, 0.3, -0.7), DVec3::new(3.3, 1.7, 0.2), DVec3::Y).expect("a valid tile");
    for offset in [1e-3, -1e-7, 3e-12, -1e-15] {
        let point = tile.position() + DVec3::new(offset, 0.86, 0.05);
        let found = Scene::new(&[tile]).field(Quantity::FluxDensity, point).expect("bounded");
        let exact = oracle.field(&tile, point).flux_density_t;
        assert!((found.x - exact.x).abs() <= 4e-15 * exact.x.abs(), "{} is not {}", found.x, exact.x);
    }
}

/// Beyond the rim of a very thin plate the angles of its corners nearly cancel.
#[test]
fn points_beyond_the_rim_of_a_thin_plate_keep_the_bound() {
    let mut oracle = Oracle::new();
    let size = DVec3::new(500_563.294_485_764, 255_505.056_583_103_26, 4.341_278_141_525_865e-6);
    let tile = Tile::new(DVec3::ZERO, size, DVec3::X).expect("a valid tile");
    for (inside, outside) in [(1.14e-11, 2.06e-6), (1e-9, 1e-10), (1e-11, 1e-3), (1e-6, 1e-8)] {
        let point = DVec3::new((inside - 0.5) * size.x, -(0.5 + outside) * size.y, 0.1 * size.z);
        let found = Scene::new(&[tile]).field(Quantity::FluxDensity, point).expect("bounded");
        let error = distance(found, oracle.field(&tile, point).flux_density_t);
        assert!(error <= FIELD, "{error:e} at {point}");
    }
}

/// Dipole field of a tile whose largest side is `ratio` times the distance, in the direction of a
/// unit vector.
fn dipole(tile: &Tile, direction: DVec3, ratio: f64) -> DVec3 {
    let shape = (tile.size() / tile.size().max_element()).element_product();
    let j = tile.polarization_t();
    let field = (3.0 * direction * j.dot(direction) - j) * shape / (4.0 * std::f64::consts::PI);
    field * ratio * ratio * ratio
}

/// Sizes of 1e-250 to 1e200 at distances of up to 1e300 give finite fields, and zero where the
/// field is below the smallest number.
#[test]
fn extreme_sizes_and_distances_give_finite_fields() {
    let mut oracle = Oracle::new();
    for (size, distance) in
        [(1e-250, 1e250), (1e-200, 3e-200), (1e200, 3e200), (1e-30, 1e50), (1.0, 1e102), (1.0, 1e104), (1.0, 1e300)]
    {
        let tile =
            Tile::new(DVec3::ZERO, size * DVec3::new(1.0, 0.7, 0.4), DVec3::new(0.3, -0.5, 0.7)).expect("a valid tile");
        for direction in [DVec3::new(0.48, -0.6, 0.64), DVec3::X, DVec3::Z] {
            let point = distance * direction;
            let found = Scene::new(&[tile]).field(Quantity::FluxDensity, point).expect("bounded");
            // This far away the dipole is exact, while the oracle has lost all digits.
            let ratio = size / distance;
            let exact =
                if ratio < 1e-20 { dipole(&tile, direction, ratio) } else { oracle.field(&tile, point).flux_density_t };
            // Subnormal numbers have fewer digits.
            let allowed = FIELD * exact.length() + f64::MIN_POSITIVE;
            assert!((found - exact).length() <= allowed, "size {size:e} at {distance:e}: {found}, not {exact}");
            let gradient = Scene::new(&[tile]).gradient(Quantity::FluxDensity, point).expect("bounded");
            assert!(gradient.is_finite(), "size {size:e} at {distance:e}: {gradient}");
        }
    }
}

/// A nearly vanishing component of J does not spoil the gradient of the others.
#[test]
fn gradient_in_needles_with_a_nearly_zero_component() {
    let mut oracle = Oracle::new();
    for (size, j_y, point) in [
        (DVec3::new(1e-3, 1.0, 1e3), 6.123_233_995_736_766e-17, DVec3::new(0.01, 0.49, 0.3)),
        (DVec3::new(0.1, 1.0, 100.0), 1e-17, DVec3::new(0.2, 0.6, 0.3)),
        (DVec3::new(4.2e-8, 2.6e-6, 2307.4), 9.5e-31, DVec3::new(5.5e-7, 1.44e-6, -0.61)),
    ] {
        for turn in 0..3 {
            // Each axis takes each role.
            let turned = |v: DVec3| DVec3::new(v[turn], v[(turn + 1) % 3], v[(turn + 2) % 3]);
            let tile = Tile::new(DVec3::ZERO, turned(size), turned(DVec3::new(0.0, j_y, 1.0))).expect("a valid tile");
            let gradient = Scene::new(&[tile]).gradient(Quantity::FluxDensity, turned(point)).expect("bounded");
            check_gradient(gradient, oracle.gradient(&tile, turned(point))).unwrap_or_else(|e| panic!("{tile:?}: {e}"));
        }
    }
}

/// The field of a rotated tile is the rotated field, far away and on the planes of its faces, up to
/// a displacement of the point by round-off.
#[test]
fn rotated_tiles_have_the_rotated_field() {
    let mut oracle = Oracle::new();
    let axes = [(DVec3::Z, 0.5), (DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7), (DVec3::ONE.normalize(), 0.7)];
    for size in [DVec3::ONE, DVec3::new(1.0, 1.0, 1e-6), DVec3::new(1.0, 1.0, 1e-12)] {
        let tile = Tile::new(DVec3::ZERO, size, DVec3::new(0.3, -0.5, 0.7)).expect("a valid tile");
        for (axis, angle) in axes {
            let turn = DQuat::from_axis_angle(axis, angle);
            let scene = Scene::new(&[tile.rotated(turn).expect("a rotation")]);
            for reach in [3.0, 1e4, 1e6, 1e15] {
                for own in
                    [DVec3::new(reach, 0.5, 0.5), DVec3::new(reach, 0.1, -0.5 * size.z), DVec3::new(reach, 0.0, 0.0)]
                {
                    let found = scene.field(Quantity::FluxDensity, turn * own).expect("bounded");
                    let exact = oracle.field(&tile, own).flux_density_t;
                    // Rotating there and back moves the point by 10 units of 1.1e-16 of its
                    // distance. B falls as the third power of the distance, so it changes by three
                    // times that, and its own rotation adds a few units.
                    let error = (turn.inverse() * found - exact).length();
                    assert!(error <= 5e-15 * exact.length(), "{size} at {own}: {:e}", error / exact.length());
                }
            }
        }
    }
}

/// Points closer to a face than 2^-120 of the size, and J near the smallest number, give a finite
/// field or an error, never NaN.
#[test]
fn tiny_offsets_and_polarizations_never_give_nan() {
    let tile = |p: [f64; 3], s: [f64; 3], j: [f64; 3]| Tile::new(p.into(), s.into(), j.into()).expect("a valid tile");
    let corner = tile([0.5; 3], [1.0; 3], [1.0, 0.0, 0.0]);
    for x in [1e-170, -1e-170, 5e-324, -5e-324, 1e-80, -1e-80] {
        for y in [-1e-170, 2e-80, 5e-324, 0.5] {
            let point = DVec3::new(x, y, 0.5);
            let scene = Scene::new(&[corner]);
            assert!(scene.field(Quantity::FluxDensity, point).expect("not on an edge").is_finite(), "{point}");
            assert!(scene.gradient(Quantity::FluxDensity, point).expect("not on an edge").is_finite(), "{point}");
            let j = scene.field(Quantity::Polarization, point).expect("J is bounded");
            assert_eq!(j == DVec3::X, x > 0.0 && y > 0.0, "owner of {point}");
        }
    }
    let faint = tile([0.0; 3], [1.0; 3], [1e-163, 0.0, 0.0]);
    let edge = DVec3::new(0.5, 0.5, 0.1);
    assert_eq!(Scene::new(&[faint]).field(Quantity::FluxDensity, edge), Err(PointErrorCause::Unbounded { tile: 0 }));
    let strong = tile([0.6e-271; 3], [1.2e-271; 3], [1e30, 0.0, 0.0]);
    let gradient = Scene::new(&[strong]).gradient(Quantity::FluxDensity, DVec3::new(-1e-281, -1e-281, 0.5e-271));
    assert!(gradient.is_err() || gradient.is_ok_and(|g| g.is_finite()));
}

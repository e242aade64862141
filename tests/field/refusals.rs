//! Tolerances near the error bound of the exact field, against the oracle: returned values keep the
//! tolerance, and points are refused only for a reason.

use std::cell::{Cell, RefCell};

use glam::{DQuat, DVec3};
use magsplice_field::{Accuracy, EXACT_BOUND, Grid, PointErrorCause, Quantity, Scene, Tile, Tolerance};
use magsplice_tests::cases;
use magsplice_tests::oracle::Oracle;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

/// Largest ratio of the bound of a refused point to that error bound (docs/physics.md, section
/// 2.10).
const TOO_CAREFUL: f64 = 25.0;

/// A tile of aspect up to 10 with one or three components of J.
fn tile() -> impl Strategy<Value = Tile> {
    let decades = |least: f64, most: f64| (least..most).prop_map(|d| 10_f64.powf(d));
    let component = prop_oneof![Just(0.0), -1.0..1.0_f64];
    let j = prop::array::uniform3(component).prop_map(|j| DVec3::from(j) + DVec3::new(0.0, 0.0, 1e-3));
    (prop::array::uniform3(-3.0..3.0_f64), prop::array::uniform3(decades(-1.0, 0.0)), j)
        .prop_map(|(position, size, j)| Tile::new(position.into(), size.into(), j).expect("a valid tile"))
}

/// B by the oracle, and the sum of the magnitudes, in tesla.
fn field_and_magnitude(oracle: &mut Oracle, tiles: &[Tile], point: DVec3) -> (DVec3, f64) {
    let (mut exact, mut magnitude_t) = (DVec3::ZERO, 0.0);
    for tile in tiles {
        exact += oracle.field(tile, point).flux_density_t;
        for axis in DVec3::AXES {
            let part = Tile::new(tile.position(), tile.size(), tile.polarization_t() * axis).expect("a valid tile");
            magnitude_t += oracle.field(&part, point).flux_density_t.length();
        }
    }
    (exact, magnitude_t)
}

#[test]
fn values_near_the_limit_keep_their_tolerance_and_refusals_have_a_reason() {
    let points = prop::collection::vec(
        prop_oneof![prop::array::uniform3(-4.0..4.0_f64), prop::array::uniform3(-40.0..40.0_f64)],
        3,
    );
    let scenes = (prop::collection::vec(tile(), 1..6), points, -13.6..-12.6_f64, any::<bool>());
    let oracle = RefCell::new(Oracle::for_moderate_scenes());
    let (given, refused) = (Cell::new(0), Cell::new(0));
    TestRunner::new(Config { cases: cases(2_000), failure_persistence: None, ..Config::default() })
        .run(&scenes, |(tiles, points, decade, is_relative)| {
            let scene = Scene::new(&tiles);
            for point in points.into_iter().map(DVec3::from) {
                let (exact, magnitude_t) = field_and_magnitude(&mut oracle.borrow_mut(), &tiles, point);
                let fraction = 10_f64.powf(decade);
                let allowed_t = fraction * exact.length();
                let tolerance =
                    if is_relative { Tolerance::relative(fraction) } else { Tolerance::absolute_t(allowed_t) };
                let within = scene.clone().with_accuracy(Accuracy::Within(tolerance.expect("above zero")));
                match within.field_at(Quantity::FluxDensity, &[point]) {
                    Ok(field) => {
                        given.set(given.get() + 1);
                        let error_t = (field[0] - exact).length();
                        prop_assert!(error_t <= allowed_t, "off by {error_t:e}, not {allowed_t:e}");
                    }
                    Err(errors) => {
                        let PointErrorCause::TooExact { bound_t } = errors.0[0].cause else { panic!("{errors:?}") };
                        refused.set(refused.get() + 1);
                        let stated_t = EXACT_BOUND * magnitude_t;
                        prop_assert!(bound_t >= stated_t * (1.0 - 1e-9), "{bound_t:e} is below {stated_t:e}");
                        prop_assert!(bound_t <= TOO_CAREFUL * stated_t, "{} times too careful", bound_t / stated_t);
                        prop_assert!(bound_t * (1.0 + 2.0 * fraction) >= allowed_t, "refused without a reason");
                    }
                }
            }
            Ok(())
        })
        .expect("tolerances are kept, and refusals are not too careful");
    assert!(given.get().min(refused.get()) * 10 > given.get() + refused.get(), "{given:?} given, {refused:?} refused");
}

/// Scenes of one tile, of several tiles, and of enough tiles for bounds of groups.
#[test]
fn bounds_hold_at_every_distance_from_many_tiles() {
    let tile = |n: usize| {
        let turn = n as f64;
        let place = DVec3::new((n % 7) as f64, (n / 7 % 7) as f64, (n / 49) as f64) * 1.5;
        let j = DVec3::new(turn.sin(), (1.3 * turn).cos(), (0.7 * turn).sin());
        Tile::new(place, DVec3::new(1.0, 0.5, 0.8), j).expect("a valid tile")
    };
    let tiles: Vec<Tile> = (0..98).map(tile).collect();
    let mut oracle = Oracle::for_moderate_scenes();
    let within = Scene::new(&tiles).with_accuracy(Accuracy::Within(Tolerance::relative(1e-15).expect("above zero")));
    for distance in [0.3, 3.0, 10.0, 30.0, 100.0, 1000.0] {
        let point = DVec3::new(4.0, 4.1, 0.9) + distance * DVec3::new(0.48, -0.6, 0.64);
        let (_, magnitude_t) = field_and_magnitude(&mut oracle, &tiles, point);
        let errors = within.field_at(Quantity::FluxDensity, &[point]).expect_err("no tolerance is that small");
        let PointErrorCause::TooExact { bound_t } = errors.0[0].cause else { panic!("{errors:?}") };
        let excess = bound_t / (EXACT_BOUND * magnitude_t);
        assert!((1.0..5.0).contains(&excess), "{excess} times too large at {distance}");
    }
}

/// The elements of a single tile determine the bound at each point near it. The sum over components
/// is at most 2.3 times |B| here, and a tolerance of 5e-13 allows five times.
#[test]
fn tolerance_near_round_off_is_kept_near_a_single_tile() {
    let tile = Tile::new(DVec3::ZERO, DVec3::new(3.3, 1.7, 1.0), DVec3::new(0.3, -0.5, 0.7)).expect("a valid tile");
    let (lower, upper) = (DVec3::new(-2.0, -2.0, -3.0), DVec3::new(2.0, 2.0, -1.2));
    let points: Vec<DVec3> = Grid::new(lower, upper, [31, 31, 17]).expect("a valid grid").points().collect();
    let tolerance = Tolerance::relative(5e-13).expect("above zero");
    for turn in [DQuat::IDENTITY, DQuat::from_axis_angle(DVec3::new(0.48, -0.6, 0.64), 0.3)] {
        let scene = Scene::new(&[tile.rotated(turn).expect("a rotation")]);
        let exact = scene.field_at(Quantity::FluxDensity, &points).expect("bounded");
        let within = scene.with_accuracy(Accuracy::Within(tolerance));
        let given = within.field_at(Quantity::FluxDensity, &points);
        assert!(given.map_err(|errors| errors.0.len()) == Ok(exact), "points are refused");
    }
}

/// Faces within eight roundings of each other become one. Far from the origin this changes a speck
/// by a larger fraction of its size than a tolerance may allow.
#[test]
fn moved_faces_count_in_a_tolerance() {
    let cube = Tile::new(DVec3::X * 1000.0, DVec3::ONE, DVec3::new(1e-9, 0.0, 2e-9)).expect("a valid tile");
    let mut oracle = Oracle::for_moderate_scenes();
    let (mut served, mut refused, mut largest) = (0, 0, 0.0_f64);
    for n in 0..12 {
        let turn = f64::from(n);
        let side = 1e-5 * 10_f64.powf(0.25 * turn);
        let j = DVec3::new(turn.sin(), turn.cos(), 0.5);
        let speck = Tile::new(DVec3::new(1000.5 + 0.5 * side, 0.1, 0.2), DVec3::splat(side), j).expect("a valid tile");
        let tiles = [cube, speck];
        let points: Vec<DVec3> = (0..6)
            .map(|k| {
                let place = DVec3::new(0.6 + f64::from(k), (1.3 * turn).sin(), (0.7 * turn + f64::from(k)).cos());
                speck.position() + side * place
            })
            .collect();
        let exact: Vec<DVec3> = points.iter().map(|&point| field_and_magnitude(&mut oracle, &tiles, point).0).collect();
        for decades in 1..13 {
            let fraction = 10_f64.powi(-decades);
            let tolerance = Accuracy::Within(Tolerance::relative(fraction).expect("above zero"));
            let mut found = vec![DVec3::ZERO; points.len()];
            let _ = Scene::new(&tiles).with_accuracy(tolerance).field_into(Quantity::FluxDensity, &points, &mut found);
            for (found, exact) in found.into_iter().zip(&exact) {
                if found.is_nan() {
                    refused += 1;
                    // Eight roundings of the coordinate, for each of two faces and twice, over the
                    // side.
                    let moved = 32.0 * 1001.0 * 0.5 * f64::EPSILON / side;
                    assert!(fraction < 20.0 * (moved + EXACT_BOUND), "{fraction:e} refused with {side}");
                    continue;
                }
                served += 1;
                let error = (found - exact).length() / exact.length();
                largest = largest.max(error);
                assert!(error <= fraction, "{error:e} off within {fraction:e}, with {side}");
            }
        }
    }
    assert!(served > 300 && refused > 100 && largest > 1e-10, "{served}, {refused}, {largest:e}");
}

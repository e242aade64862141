//! A tolerance is kept at every point, or the point is named.

use glam::{DQuat, DVec3};
use magsplice_field::{Accuracy, Cause, Grid, MU_0, Quantity, Scene, Tile, Tolerance};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use rayon::ThreadPoolBuilder;

/// What the exact field, taken for the truth here, may itself be off by, as a fraction of |B|. Tolerances are far above it.
const EXACT: f64 = 1e-12;

fn grid_field(scene: &Scene, quantity: Quantity, grid: &Grid) -> (Vec<DVec3>, Vec<Cause>) {
    let mut field = vec![DVec3::ZERO; grid.len()];
    let errors = scene.field_on_grid(quantity, grid, &mut field).err().map_or(vec![], |errors| errors.0);
    for error in &errors {
        assert!(field[error.index].is_nan());
        assert_eq!(error.point, grid.point(error.index));
    }
    assert_eq!(field.iter().filter(|b| b.is_nan()).count(), errors.len());
    (field, errors.into_iter().map(|error| error.cause).collect())
}

fn tile() -> impl Strategy<Value = Tile> {
    let size = prop::array::uniform3((-0.7..0.7_f64).prop_map(|d| 10_f64.powf(d)));
    let position = prop::array::uniform3(-4.0..4.0_f64);
    let j = prop::array::uniform3(prop_oneof![Just(0.0), -1.0..1.0_f64]);
    let turn = prop_oneof![Just(DVec3::ZERO), prop::array::uniform3(-1.0..1.0_f64).prop_map(DVec3::from)];
    (size, position, j, turn).prop_map(|(size, position, j, turn)| {
        let j = DVec3::from(j) + DVec3::new(0.0, 0.0, 0.1);
        let tile = Tile::new(position.into(), size.into(), j).expect("a valid tile");
        tile.rotated(DQuat::from_scaled_axis(turn)).expect("a rotation")
    })
}

fn tolerance() -> impl Strategy<Value = Tolerance> {
    let size = (-9.0..-1.0_f64).prop_map(|d| 10_f64.powf(d));
    prop_oneof![
        size.clone().prop_map(|t| Tolerance::relative(t).expect("positive")),
        size.prop_map(|t| Tolerance::absolute_t(t).expect("positive"))
    ]
}

/// Random tiles, also turned ones, and grids that lie far, near, beside, between and in them.
#[test]
fn random_scenes_keep_random_tolerances_on_grids() {
    let scenes = (
        prop::collection::vec(tile(), 1..8),
        prop::array::uniform3(-12.0..12.0_f64),
        prop::array::uniform3((-1.0..0.8_f64).prop_map(|d| 10_f64.powf(d))),
        prop::array::uniform3(prop_oneof![1_usize..8, 8_usize..36]),
        tolerance(),
    );
    TestRunner::new(Config { cases: 6_000, failure_persistence: None, ..Config::default() })
        .run(&scenes, |(tiles, centre, half, counts, tolerance)| {
            let (centre, half) = (DVec3::from(centre), DVec3::from(half));
            let grid = Grid { lower: centre - half, upper: centre + half, counts };
            let scene = Scene::new(&tiles);
            let (exact, exact_errors) = grid_field(&scene, Quantity::FluxDensity, &grid);
            prop_assume!(exact_errors.is_empty());
            let (found, _) =
                grid_field(&scene.with_accuracy(Accuracy::Within(tolerance)), Quantity::FluxDensity, &grid);
            for (index, (found, exact)) in found.iter().zip(&exact).enumerate() {
                let allowed = match tolerance {
                    Tolerance::Relative(fraction) => fraction * exact.length(),
                    Tolerance::AbsoluteT(error_t) => error_t,
                };
                let error = (*found - *exact).length();
                // A point without value is none that breaks its promise.
                prop_assert!(
                    found.is_nan() || error <= allowed + EXACT * exact.length(),
                    "{tolerance:?}: off by {error:e} of {:e} at {}",
                    exact.length(),
                    grid.point(index)
                );
            }
            Ok(())
        })
        .expect("the tolerance is kept");
}

fn film() -> Vec<Tile> {
    let cell = |n: usize| {
        let (x, y) = (1.5 * (n % 6) as f64 - 3.75, 1.5 * (n / 6) as f64 - 3.75);
        let j = DVec3::new((0.9 * x).sin(), (0.9 * y).sin(), 0.2) * 0.12;
        Tile::new(DVec3::new(x, y, 0.5), DVec3::new(1.5, 1.5, 1.0), j).expect("a valid tile")
    };
    (0..36).map(cell).collect()
}

const BELOW: Grid =
    Grid { lower: DVec3::new(-2.0, -2.0, -5.0), upper: DVec3::new(2.0, 2.0, -3.0), counts: [21, 31, 11] };

#[test]
fn bit_identical_for_any_number_of_threads() {
    let scene = Scene::new(&film()).with_accuracy(Accuracy::Within(Tolerance::Relative(1e-8)));
    let once = grid_field(&scene, Quantity::FluxDensity, &BELOW).0;
    for threads in [1, 3, 8] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| grid_field(&scene, Quantity::FluxDensity, &BELOW)).0, once);
    }
}

#[test]
fn h_and_j_to_a_tolerance() {
    let exact = Scene::new(&film());
    let scene = exact.clone().with_accuracy(Accuracy::Within(Tolerance::Relative(1e-7)));
    let (b, h) =
        (grid_field(&exact, Quantity::FluxDensity, &BELOW).0, grid_field(&scene, Quantity::FieldStrength, &BELOW).0);
    for (b, h) in b.iter().zip(h) {
        assert!((*b - h * MU_0).length() <= 1.001e-7 * b.length());
    }
    assert!(grid_field(&scene, Quantity::Polarization, &BELOW).0.iter().all(|j| *j == DVec3::ZERO));
}

/// Where the field vanishes no error is small beside it.
#[test]
fn a_tolerance_that_cannot_be_kept_is_refused_point_by_point() {
    let opposed = [DVec3::X, -DVec3::X].map(|j| Tile::new(-3.0 * j, DVec3::ONE, j).expect("a valid tile"));
    let grid = Grid { lower: DVec3::splat(-1.0), upper: DVec3::ONE, counts: [11, 11, 11] };
    let scene = Scene::new(&opposed);
    for (fraction, least, most) in [(1e-6, 1, 11), (1e-15, 1331, 1331)] {
        let within = scene.clone().with_accuracy(Accuracy::Within(Tolerance::Relative(fraction)));
        let (_, causes) = grid_field(&within, Quantity::FluxDensity, &grid);
        assert!((least..=most).contains(&causes.len()), "{fraction}: {} points refused", causes.len());
        assert!(causes.iter().all(|cause| matches!(cause, Cause::TooExact { bound_t } if *bound_t < 1e-13)));
    }
    let absolute = scene.with_accuracy(Accuracy::Within(Tolerance::AbsoluteT(1e-12)));
    assert_eq!(grid_field(&absolute, Quantity::FluxDensity, &grid).1, []);
}

#[test]
fn only_positive_tolerances() {
    for wrong in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        assert!(Tolerance::relative(wrong).is_err() && Tolerance::absolute_t(wrong).is_err());
    }
}

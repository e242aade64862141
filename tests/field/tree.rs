//! Tolerances at lists of points, which sum over a tree of the tiles.

use glam::{DQuat, DVec3};
use magsplice_field::{Accuracy, MU_0, Model, PointErrorCause, Quantity, Scene, Tile, Tolerance};
use magsplice_tests::cases;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::ThreadPoolBuilder;

/// Error allowed for the exact field, the reference here, as a fraction of |B|. It replaces the
/// bound on the sum over tiles.
const EXACT_ERROR: f64 = 1e-12;

fn field(scene: &Scene, quantity: Quantity, points: &[DVec3]) -> (Vec<DVec3>, Vec<(usize, PointErrorCause)>) {
    let mut field = vec![DVec3::ZERO; points.len()];
    let errors = scene.field_into(quantity, points, &mut field).err().map_or(vec![], |errors| errors.0);
    assert!(errors.iter().all(|error| field[error.index].is_nan()));
    assert_eq!(field.iter().filter(|b| b.is_nan()).count(), errors.len());
    (field, errors.into_iter().map(|error| (error.index, error.cause)).collect())
}

fn tolerance() -> impl Strategy<Value = Tolerance> {
    let size = (-10.0..-1.0_f64).prop_map(|d| 10_f64.powf(d));
    prop_oneof![
        size.clone().prop_map(|t| Tolerance::relative(t).expect("positive")),
        size.prop_map(|t| Tolerance::absolute_t(t).expect("positive"))
    ]
}

/// Heaps of tiles of any size at different places, and points in the tiles, near them, between the
/// heaps and far away.
fn heaps(seed: u64, count: usize, spread: f64, unit: f64, turned: bool) -> (Vec<Tile>, Vec<DVec3>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut vector = |reach: f64| DVec3::from([0, 1, 2].map(|_| random.random_range(-reach..reach)));
    let (mut tiles, mut points) = (Vec::new(), Vec::new());
    for heap in 0..count {
        let (centre, reach) = (vector(spread), 10_f64.powf(vector(1.0).x));
        for number in 0..8 + (7 * heap) % 29 {
            let size = vector(0.8).to_array().map(|d| reach * 0.3 * 10_f64.powf(d));
            // Every third heap consists of tiles that nearly cancel in pairs.
            let j = if heap % 3 == 0 && number % 2 == 1 { -tiles_j(tiles.last()) } else { vector(1.0) };
            let tile = Tile::new((centre + vector(reach)) * unit, DVec3::from(size) * unit, j).expect("a valid tile");
            let turn = if turned { vector(1.0) } else { DVec3::ZERO };
            tiles.push(tile.rotated(DQuat::from_scaled_axis(turn)).expect("a rotation"));
        }
        for _ in 0..90 {
            let far = 10_f64.powf(1.5 * vector(1.0).x);
            points.push((centre + vector(reach * far)) * unit);
        }
    }
    points.push(DVec3::splat(1e3 * spread * unit));
    (tiles, points)
}

fn tiles_j(tile: Option<&Tile>) -> DVec3 {
    tile.map_or(DVec3::ZERO, Tile::polarization_t)
}

fn allowed(tolerance: Tolerance, exact: DVec3) -> f64 {
    match tolerance {
        Tolerance::Relative { fraction, .. } => fraction * exact.length(),
        Tolerance::AbsoluteT { error_t, .. } => error_t,
    }
}

#[test]
fn random_heaps_keep_random_tolerances() {
    let scenes = (any::<u64>(), 3_usize..12, 0.0..2.5_f64, -60.0..60.0_f64, any::<bool>(), tolerance());
    TestRunner::new(Config { cases: cases(600), failure_persistence: None, ..Config::default() })
        .run(&scenes, |(seed, count, spread, unit, turned, tolerance)| {
            let (tiles, points) = heaps(seed, count, 10_f64.powf(spread), 10_f64.powf(unit), turned);
            let scene = Scene::new(&tiles);
            let (exact, _) = field(&scene, Quantity::FluxDensity, &points);
            let (found, _) = field(&scene.with_accuracy(Accuracy::Within(tolerance)), Quantity::FluxDensity, &points);
            for ((found, exact), point) in found.iter().zip(&exact).zip(&points) {
                let error = (*found - *exact).length();
                // A refused point breaks no tolerance.
                prop_assert!(
                    found.is_nan() || error <= allowed(tolerance, *exact) + EXACT_ERROR * exact.length(),
                    "{tolerance:?}: off by {error:e} of {:e} at {point}",
                    exact.length(),
                );
            }
            Ok(())
        })
        .expect("the tolerance is kept");
}

/// A film of 40 x 40 tiles, and points around it, more than one batch.
fn film() -> (Vec<Tile>, Vec<DVec3>) {
    let tile = |n: usize| {
        let (x, y) = ((n % 40) as f64 - 19.5, (n / 40) as f64 - 19.5);
        let j = DVec3::new((0.6 * x).sin(), (0.6 * y).sin(), 0.2) * 0.12;
        Tile::new(DVec3::new(x, y, 0.5), DVec3::ONE, j).expect("a valid tile")
    };
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let point = |_| {
        let (x, y) = (random.random_range(-25.0..25.0), random.random_range(-25.0..25.0));
        DVec3::new(x, y, random.random_range(-8.0..2.0))
    };
    ((0..1600).map(tile).collect(), (0..3000).map(point).collect())
}

#[test]
fn film_keeps_every_tolerance_at_all_points() {
    let (tiles, points) = film();
    let scene = Scene::new(&tiles);
    let (exact, _) = field(&scene, Quantity::FluxDensity, &points);
    for exponent in [1, 3, 6, 9, 10] {
        let tolerance = Tolerance::relative(10_f64.powi(-exponent)).expect("a tolerance");
        let within = scene.clone().with_accuracy(Accuracy::Within(tolerance));
        let (b, errors) = field(&within, Quantity::FluxDensity, &points);
        assert_eq!(errors, []);
        let (h, _) = field(&within, Quantity::FieldStrength, &points);
        let (j, _) = field(&scene, Quantity::Polarization, &points);
        for (((b, exact), h), j) in b.iter().zip(&exact).zip(h).zip(j) {
            let allowed_t = 1.001 * allowed(tolerance, *exact);
            assert!((*b - *exact).length() <= allowed_t, "1e-{exponent}: {b} is not {exact}");
            let strength = *exact - j;
            assert!((h * MU_0 - strength).length() <= 1.001 * allowed(tolerance, strength));
        }
    }
}

/// Fields depend neither on the number of threads nor on earlier evaluations.
#[test]
fn lists_are_bit_identical_for_any_number_of_threads() {
    let (tiles, points) = film();
    let within = |tiles: &[Tile]| {
        Scene::new(tiles).with_accuracy(Accuracy::Within(Tolerance::relative(1e-6).expect("a tolerance")))
    };
    let once = field(&within(&tiles), Quantity::FluxDensity, &points).0;
    for threads in [1, 3, 8] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let scene = within(&tiles);
        let reversed: Vec<DVec3> = points.iter().rev().copied().collect();
        pool.install(|| field(&scene, Quantity::FluxDensity, &reversed[..500]));
        assert_eq!(pool.install(|| field(&scene, Quantity::FluxDensity, &points)).0, once);
    }
}

#[test]
fn errors_are_those_of_the_exact_field() {
    let (tiles, mut points) = film();
    points[7] = DVec3::new(-20.0, -20.0, 0.3);
    points[9] = DVec3::NAN;
    points[2999] = DVec3::new(1e302, 0.0, 0.0);
    let exact = Scene::new(&tiles);
    let expected = field(&exact, Quantity::FluxDensity, &points).1;
    assert_eq!(expected.iter().map(|(index, _)| *index).collect::<Vec<_>>(), [7, 9, 2999]);
    let within = exact.with_accuracy(Accuracy::Within(Tolerance::relative(1e-5).expect("a tolerance")));
    assert_eq!(field(&within, Quantity::FluxDensity, &points).1, expected);
}

/// Enough points for a Chebyshev fit of the box around them.
#[test]
fn many_points_in_a_box_without_tiles_keep_their_tolerance() {
    let (tiles, _) = film();
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let points: Vec<DVec3> =
        (0..30_000).map(|_| DVec3::from([-2.0, -2.0, -8.0].map(|from| from + random.random_range(0.0..4.0)))).collect();
    let scene = Scene::new(&tiles[..80]);
    let (exact, _) = field(&scene, Quantity::FluxDensity, &points);
    let tolerance = Tolerance::relative(1e-7).expect("a tolerance");
    let within = scene.with_accuracy(Accuracy::Within(tolerance));
    let plan = within.plan_at_points(&points);
    assert!(matches!(plan.parts[0].model, Model::Cells { .. }), "{plan:?}");
    let (b, errors) = field(&within, Quantity::FluxDensity, &points);
    let (h, _) = field(&within, Quantity::FieldStrength, &points);
    assert_eq!(errors, []);
    let mut largest = 0.0_f64;
    for ((b, h), exact) in b.iter().zip(h).zip(&exact) {
        largest = largest.max((*b - *exact).length() / exact.length());
        assert!((*b - h * MU_0).length() <= 1e-15 * exact.length());
    }
    // The field differs from the exact field, so the fit was used.
    assert!(largest <= 1e-7 && largest > 1e-13, "{largest:e}");
}

#[test]
fn scenes_without_tiles_and_lists_without_points() {
    let accuracy = Accuracy::Within(Tolerance::relative(1e-5).expect("a tolerance"));
    let nothing = Scene::new(&[]).with_accuracy(accuracy);
    assert_eq!(field(&nothing, Quantity::FluxDensity, &[DVec3::ONE]).0, [DVec3::ZERO]);
    let (tiles, _) = film();
    assert_eq!(field(&Scene::new(&tiles).with_accuracy(accuracy), Quantity::FluxDensity, &[]).0, []);
}

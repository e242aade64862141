//! Tolerances on grids and in prepared boxes: kept at every point, or the point is reported.

use glam::{DQuat, DVec3};
use magsplice_field::{
    Accuracy, FittedFieldError, Grid, LookUpErrors, MU_0, PointErrorCause, Quantity, Scene, Tile, Tolerance,
};
use magsplice_tests::cases;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use rayon::ThreadPoolBuilder;

/// Error allowed for the exact field, the reference here, as a fraction of |B|. Tolerances are far
/// above it.
const EXACT_ERROR: f64 = 1e-12;

fn grid_field(scene: &Scene, quantity: Quantity, grid: &Grid) -> (Vec<DVec3>, Vec<PointErrorCause>) {
    let mut field = vec![DVec3::ZERO; grid.len()];
    let errors = scene.field_on_grid_into(quantity, grid, &mut field).err().map_or(vec![], |errors| errors.0);
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

/// Random tiles, some rotated, and grids far from them, near, between and in them.
#[test]
fn random_scenes_keep_random_tolerances_on_grids() {
    let scenes = (
        prop::collection::vec(tile(), 1..8),
        prop::array::uniform3(-12.0..12.0_f64),
        prop::array::uniform3((-1.0..0.8_f64).prop_map(|d| 10_f64.powf(d))),
        prop::array::uniform3(prop_oneof![1_usize..8, 8_usize..36]),
        tolerance(),
    );
    TestRunner::new(Config { cases: cases(6_000), failure_persistence: None, ..Config::default() })
        .run(&scenes, |(tiles, centre, half, counts, tolerance)| {
            let (centre, half) = (DVec3::from(centre), DVec3::from(half));
            let grid = Grid::new(centre - half, centre + half, counts).expect("a grid");
            let scene = Scene::new(&tiles);
            let (exact, exact_errors) = grid_field(&scene, Quantity::FluxDensity, &grid);
            prop_assume!(exact_errors.is_empty());
            let (found, _) =
                grid_field(&scene.with_accuracy(Accuracy::Within(tolerance)), Quantity::FluxDensity, &grid);
            for (index, (found, exact)) in found.iter().zip(&exact).enumerate() {
                let allowed = match tolerance {
                    Tolerance::Relative { fraction, .. } => fraction * exact.length(),
                    Tolerance::AbsoluteT { error_t, .. } => error_t,
                };
                let error = (*found - *exact).length();
                // A refused point breaks no tolerance.
                prop_assert!(
                    found.is_nan() || error <= allowed + EXACT_ERROR * exact.length(),
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

fn below() -> Grid {
    Grid::new(DVec3::new(-2.0, -2.0, -5.0), DVec3::new(2.0, 2.0, -3.0), [21, 31, 11]).expect("a grid")
}

#[test]
fn grids_are_bit_identical_for_any_number_of_threads() {
    let scene = Scene::new(&film()).with_accuracy(Accuracy::Within(Tolerance::relative(1e-8).expect("a tolerance")));
    let once = grid_field(&scene, Quantity::FluxDensity, &below()).0;
    for threads in [1, 3, 8] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| grid_field(&scene, Quantity::FluxDensity, &below())).0, once);
    }
}

#[test]
fn h_keeps_its_tolerance_and_j_is_exact() {
    let exact = Scene::new(&film());
    let scene = exact.clone().with_accuracy(Accuracy::Within(Tolerance::relative(1e-7).expect("a tolerance")));
    let (b, h) = (
        grid_field(&exact, Quantity::FluxDensity, &below()).0,
        grid_field(&scene, Quantity::FieldStrength, &below()).0,
    );
    for (b, h) in b.iter().zip(h) {
        assert!((*b - h * MU_0).length() <= 1.001e-7 * b.length());
    }
    assert!(grid_field(&scene, Quantity::Polarization, &below()).0.iter().all(|j| *j == DVec3::ZERO));
}

/// Where the field vanishes, no relative tolerance can be kept.
#[test]
fn points_that_cannot_keep_their_tolerance_are_refused() {
    let opposed = [DVec3::X, -DVec3::X].map(|j| Tile::new(-3.0 * j, DVec3::ONE, j).expect("a valid tile"));
    let grid = Grid::new(DVec3::splat(-1.0), DVec3::ONE, [11, 11, 11]).expect("a grid");
    let scene = Scene::new(&opposed);
    for (fraction, least, most) in [(1e-6, 1, 11), (1e-15, 1331, 1331)] {
        let within = scene.clone().with_accuracy(Accuracy::Within(Tolerance::relative(fraction).expect("a tolerance")));
        let (_, causes) = grid_field(&within, Quantity::FluxDensity, &grid);
        assert!((least..=most).contains(&causes.len()), "{fraction}: {} points refused", causes.len());
        assert!(causes.iter().all(|cause| matches!(cause, PointErrorCause::TooExact { bound_t } if *bound_t < 1e-13)));
    }
    let absolute = scene.with_accuracy(Accuracy::Within(Tolerance::absolute_t(1e-12).expect("a tolerance")));
    assert_eq!(grid_field(&absolute, Quantity::FluxDensity, &grid).1, []);
}

/// An expansion that keeps the tolerance elsewhere in the box misses it near a zero of the field.
#[test]
fn points_near_a_zero_of_the_field_keep_a_relative_tolerance() {
    let opposed = [(1.0, 1.0), (-1.0, 1.3)].map(|(j, size)| {
        Tile::new(DVec3::new(-3.0 * j, 0.0, 0.0), DVec3::splat(size), DVec3::X * j).expect("a valid tile")
    });
    let scene = Scene::new(&opposed);
    let (mut low, mut high) = (-1.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let b = scene.field(Quantity::FluxDensity, DVec3::X * middle).expect("between the tiles");
        (low, high) = if b.x > 0.0 { (middle, high) } else { (low, middle) };
    }
    // The grid has no symmetry, and one point is very close to the zero of the field.
    let lower = DVec3::new(low + 1e-7 - 0.7, -0.9, -1.2);
    let grid = Grid::new(lower, lower + DVec3::new(2.0, 2.0, 2.0), [41; 3]).expect("a grid");
    let exact = grid_field(&scene, Quantity::FluxDensity, &grid).0;
    let within = scene.with_accuracy(Accuracy::Within(Tolerance::relative(1e-5).expect("a tolerance")));
    let (found, refused) = grid_field(&within, Quantity::FluxDensity, &grid);
    assert_eq!(refused, []);
    let error = |(exact, found): (&DVec3, &DVec3)| (*exact - *found).length() / exact.length();
    let errors: Vec<f64> = exact.iter().zip(&found).map(error).collect();
    assert!(errors.iter().all(|error| *error <= 1e-5), "{:e}", errors.iter().fold(0.0_f64, |a, b| a.max(*b)));
    // The other points come from an expansion, whose error would be too large for the weakest
    // field.
    let weakest = exact.iter().map(|b| b.length()).fold(f64::INFINITY, f64::min);
    let largest = exact.iter().zip(&found).map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max);
    assert!(largest > 1e-5 * weakest, "{largest:e} of {weakest:e}");
}

#[test]
fn tolerances_must_be_positive_and_finite() {
    for wrong in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        assert!(Tolerance::relative(wrong).is_err() && Tolerance::absolute_t(wrong).is_err());
    }
}

/// Points spread over a box; the first eight are its corners.
fn spread(lower: DVec3, upper: DVec3, count: usize) -> Vec<DVec3> {
    let corner = |n: usize| DVec3::from([0, 1, 2].map(|bit| if n >> bit & 1 == 1 { 1.0 } else { 0.0 }));
    let inner = |n: usize| DVec3::from([0.819_172_5, 0.671_043_6, 0.549_700_5].map(|step| (step * n as f64).fract()));
    let place = |n: usize| if n < 8 { corner(n) } else { inner(n) };
    (0..count).map(|n| lower + (upper - lower) * place(n)).map(|p| p.clamp(lower, upper)).collect()
}

#[test]
fn fitted_fields_keep_their_bounds() {
    let boxes = (
        prop::collection::vec(tile(), 1..6),
        prop::array::uniform3(-14.0..14.0_f64),
        prop::array::uniform3((-1.0..0.5_f64).prop_map(|d| 10_f64.powf(d))),
        (-9.0..-2.0_f64).prop_map(|d| 10_f64.powf(d)),
    );
    let fitted = std::cell::Cell::new(0);
    TestRunner::new(Config { cases: cases(400), failure_persistence: None, ..Config::default() })
        .run(&boxes, |(tiles, centre, half, fraction)| {
            let (centre, half) = (DVec3::from(centre), DVec3::from(half));
            let (scene, tolerance) = (Scene::new(&tiles), Tolerance::relative(fraction).expect("a tolerance"));
            let Ok(found) = scene.fitted_field(centre - half, centre + half, tolerance) else { return Ok(()) };
            fitted.set(fitted.get() + 1);
            let points = spread(centre - half, centre + half, 500);
            let mut field = vec![DVec3::ZERO; points.len()];
            let refused = found.flux_density_into(&points, &mut field).err().map_or(Vec::new(), |errors| errors.0);
            prop_assert!(refused.iter().all(|error| !error.outside && field[error.index].is_nan()));
            for (point, b) in points.iter().zip(field) {
                let exact = scene.field(Quantity::FluxDensity, *point).expect("no tile is there");
                let alone = found.flux_density(*point).expect("inside");
                let error = (alone - exact).length();
                prop_assert!(error <= found.error_t(), "off by {error:e}, not {:e}", found.error_t());
                if !b.is_nan() {
                    prop_assert!((b - exact).length() <= (fraction + EXACT_ERROR) * exact.length());
                    prop_assert!((b - alone).length() <= 1e-13 * exact.length() + 0.01 * found.error_t());
                }
                let gradient = scene.gradient(Quantity::FluxDensity, *point).expect("no tile is there");
                let off = (found.flux_density_gradient(*point).expect("inside") - gradient).to_cols_array();
                let off = off.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
                prop_assert!(off <= found.gradient_error_t(), "{off:e}, not {:e}", found.gradient_error_t());
            }
            Ok(())
        })
        .expect("the bounds hold");
    let least = if cfg!(feature = "all-cases") { 100 } else { 4 };
    assert!(fitted.get() > least, "only {} boxes were fitted", fitted.get());
}

/// Boxes of different proportions, with cells of unequal sides. One tile is rotated.
#[test]
fn fitted_fields_have_neither_divergence_nor_curl() {
    let mut tiles = film();
    tiles.push(tiles[7].rotated(DQuat::from_rotation_y(0.4)).expect("a rotation"));
    let scene = Scene::new(&tiles);
    for (x, size, fraction) in [
        (-2.0, [4.0, 4.0, 2.0], 1e-9),
        (-2.0, [6.0, 0.01, 1.0], 1e-7),
        (-2.0, [1e-5, 1e-5, 2.0], 1e-6),
        (-2.0, [3.0, 1.0, 1e-9], 1e-5),
        (0.0, [1e-310, 1.0, 1.0], 1e-6),
    ] {
        let (size, lower) = (DVec3::from(size), DVec3::new(x, -1.5, -5.0));
        let fitted = scene
            .fitted_field(lower, lower + size, Tolerance::relative(fraction).expect("a tolerance"))
            .expect("far enough");
        let points = spread(lower, lower + size, 100);
        let mut together = vec![DVec3::ZERO; points.len()];
        fitted.flux_density_into(&points, &mut together).expect("inside, and not weak");
        for (point, together) in points.into_iter().zip(together) {
            let slopes = fitted.flux_density_gradient(point).expect("inside");
            let most = slopes.to_cols_array().iter().fold(0.0_f64, |most, slope| most.max(slope.abs()));
            let divergence = slopes.x_axis.x + slopes.y_axis.y + slopes.z_axis.z;
            let curl = slopes - slopes.transpose();
            assert!(divergence.abs() <= 1e-12 * most, "{divergence:e} of {most:e}");
            assert!(curl.to_cols_array().iter().all(|c| c.abs() <= 1e-12 * most), "{curl} of {most:e}");
            let (b, exact) = (fitted.flux_density(point).expect("inside"), scene.field(Quantity::FluxDensity, point));
            assert!((b - exact.expect("no tile is there")).length() <= fitted.error_t());
            assert!((b - together).length() <= 1e-14 * b.length());
        }
    }
}

#[test]
fn fitted_fields_refuse_bad_boxes_and_points_outside() {
    let scene = Scene::new(&film());
    let (lower, upper) = (DVec3::new(-2.0, -2.0, -5.0), DVec3::new(2.0, 2.0, -3.0));
    let made =
        |lower, upper, fraction| scene.fitted_field(lower, upper, Tolerance::relative(fraction).expect("a tolerance"));
    assert_eq!(made(lower, upper.with_z(0.5), 1e-3).unwrap_err(), FittedFieldError::TooNear);
    assert_eq!(made(lower, upper, 1e-14).unwrap_err(), FittedFieldError::TooExact);
    assert_eq!(made(upper, lower, 1e-3).unwrap_err(), FittedFieldError::NoBox);
    assert_eq!(made(lower, upper.with_x(f64::NAN), 1e-3).unwrap_err(), FittedFieldError::NoBox);
    let fitted = made(lower, upper, 1e-6).unwrap();
    assert!(fitted.flux_density(upper).is_some() && fitted.flux_density(upper + 1e-9).is_none());
    assert!(fitted.flux_density_gradient(lower - 1e-9).is_none());
    let points = [lower, DVec3::new(0.0, 3.0, -4.0), upper, DVec3::NAN];
    let mut field = [DVec3::ZERO; 4];
    let LookUpErrors(errors) = fitted.flux_density_into(&points, &mut field).unwrap_err();
    assert_eq!(errors.iter().map(|e| (e.index, e.outside)).collect::<Vec<_>>(), [(1, true), (3, true)]);
    assert!(field[0].is_finite() && field[1].is_nan() && field[2].is_finite());
    assert_eq!(errors[0].to_string(), "point 1 at (0, 3, -4): outside the box");
    assert!(fitted.memory_bytes() < 1 << 21);
}

/// Beside a single tile a tolerance below round-off is refused at every point, also where all
/// points of a batch have their own bounds.
#[test]
fn tolerance_below_round_off_is_refused_beside_a_single_tile() {
    let tile = Tile::new(DVec3::ZERO, DVec3::new(3.3, 1.7, 1.0), DVec3::new(0.3, -0.5, 0.7)).expect("valid");
    let points: Vec<DVec3> =
        (0..4096).map(|n| DVec3::new(0.0005 * f64::from(n % 64), 0.0004 * f64::from(n / 64), 1.1)).collect();
    let scene = Scene::new(&[tile]).with_accuracy(Accuracy::Within(Tolerance::relative(1e-15).expect("valid")));
    let mut field = vec![DVec3::ZERO; points.len()];
    let refused = scene.field_into(Quantity::FluxDensity, &points, &mut field).expect_err("too exact");
    assert_eq!(refused.0.len(), points.len());
}

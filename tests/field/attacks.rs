//! Adversarial scenes: tiles of very different sizes and strengths next to each other.

use std::cell::{Cell, RefCell};

use glam::{DQuat, DVec3};
use magsplice_field::{Accuracy, Grid, Quantity, Scene, Tile, Tolerance};
use magsplice_tests::cases;
use magsplice_tests::oracle::Oracle;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

/// The stated bound of the exact field, as a fraction of the sum over tiles of the magnitudes of the
/// fields that the components of J make alone.
const EXACT_BOUND: f64 = 2e-14;

/// A tile with sides between 1e-3 and 2 and a polarization between 1e-10 T and 1 T, anywhere in a
/// cube or on a lattice.
fn tile() -> impl Strategy<Value = Tile> {
    let decades = |least: f64, most: f64| (least..most).prop_map(|d| 10_f64.powf(d));
    let place = prop_oneof![-3.0..3.0_f64, (-12..12_i32).prop_map(|n| 0.25 * f64::from(n))];
    let sides = (decades(-3.0, 0.3), prop::array::uniform3(decades(-0.4, 0.1)));
    let j = (prop::array::uniform3(-1.0..1.0_f64), decades(-10.0, 0.0));
    (prop::array::uniform3(place), sides, j).prop_map(|(position, (side, shape), (direction, size_t))| {
        let j_t = (DVec3::from(direction) + DVec3::splat(1e-3)) * size_t;
        Tile::new(position.into(), DVec3::from(shape) * side, j_t).expect("a valid tile")
    })
}

/// A direction, a distance from one of the tiles in its own sizes, and the number of that tile.
fn place() -> impl Strategy<Value = (DVec3, f64, prop::sample::Index)> {
    let direction = prop::array::uniform3(-1.0..1.0_f64).prop_filter("a direction", |d| DVec3::from(*d).length() > 0.1);
    (direction, -0.2..3.5_f64, any::<prop::sample::Index>())
        .prop_map(|(direction, decade, tile)| (DVec3::from(direction).normalize(), 10_f64.powf(decade), tile))
}

/// The error of mu0 H over the bound, at a point outside all tiles.
fn error_over_bound(oracle: &mut Oracle, scene: &Scene, tiles: &[Tile], point: DVec3) -> f64 {
    let found = scene.field(Quantity::FieldStrength, point).expect("a point off all edges") * magsplice_field::MU_0;
    let (mut exact, mut magnitude_t) = (DVec3::ZERO, 0.0);
    for tile in tiles {
        exact += oracle.field(tile, point).strength_t;
        for axis in DVec3::AXES {
            let part = Tile::new(tile.position(), tile.size(), tile.polarization_t() * axis).expect("a valid tile");
            magnitude_t += oracle.field(&part, point).strength_t.length();
        }
    }
    (found - exact).length() / (EXACT_BOUND * magnitude_t)
}

#[test]
fn small_strong_tile_beside_a_big_weak_one_keeps_the_exact_bound() {
    let tiles = [
        Tile::new(DVec3::ZERO, DVec3::splat(2.0), DVec3::new(1e-10, 9e-10, 2e-10)).expect("a valid tile"),
        Tile::new(DVec3::new(1.25, -0.75, 0.25), DVec3::splat(1.0 / 1024.0), DVec3::new(-0.25, -1.0, 0.0))
            .expect("a valid tile"),
    ];
    let point = DVec3::new(4.8125, -0.3125, -3.3125);
    let error = error_over_bound(&mut Oracle::for_moderate_scenes(), &Scene::new(&tiles), &tiles, point);
    assert!(error <= 1.0, "{error} times the bound");
}

#[test]
fn scenes_of_mixed_sizes_and_strengths_keep_the_exact_bound() {
    let scenes = (prop::collection::vec(tile(), 2..12), prop::collection::vec(place(), 4));
    let oracle = RefCell::new(Oracle::for_moderate_scenes());
    let worst = Cell::new(0.0_f64);
    TestRunner::new(Config { cases: cases(1_000), failure_persistence: None, ..Config::default() })
        .run(&scenes, |(tiles, places)| {
            let scene = Scene::new(&tiles);
            for (direction, sizes, tile) in places {
                let tile = tile.get(&tiles);
                let point = tile.position() + direction * (sizes * tile.size().length());
                let outside = |tile: &Tile| {
                    ((point - tile.position()).abs() - 0.5 * tile.size()).max_element()
                        > 1e-6 * tile.size().max_element()
                };
                prop_assume!(tiles.iter().all(outside));
                let error = error_over_bound(&mut oracle.borrow_mut(), &scene, &tiles, point);
                prop_assert!(error <= 1.0, "{error} times the bound at {point}");
                worst.set(worst.get().max(error));
            }
            Ok(())
        })
        .expect("the bound is kept");
    // The scenes are hard enough to use a part of what is allowed.
    assert!(worst.get() > 0.02, "{}", worst.get());
}

/// The published film: 56 tiles with a pattern along x and y.
fn published_film() -> Vec<Tile> {
    let widths = [0.85, 3.3, 1.7, 3.3, 1.7, 3.3, 1.7, 3.3, 0.85];
    let pattern = [0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0, 0.0];
    let middle = |n: usize| widths[..n].iter().sum::<f64>() + 0.5 * widths[n] - 10.0;
    let cells = (0..81).map(|n| (n / 9, n % 9)).filter(|&(i, j)| pattern[i] != 0.0 || pattern[j] != 0.0);
    let tile = |(i, j): (usize, usize)| {
        let j_t = 0.12 * DVec3::new(pattern[i], pattern[j], 0.0).normalize();
        Tile::new(DVec3::new(middle(i), middle(j), 0.5), DVec3::new(widths[i], widths[j], 1.0), j_t)
    };
    cells.map(|cell| tile(cell).expect("a valid tile")).collect()
}

#[test]
fn speck_beside_the_working_volume_keeps_the_tolerance() {
    let mut tiles = published_film();
    let speck = Tile::new(DVec3::new(-1.11, -0.204, -5.29), DVec3::splat(0.1), DVec3::new(0.002, -0.005, 0.01));
    tiles.push(speck.expect("a valid tile"));
    let grid = Grid::new(DVec3::new(-2.0, -2.0, -5.0), DVec3::new(2.0, 2.0, -3.0), [41, 41, 21]).expect("a grid");
    let exact = Scene::new(&tiles).field_on_grid(Quantity::FluxDensity, &grid).expect("off all edges");
    for fraction in [1e-2, 1e-4, 1e-6] {
        let tolerance = Tolerance::relative(fraction).expect("a tolerance");
        let within = Scene::new(&tiles).with_accuracy(Accuracy::Within(tolerance));
        let found = within.field_on_grid(Quantity::FluxDensity, &grid).expect("the tolerance can be kept");
        let worst = found.iter().zip(&exact).map(|(a, b)| (*a - *b).length() / b.length()).fold(0.0, f64::max);
        assert!(worst <= fraction, "{worst:e} instead of {fraction:e}");
    }
}

/// A tile of any shape and direction: its size, its sides over the size, its J over the largest, and
/// a rotation vector.
type Shape = (f64, [f64; 3], [f64; 3], [f64; 3]);

fn shape(decades: std::ops::Range<f64>) -> impl Strategy<Value = Shape> {
    let power = |range: std::ops::Range<f64>| range.prop_map(|d| 10_f64.powf(d));
    let turn = prop_oneof![Just([0.0; 3]), prop::array::uniform3(-2.0..2.0_f64)];
    let j = prop::array::uniform3(prop_oneof![Just(0.0), -1.0..1.0_f64]);
    (power(decades), prop::array::uniform3(prop_oneof![Just(1.0), power(-1.5..0.0)]), j, turn)
}

fn shaped(position: DVec3, (size, sides, j, turn): Shape, strength_t: f64) -> Tile {
    let j_t = (DVec3::from(j) + DVec3::new(0.0, 0.0, 0.1)) * strength_t;
    let tile = Tile::new(position, DVec3::from(sides) * size, j_t).expect("a valid tile");
    tile.rotated(DQuat::from_scaled_axis(turn.into())).expect("a rotation")
}

/// A box with few big tiles around it, and specks beside its surface whose fields there are between
/// far weaker and far stronger than the ones of the big tiles. Some are as near as a few of their own
/// sizes; others at some hundredths of the box, where it can still be fitted.
#[derive(Clone, Debug)]
struct Attack {
    tiles: Vec<Tile>,
    grid: Grid,
    /// Points of the grid that are nearest to specks.
    aimed: Vec<DVec3>,
    tolerance: Tolerance,
}

fn attack() -> impl Strategy<Value = Attack> {
    let direction = || prop::array::uniform3(-1.0..1.0_f64);
    let big = (direction(), 0.1..6.0_f64, shape(-1.0..0.7), -3.0..0.0_f64);
    let near = (0.1..6.0_f64, shape(-6.0..-0.7)).prop_map(|(sizes, shape)| (sizes * shape.0, shape));
    let fittable = ((-1.2..0.3_f64).prop_map(|d| 10_f64.powf(d)), shape(-3.0..-0.7));
    let speck = (any::<prop::sample::Index>(), 0..6_usize, prop_oneof![near, fittable], -9.0..0.5_f64);
    let specks = prop_oneof![prop::collection::vec(speck.clone(), 1..2), prop::collection::vec(speck, 1..4)];
    let sides = prop::array::uniform3((-0.5..0.3_f64).prop_map(|d| 10_f64.powf(d)));
    let counts = prop::array::uniform3(prop_oneof![9..16_usize, 1..9_usize]);
    let tolerance = (any::<bool>(), -9.0..-1.5_f64);
    let cancels = any::<bool>();
    let boxes = (prop::collection::vec(big, 1..4), specks, sides, counts);
    (boxes, tolerance, cancels).prop_map(|((big, specks, half, counts), (relative, exponent), cancels)| {
        let half = DVec3::from(half);
        let grid = Grid::new(-half, half, counts).expect("a grid");
        let mut tiles = Vec::new();
        for (direction, gap, shape, strength) in big {
            let direction = (DVec3::from(direction) + DVec3::new(1e-3, 0.0, 0.0)).normalize();
            let reach = half.length() + gap + shape.0 * 3_f64.sqrt();
            tiles.push(shaped(direction * reach, shape, 10_f64.powf(strength)));
            if cancels {
                // A second tile beside it nearly takes its field away.
                let opposite = (shape.0, shape.1, shape.2.map(|j| -j), shape.3);
                tiles.push(shaped(direction * (reach + 2.0 * shape.0), opposite, 10_f64.powf(strength)));
            }
        }
        let mut aimed = Vec::new();
        for (place, face, (gap, shape), strength) in specks {
            let (axis, side) = (face % 3, if face < 3 { 1.0 } else { -1.0 });
            let mut nearest = grid.point(place.index(grid.len()));
            nearest[axis] = side * half[axis];
            let mut position = nearest;
            position[axis] += side * (0.9 * shape.0 + gap);
            // Its field at the nearest point is about 10^strength times 0.1 T.
            let strength_t = 0.1 * 10_f64.powf(strength) * (1.0 + gap / shape.0).powi(3);
            tiles.push(shaped(position, shape, strength_t.min(1e3)));
            aimed.push(nearest);
            aimed.extend([0.3, 1.0, 3.0].map(|sizes| nearest - side * sizes * shape.0 * DVec3::AXES[axis]));
        }
        aimed.retain(|p| p.cmpge(-half).all() && p.cmple(half).all());
        let size = 10_f64.powf(exponent);
        let tolerance = if relative { Tolerance::relative(size) } else { Tolerance::absolute_t(0.1 * size) };
        Attack { tiles, grid, aimed, tolerance: tolerance.expect("a tolerance") }
    })
}

/// Upper bound of the error of the exact field, which is the reference here.
fn exact_error_t(tiles: &[Tile], point: DVec3) -> f64 {
    let own = |tile: &Tile| {
        let of_axis = |axis: DVec3| {
            let part = Tile::new(tile.position(), tile.size(), tile.polarization_t() * axis).expect("a valid tile");
            let part = part.rotated(tile.rotation()).expect("a rotation");
            Scene::new(&[part]).field(Quantity::FluxDensity, point).expect("off all edges").length()
        };
        DVec3::AXES.into_iter().map(of_axis).sum::<f64>()
    };
    EXACT_BOUND * tiles.iter().map(own).sum::<f64>()
}

/// Whether an error keeps the tolerance, up to the error of the reference.
fn keeps(attack: &Attack, point: DVec3, found: DVec3, exact: DVec3) -> bool {
    let error = (found - exact).length();
    let allowed = match attack.tolerance {
        Tolerance::Relative { fraction, .. } => fraction * exact.length(),
        Tolerance::AbsoluteT { error_t, .. } => error_t,
    };
    error <= allowed || error <= allowed + 2.0 * exact_error_t(&attack.tiles, point)
}

#[test]
fn adversarial_scenes_keep_their_tolerance_on_grids_and_at_points() {
    TestRunner::new(Config { cases: cases(10_000), failure_persistence: None, ..Config::default() })
        .run(&attack(), |attack| {
            let scene = Scene::new(&attack.tiles);
            let within = scene.clone().with_accuracy(Accuracy::Within(attack.tolerance));
            let points: Vec<DVec3> = attack.grid.points().collect();
            let mut exact = vec![DVec3::ZERO; points.len()];
            prop_assume!(scene.field_into(Quantity::FluxDensity, &points, &mut exact).is_ok());
            for on_grid in [true, false] {
                let mut found = vec![DVec3::ZERO; points.len()];
                let refused = if on_grid {
                    within.field_on_grid_into(Quantity::FluxDensity, &attack.grid, &mut found)
                } else {
                    within.field_into(Quantity::FluxDensity, &points, &mut found)
                };
                let refused = refused.err().map_or(vec![], |errors| errors.0);
                for (index, (found, exact)) in found.into_iter().zip(&exact).enumerate() {
                    let is_named = refused.iter().any(|error| error.index == index);
                    prop_assert_eq!(is_named, !found.is_finite());
                    prop_assert!(is_named || keeps(&attack, points[index], found, *exact), "at {}", points[index]);
                }
            }
            Ok(())
        })
        .expect("the tolerance is kept");
}

#[test]
fn fitted_fields_of_adversarial_scenes_keep_their_bounds() {
    let fitted = Cell::new(0);
    let cases = if cfg!(feature = "all-cases") { 10_000 } else { 200 };
    TestRunner::new(Config { cases, failure_persistence: None, ..Config::default() })
        .run(&attack(), |attack| {
            let scene = Scene::new(&attack.tiles);
            let (lower, upper) = (attack.grid.lower(), attack.grid.upper());
            let Ok(found) = scene.fitted_field(lower, upper, attack.tolerance) else { return Ok(()) };
            fitted.set(fitted.get() + 1);
            for &point in attack.aimed.iter().chain(&attack.grid.points().step_by(17).collect::<Vec<_>>()) {
                let Ok(exact) = scene.field(Quantity::FluxDensity, point) else { continue };
                let error = (found.flux_density(point).expect("inside") - exact).length();
                prop_assert!(error <= found.error_t(), "{error:e}, not {:e} at {point}", found.error_t());
                let Ok(slopes) = scene.gradient(Quantity::FluxDensity, point) else { continue };
                let off = (found.flux_density_gradient(point).expect("inside") - slopes).to_cols_array();
                let off = off.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
                prop_assert!(off <= found.gradient_error_t(), "{off:e}, not {:e} at {point}", found.gradient_error_t());
            }
            Ok(())
        })
        .expect("the bounds hold");
    assert!(fitted.get() > 10, "only {} boxes were fitted", fitted.get());
}

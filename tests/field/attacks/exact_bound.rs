//! The bound of the exact field: tiles of very different sizes and strengths next to each other.

use std::cell::{Cell, RefCell};

use glam::DVec3;
use magsplice_field::{EXACT_BOUND, Quantity, Scene, Tile};
use magsplice_tests::cases;
use magsplice_tests::oracle::Oracle;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

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

/// A direction, a distance from one of the tiles in units of its size, and the index of that tile.
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
    // The scenes are hard enough to use a part of the bound.
    assert!(worst.get() > 0.004, "{}", worst.get());
}

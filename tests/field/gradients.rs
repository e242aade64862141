//! The gradient of many tiles against the oracle.

use glam::{DMat3, DQuat, DVec3};
use magsplice_field::{GRADIENT_BOUND, Quantity, Scene, Tile};
use magsplice_tests::cases;
use magsplice_tests::oracle::Oracle;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn largest(gradient: DMat3) -> f64 {
    gradient.to_cols_array().into_iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// The gradient of films of touching tiles, some of equal J, and of a rod and a plate beside them,
/// keeps its bound near the tiles, inside them and far away.
#[test]
fn gradients_of_films_keep_the_bound() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut oracle = Oracle::for_moderate_scenes();
    let mut worst = 0.0_f64;
    for _ in 0..cases(60) {
        let tile = |n: usize, random: &mut ChaCha8Rng| {
            let (x, y) = ((n % 4) as f64, (n / 4) as f64);
            let j = if n % 3 == 1 { [0.3, 0.0, 0.0] } else { [0, 1, 2].map(|_| random.random_range(-1.0..1.0)) };
            Tile::new(DVec3::new(1.5 * x, y, 0.5), DVec3::new(1.5, 1.0, 1.0), DVec3::from(j)).expect("a valid tile")
        };
        let mut tiles: Vec<Tile> = (0..12).map(|n| tile(n, &mut random)).collect();
        let rod = DVec3::new(0.5, 0.4, 10_f64.powf(random.random_range(0.6..2.5)));
        tiles.push(Tile::new(DVec3::new(-3.0, 0.0, 0.0), rod, DVec3::new(0.2, 0.5, -0.4)).expect("a valid tile"));
        let plate = DVec3::new(2.0, 0.05, 2.0);
        tiles.push(Tile::new(DVec3::new(3.0, -4.0, 0.0), plate, DVec3::new(0.0, 0.5, 0.1)).expect("a valid tile"));
        let points: Vec<DVec3> = (0..6)
            .map(|_| {
                let tile = &tiles[random.random_range(0..tiles.len())];
                let spread = 2.0 * 10_f64.powf(random.random_range(-1.5..2.0));
                let place = DVec3::from([0, 1, 2].map(|_| random.random_range(-0.5..0.5)));
                tile.position() + place * (tile.size() + spread)
            })
            .collect();
        let found = Scene::new(&tiles).gradient_at(Quantity::FluxDensity, &points).expect("points off all edges");
        for (point, found) in points.into_iter().zip(found) {
            let (mut exact, mut magnitude) = (DMat3::ZERO, 0.0);
            for tile in &tiles {
                exact += oracle.gradient(tile, point);
                for axis in DVec3::AXES {
                    let j_t = tile.polarization_t() * axis;
                    let part = Tile::new(tile.position(), tile.size(), j_t).expect("a valid tile");
                    magnitude += largest(oracle.gradient(&part, point));
                }
            }
            let error = largest(found - exact) / magnitude;
            assert!(error <= GRADIENT_BOUND, "{error:e} of the sum over tiles at {point} of {tiles:?}");
            worst = worst.max(error);
        }
    }
    assert!(worst > 1e-16, "{worst:e}");
}

/// A turned scene has the turned gradient, for all methods.
#[test]
fn gradient_turns_with_the_scene() {
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 0.7);
    let tiles: Vec<Tile> = (0..10)
        .map(|n| {
            let n = f64::from(n);
            let j = DVec3::new(0.3, -0.1 * n, 0.5);
            Tile::new(DVec3::new(1.2 * n, 0.0, 0.0), DVec3::new(1.0, 2.0, 0.7), j).expect("a valid tile")
        })
        .collect();
    let turned: Vec<Tile> = tiles
        .iter()
        .map(|tile| {
            let moved = Tile::new(turn * tile.position(), tile.size(), tile.polarization_t()).expect("a valid tile");
            moved.rotated(turn).expect("a rotation")
        })
        .collect();
    let (scene, turned) = (Scene::new(&tiles), Scene::new(&turned));
    for point in [DVec3::new(1.0, 2.0, 3.0), DVec3::new(6.1, 1.2, 0.5), DVec3::new(0.1, 0.3, 0.2), DVec3::splat(80.0)] {
        let own = scene.gradient(Quantity::FluxDensity, point).expect("a point off all edges");
        let found = turned.gradient(Quantity::FluxDensity, turn * point).expect("a point off all edges");
        let rotation = DMat3::from_quat(turn);
        let expected = rotation * own * rotation.transpose();
        // The turned point is rounded, which changes the gradient by its own slope.
        assert!(largest(found - expected) <= 1e-12 * largest(own), "{found} and not {expected} at {point}");
    }
}

/// The gradient vanishes at the centre of a tile and keeps its bound relative to its largest
/// component around it, for compact tiles, plates and rods.
#[test]
fn gradient_around_the_centre_keeps_the_bound() {
    let mut oracle = Oracle::for_moderate_scenes();
    let mut worst = 0.0_f64;
    for size in [[1.0; 3], [3.3, 1.7, 1.0], [1.0, 0.3, 0.4], [1.0, 0.2, 1.0], [2.0, 0.5, 9.0], [1.0, 1.0, 40.0]] {
        for j in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.3, -0.5, 0.7)] {
            let tile = Tile::new(DVec3::ZERO, DVec3::from(size), j).expect("a valid tile");
            let scene = Scene::new(&[tile]);
            for r in [1e-2, 1e-3, 1e-6, 1e-9, 1e-15] {
                for direction in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.6, -0.3, 0.2)] {
                    let point = r * direction;
                    let found = scene.gradient(Quantity::FluxDensity, point).expect("inside");
                    let parts = DVec3::AXES.map(|axis| Tile::new(DVec3::ZERO, tile.size(), j * axis));
                    let parts = parts.map(|part| oracle.gradient(&part.expect("a valid tile"), point));
                    let error = largest(found - parts.into_iter().sum::<DMat3>());
                    let error = error / parts.into_iter().map(largest).sum::<f64>();
                    assert!(error <= GRADIENT_BOUND, "{error:e} at {point} of {size:?}, {j}");
                    worst = worst.max(error);
                }
            }
            assert_eq!(scene.gradient(Quantity::FluxDensity, DVec3::ZERO), Ok(DMat3::ZERO), "{size:?}, {j}");
        }
    }
    println!("largest error over the gradient: {worst:e}");
}

/// Near the centre of a speck its own gradient is far smaller than its J over its side, and the
/// gradient of another speck remains exact.
#[test]
fn gradient_at_the_centre_of_a_speck_is_the_gradient_of_the_other_tiles() {
    let side = 1.0 / 1024.0;
    let speck = |x: f64| Tile::new(DVec3::X * x, DVec3::splat(side), DVec3::X).expect("a valid tile");
    let mut oracle = Oracle::for_moderate_scenes();
    for (own, other) in [(0.0, 4.0), (1.0, 64.0), (-0.5, 0.5)] {
        let found = Scene::new(&[speck(own), speck(other)]).gradient(Quantity::FluxDensity, DVec3::X * own);
        let exact = oracle.gradient(&speck(other), DVec3::X * own);
        let error = largest(found.expect("inside") - exact) / largest(exact);
        assert!(error <= GRADIENT_BOUND, "{error:e} with specks at {own} and {other}");
    }
}

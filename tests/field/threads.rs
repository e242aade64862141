//! Fields do not depend on the number of threads or on the division of points into calls.

use glam::{DMat3, DQuat, DVec3};
use magsplice_field::{InstructionSet, PointErrorCause, Quantity, Scene, Tile};
use rayon::ThreadPoolBuilder;

fn scene() -> Scene {
    let tiles: Vec<Tile> = (0..20)
        .map(|i| {
            let i = f64::from(i);
            Tile::new(
                DVec3::new(i.sin() * 9.0, i.cos() * 9.0, 0.1 * i),
                DVec3::new(1.0, 1.3, 0.7),
                DVec3::new(0.1, i, 1.0),
            )
            .expect("a valid tile")
        })
        .collect();
    Scene::new(&tiles)
}

fn points() -> Vec<DVec3> {
    (0..1000).map(|i| DVec3::new(f64::from(i % 10), f64::from(i / 10 % 10), -0.37 * f64::from(i / 100) - 1.0)).collect()
}

#[test]
fn fields_are_bit_identical_for_any_threads_and_batches() {
    for set in InstructionSet::available() {
        for scene in [scene(), film(), scattered(&[]), one_tile(), rotated_tiles()] {
            assert_identical(&scene.with_instruction_set(set).expect("available"));
        }
    }
}

/// A rotated tile evaluated by every method, at points in it, beside it, and up to twenty half
/// diagonals away.
fn one_tile() -> Scene {
    let tile = Tile::new(DVec3::new(2.0, 3.0, -1.6), DVec3::new(0.9, 0.7, 0.5), DVec3::new(0.3, -0.5, 0.7));
    Scene::new(&[tile.expect("a valid tile").rotated(DQuat::from_rotation_x(0.3)).expect("a rotation")])
}

/// Tiles with different rotations, near enough to the points that batches need several methods for
/// most of them.
fn rotated_tiles() -> Scene {
    let tiles: Vec<Tile> = (0..6)
        .map(|i| {
            let turn = f64::from(i);
            let position = DVec3::new(2.0 * turn, 3.0 + 4.0 * turn.sin(), 0.3 * turn);
            let tile = Tile::new(position, DVec3::new(1.1, 0.8, 0.6), DVec3::new(0.3, 0.2 * turn - 0.5, 0.7));
            tile.expect("a valid tile").rotated(DQuat::from_rotation_y(0.2 + 0.1 * turn)).expect("a rotation")
        })
        .collect();
    Scene::new(&tiles)
}

/// A sheet of touching tiles, which share corners and strengths.
fn film() -> Scene {
    let tiles: Vec<Tile> = (0..90)
        .map(|i| {
            let (x, y) = (f64::from(i % 15), f64::from(i / 15));
            let j = [DVec3::X, -DVec3::X, DVec3::Y, DVec3::new(0.3, -0.4, 0.1)][(i % 15 + i / 15) as usize % 4];
            Tile::new(DVec3::new(x - 2.0, 1.3 * y, 0.4), DVec3::new(1.0, 1.3, 0.8), j).expect("a valid tile")
        })
        .collect();
    Scene::new(&tiles)
}

/// `tiles`, with enough scattered tiles and stacked cubes for points to be sorted.
fn scattered(tiles: &[Tile]) -> Scene {
    let apart = (0..150).map(|i| {
        let turn = f64::from(i);
        let position = DVec3::new(90.0 * (1.7 * turn).sin(), 90.0 * (2.9 * turn).cos(), 30.0 + turn);
        Tile::new(position, DVec3::new(1.0, 0.7, 0.4), DVec3::new(turn.sin(), 0.3, 1.0)).expect("a valid tile")
    });
    let together = (0..60).map(|i| {
        let at = DVec3::new(f64::from(i % 5), f64::from(i / 5 % 4), f64::from(i / 20));
        Tile::new(at + DVec3::new(20.0, -15.0, -3.0), DVec3::ONE, DVec3::new(0.1, f64::from(i).sin(), 1.0))
            .expect("a valid tile")
    });
    Scene::new(&tiles.iter().copied().chain(apart).chain(together).collect::<Vec<Tile>>())
}

fn assert_identical(scene: &Scene) {
    let points = points();
    let alone: Vec<DVec3> = points.iter().map(|&p| scene.field(Quantity::FluxDensity, p).unwrap()).collect();
    let slope = |&p: &DVec3| scene.gradient(Quantity::FluxDensity, p).unwrap();
    let slopes_alone: Vec<DMat3> = points.iter().map(slope).collect();
    let threads: &[usize] = if cfg!(feature = "all-cases") { &[1, 2, 3, 8] } else { &[3] };
    for &threads in threads {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        for batch in [points.len(), 333, 1] {
            let mut field = vec![DVec3::ZERO; points.len()];
            pool.install(|| {
                for (points, field) in points.chunks(batch).zip(field.chunks_mut(batch)) {
                    scene.field_into(Quantity::FluxDensity, points, field).unwrap();
                }
            });
            if let Some(index) = (0..points.len()).find(|&index| field[index] != alone[index]) {
                let (point, found, alone) = (points[index], field[index], alone[index]);
                panic!("{found} is not {alone} at {point} with {threads} threads and batches of {batch}");
            }
            let mut slopes = vec![DMat3::ZERO; points.len()];
            pool.install(|| {
                for (points, slopes) in points.chunks(batch).zip(slopes.chunks_mut(batch)) {
                    scene.gradient_into(Quantity::FluxDensity, points, slopes).unwrap();
                }
            });
            if let Some(index) = (0..points.len()).find(|&index| slopes[index] != slopes_alone[index]) {
                let (point, found, alone) = (points[index], slopes[index], slopes_alone[index]);
                panic!("{found} is not {alone} at {point} with {threads} threads and batches of {batch}");
            }
        }
    }
}

#[test]
fn every_point_without_a_field_is_in_the_error() {
    let cube = Tile::new(DVec3::ZERO, DVec3::splat(2.0), DVec3::X).unwrap();
    for scene in [Scene::new(&[cube]), scattered(&[cube])] {
        assert_all_named(&scene);
    }
}

fn assert_all_named(scene: &Scene) {
    let mut points = points();
    points[7] = DVec3::new(1.0, 0.3, 1.0);
    points[800] = DVec3::new(f64::NAN, 0.0, 0.0);
    points[999] = DVec3::new(-1.0, -1.0, -1.0);
    let mut field = vec![DVec3::ZERO; points.len()];
    let errors = scene.field_into(Quantity::FluxDensity, &points, &mut field).unwrap_err();
    let found: Vec<(usize, PointErrorCause)> = errors.0.iter().map(|e| (e.index, e.cause)).collect();
    let edge = PointErrorCause::Unbounded { tile: 0 };
    // (1, 0, -1) is on an edge and (1, 1, -1) on a corner. (0, 1, -1) is on an edge along J, where
    // the field is bounded.
    let on_grid = [(1, 0), (1, 1)].map(|(x, y)| (y * 10 + x, edge));
    let mut expected: Vec<(usize, PointErrorCause)> = on_grid.to_vec();
    expected.extend([(7, edge), (800, PointErrorCause::OutOfRange), (999, edge)]);
    expected.sort_by_key(|e| e.0);
    assert_eq!(found, expected);
    assert!(field.iter().enumerate().all(|(i, f)| f.is_finite() != found.iter().any(|e| e.0 == i)));
}

//! Scenes evaluated with every instruction set of the processor, against sums over tiles by the
//! oracle.

use glam::{DQuat, DVec3};
use magsplice_field::{EXACT_BOUND, InstructionSet, MU_0, Quantity, Scene, Tile};
use magsplice_tests::oracle::{Oracle, OracleField};
use magsplice_tests::{cases, share};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, TestRunner};

/// Largest error as a fraction of the sum, over tiles and components of J, of the magnitudes of the
/// fields of each component, the bound of `Scene`.
const WORST: f64 = EXACT_BOUND;

fn tile(position: DVec3, size: DVec3, j: DVec3) -> Tile {
    Tile::new(position, size, j).expect("a valid tile")
}

/// The sum of the exact fields, rotated to the frame of the scene, and the sum of the magnitudes of
/// the components' fields.
fn exact(oracle: &mut Oracle, tiles: &[Tile], point: DVec3) -> (DVec3, f64) {
    let (mut sum, mut magnitude) = (DVec3::ZERO, 0.0);
    for tile in tiles {
        let own = tile.rotation().inverse() * (point - tile.position());
        for axis in 0..3 {
            let mut j = DVec3::ZERO;
            j[axis] = tile.polarization_t()[axis];
            if j != DVec3::ZERO {
                let alone = Tile::new(DVec3::ZERO, tile.size(), j).expect("a valid tile");
                let field = oracle.field(&alone, own).flux_density_t;
                sum += tile.rotation() * field;
                magnitude += field.length();
            }
        }
    }
    (sum, magnitude)
}

/// Compares a scene with the oracle at all points. `rounded` is added to the bound: the relative
/// error from rounding a point in the frames of rotated tiles.
fn check(name: &str, tiles: &[Tile], points: &[DVec3], rounded: f64) {
    let points = share(points);
    let mut oracle = Oracle::for_moderate_scenes();
    let expected: Vec<(DVec3, f64)> = points.iter().map(|&point| exact(&mut oracle, tiles, point)).collect();
    for set in InstructionSet::available() {
        let scene = Scene::new(tiles).with_instruction_set(set).expect("available");
        let mut field = vec![DVec3::ZERO; points.len()];
        scene.field_into(Quantity::FluxDensity, &points, &mut field).expect("bounded");
        for ((found, (exact, magnitude)), point) in field.iter().zip(&expected).zip(&points) {
            let error = (*found - *exact).length() / magnitude;
            assert!(error <= WORST + rounded, "{name}, {set:?}: off by {error:e} at {point}");
        }
    }
}

/// A sheet of cells of widths 1.7 and 3.3, as in the published film; cells where `j` is zero are
/// empty.
fn film(j: impl Fn(usize, usize) -> DVec3) -> Vec<Tile> {
    let widths = [0.85, 3.3, 1.7, 3.3, 1.7, 3.3, 0.85];
    let starts: Vec<f64> = (0..=widths.len()).map(|n| widths[..n].iter().sum::<f64>() - 7.5).collect();
    let cells = (0..49).map(|n| (n % 7, n / 7));
    cells
        .filter(|&(x, y)| j(x, y) != DVec3::ZERO)
        .map(|(x, y)| {
            let centre = DVec3::new(0.5 * (starts[x] + starts[x + 1]), 0.5 * (starts[y] + starts[y + 1]), 0.5);
            tile(centre, DVec3::new(widths[x], widths[y], 1.0), j(x, y))
        })
        .collect()
}

/// Polarizations of the published film: one strength, eight directions.
fn published(x: usize, y: usize) -> DVec3 {
    let sign = |n: usize| [0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0][n];
    DVec3::new(sign(x), sign(y), 0.0).normalize_or_zero() * 0.12
}

/// Points below, beside and above a film, at distances from near to far.
fn around() -> Vec<DVec3> {
    let mut points = Vec::new();
    for distance in [1.01, 1.3, 2.2, 3.0, 4.0, 7.0, 15.0, 40.0, 130.0, 1e4] {
        for n in 0..6 {
            let turn = f64::from(n);
            let aside = DVec3::new((3.1 * turn).sin(), (2.3 * turn + 0.4).cos(), 0.0);
            points.push(aside * 6.0 - DVec3::Z * (distance - 1.0));
            points.push(aside * (7.0 + distance) + DVec3::Z * (0.5 + 0.1 * turn));
        }
    }
    points
}

#[test]
fn film_of_one_strength() {
    check("film", &film(published), &around(), 0.0);
}

#[test]
fn films_of_any_polarization() {
    let j = |x: usize, y: usize| published(x, y) + DVec3::new(0.02, -0.03, 0.04 + 1e-3 * (x + 7 * y) as f64);
    check("general", &film(j), &around(), 0.0);
    check("upright", &film(|x, y| DVec3::Z * (0.1 + 0.01 * (x * y) as f64)), &around(), 0.0);
}

#[test]
fn rotated_films() {
    let turned: Vec<Tile> = (1..)
        .zip(film(published))
        .map(|(n, tile)| tile.rotated(DQuat::from_rotation_z(1e-3 * f64::from(n))).expect("a rotation"))
        .collect();
    // A coordinate in the frame of a tile has an error of four roundings of the point's distance,
    // which changes the field by three times this error over the distance to the tile. The point in
    // the frame of the oracle's tile has the same error. Points within 0.01 of a size are omitted.
    let points: Vec<DVec3> = around().into_iter().filter(|p| p.z < -0.2 || p.z > 0.0).collect();
    check("rotated", &turned, &points, 4e-14);
}

#[test]
fn stacked_cubes_near_and_far() {
    let tiles: Vec<Tile> = (0..150)
        .map(|n| {
            let (x, y, z) = (f64::from(n % 5), f64::from(n / 5 % 5), f64::from(n / 25));
            let j = DVec3::new((0.6 * x).sin(), (0.9 * y).cos(), (0.4 * z + x).sin());
            tile(DVec3::new(x, y, z) - 2.0, DVec3::ONE, j)
        })
        .collect();
    check("cubes", &tiles, &around(), 0.0);
    let turn = DQuat::from_scaled_axis(DVec3::new(0.3, -0.2, 0.9));
    let rotated_about_the_origin =
        |t: &Tile| tile(turn * t.position(), t.size(), t.polarization_t()).rotated(turn).expect("a rotation");
    let turned: Vec<Tile> = tiles.iter().map(rotated_about_the_origin).collect();
    let points: Vec<DVec3> = around().into_iter().filter(|p| p.length() > 6.0).collect();
    check("turned cubes", &turned, &points, 4e-14);
}

/// Shapes that some methods cannot evaluate, next to others.
#[test]
fn plates_needles_and_cubes_together() {
    let tiles = [
        tile(DVec3::ZERO, DVec3::ONE, DVec3::new(0.2, -0.3, 0.5)),
        tile(DVec3::new(0.0, 0.0, 2.0), DVec3::new(3.0, 2.0, 1e-4), DVec3::new(0.2, 0.3, 0.5)),
        tile(DVec3::new(1.0, -3.0, 0.0), DVec3::new(20.0, 0.5, 0.1), DVec3::new(0.1, -0.3, -0.5)),
        tile(DVec3::new(-2.0, 3.0, 1.0), DVec3::new(1e-3, 1e-3, 7.0), DVec3::new(0.7, 0.0, -0.5)),
        tile(DVec3::new(-3.0, 0.0, 1.0), DVec3::new(0.02, 0.03, 0.01), DVec3::new(5.0, 3.0, -4.0)),
    ];
    check("mixture", &tiles, &around(), 0.0);
}

/// B and H inside and beside a compact tile, down to 1e-14 from its faces, edges and corners. The
/// tile is at the origin, so no coordinate is rounded.
#[test]
fn random_points_inside_and_near_a_tile() {
    let mut oracle = Oracle::for_moderate_scenes();
    let mut random = TestRunner::deterministic();
    let scenes = (
        prop::array::uniform3((-0.5..0.5_f64).prop_map(|d| 10_f64.powf(d))),
        prop::array::uniform3(prop_oneof![Just(0.0), -1.0..1.0_f64]),
        // Along each axis: anywhere from the middle to beside the tile, or close to a face.
        prop::array::uniform3(prop_oneof![
            (-1.1..1.1_f64).prop_map(|at| (at, 0.0)),
            (-14.0..-1.0_f64, any::<bool>(), any::<bool>()).prop_map(|(decades, upper, outside)| {
                let step = 10_f64.powf(decades) * if outside { 1.0 } else { -1.0 };
                if upper { (1.0, step) } else { (-1.0, -step) }
            }),
        ]),
    );
    for _ in 0..1500 {
        let (size, j, place) = scenes.new_tree(&mut random).expect("a scene").current();
        let (size, j) = (DVec3::from(size), DVec3::from(j));
        if j == DVec3::ZERO {
            continue;
        }
        let point = DVec3::from([0, 1, 2].map(|axis: usize| 0.5 * size[axis] * place[axis].0 + place[axis].1));
        let tile = tile(DVec3::ZERO, size, j);
        let components = DVec3::AXES.into_iter().filter(|axis| axis.dot(j) != 0.0);
        let alone = components.map(|axis| Tile::new(DVec3::ZERO, size, j * axis).expect("a valid tile"));
        let exact: Vec<OracleField> = alone.map(|tile| oracle.field(&tile, point)).collect();
        for set in InstructionSet::available() {
            let scene = Scene::new(&[tile]).with_instruction_set(set).expect("available");
            for (quantity, own) in [
                (Quantity::FluxDensity, (|field: &OracleField| field.flux_density_t) as fn(&OracleField) -> DVec3),
                (Quantity::FieldStrength, |field| field.strength_t),
            ] {
                let in_tesla = if quantity == Quantity::FieldStrength { MU_0 } else { 1.0 };
                let found = scene.field(quantity, point).expect("off the edges") * in_tesla;
                let magnitude: f64 = exact.iter().map(|field| own(field).length()).sum();
                let error = (found - exact.iter().map(own).sum::<DVec3>()).length() / magnitude;
                assert!(
                    error <= WORST,
                    "{set:?}: {quantity:?} is off by {error:e} at {point} of a tile of {size}, J {j}"
                );
            }
        }
    }
}

/// One tile of random shape at a random distance, most often where the method changes.
#[test]
fn random_tiles_at_all_distances() {
    let oracle = std::cell::RefCell::new(Oracle::for_moderate_scenes());
    let size = prop::array::uniform3((-1.2..1.2_f64).prop_map(|d| 10_f64.powf(d)));
    let j = prop::array::uniform3(prop_oneof![Just(0.0), -1.0..1.0_f64]);
    let direction = prop::array::uniform3(-1.0..1.0_f64);
    let scenes = (size, j, direction, -1.5..2.5_f64);
    TestRunner::new(Config { cases: cases(4_000), failure_persistence: None, ..Config::default() })
        .run(&scenes, |(size, j, direction, decades)| {
            let (j, direction) = (DVec3::from(j), DVec3::from(direction));
            prop_assume!(j != DVec3::ZERO && direction.length() > 0.1);
            let tile = tile(DVec3::new(0.3, -0.2, 0.1), size.into(), j);
            let half = 0.5 * tile.size();
            // The distance from the surface is 10^decades largest sides.
            let outward = direction.normalize();
            let to_surface = (half / outward.abs()).min_element();
            let point = tile.position() + outward * (to_surface + 10_f64.powf(decades) * tile.size().max_element());
            let (exact, magnitude) = {
                // The tile keeps its position, so the point is rounded as in the scene.
                let (mut sum, mut magnitude) = (DVec3::ZERO, 0.0);
                for axis in 0..3 {
                    let mut part = DVec3::ZERO;
                    part[axis] = j[axis];
                    if part != DVec3::ZERO {
                        let alone = Tile::new(tile.position(), tile.size(), part).expect("a valid tile");
                        let field = oracle.borrow_mut().field(&alone, point).flux_density_t;
                        sum += field;
                        magnitude += field.length();
                    }
                }
                (sum, magnitude)
            };
            for set in InstructionSet::available() {
                let scene = Scene::new(&[tile]).with_instruction_set(set).expect("available");
                let error = (scene.field(Quantity::FluxDensity, point).expect("bounded") - exact).length() / magnitude;
                prop_assert!(error <= WORST, "{set:?}: off by {error:e}");
            }
            Ok(())
        })
        .unwrap_or_else(|e| panic!("{e}"));
}

#[test]
fn missing_instruction_sets_are_refused() {
    let all = [InstructionSet::Avx512, InstructionSet::Avx2, InstructionSet::Sse2, InstructionSet::Neon];
    let available = InstructionSet::available();
    assert!(!available.is_empty());
    for set in all {
        let found = Scene::new(&[]).with_instruction_set(set);
        assert_eq!(found.is_ok(), available.contains(&set), "{set:?}");
        if let Err(missing) = found {
            assert!(missing.to_string().contains(&format!("{set:?}")));
        }
    }
}

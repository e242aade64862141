//! Samples of films, and the tiles of their steps.

use super::*;
use magsplice_field::Scene;
use magsplice_layout::{Distribution, ErrorGroup, Neighbour, TileErrors};
use magsplice_magnet::Quantity;

fn normal(deviations: [f64; 3]) -> [Distribution; 3] {
    deviations.map(Distribution::normal)
}

fn film(errors: &TileErrors) -> RealFilm {
    let tile = |n: usize| {
        let turn = DQuat::from_scaled_axis(DVec3::new(0.3, -0.2, 0.1) * n as f64);
        let tile = Tile::new(DVec3::splat(n as f64), DVec3::new(3.0, 2.0, 1.0), DVec3::new(0.3, -0.4, 0.5));
        tile.and_then(|tile| tile.rotated(turn)).expect("valid")
    };
    let tiles: Vec<Tile> = (0..4).map(tile).collect();
    RealFilm::new(&tiles, &FilmTolerance::of_tiles(errors, 4))
}

/// Means of squares of each error over `n` values are wrong by a normal error of (2 / n)^1/2.
/// Six of these are allowed, and the square of the error, by which rotations are not normal.
#[test]
fn samples_have_the_standard_deviations_of_the_errors() {
    let [position, rotation, size] = [[0.01, 0.02, 0.03], [0.004, 0.005, 0.006], [0.001, 0.002, 0.003]];
    let (strength_error, angles) = (0.01, [0.02, 0.03]);
    let errors = TileErrors {
        position: normal(position),
        rotation: normal(rotation),
        size: normal(size),
        strength: Distribution::normal(strength_error),
        direction: angles.map(Distribution::normal),
    };
    let film = film(&errors);
    let (mut squares, mut count) = ([[0.0; 3]; 3], 0.0);
    let (mut strength, mut direction) = (0.0, [0.0; 2]);
    for sample in 0..5000 {
        let made = film.sample_tiles(11, sample).expect("no tile has lost its sides");
        for (tile, ideal) in made.iter().zip(film.tiles()) {
            let turn = (tile.rotation() * ideal.rotation().inverse()).to_scaled_axis();
            let found = [tile.position() - ideal.position(), turn, tile.size() - ideal.size()];
            for (sums, found) in squares.iter_mut().zip(found) {
                (0..3).for_each(|axis| sums[axis] += found[axis].powi(2));
            }
            let (j, ideal_j) = (tile.polarization_t(), ideal.polarization_t());
            strength += (j.length() / ideal_j.length() - 1.0).powi(2);
            let [first, second] = direction_axes(ideal).expect("J");
            // A turn about one axis moves J along the other.
            direction[0] += (j.normalize().dot(second)).powi(2);
            direction[1] += (j.normalize().dot(first)).powi(2);
            count += 1.0;
        }
    }
    let allowed = 6.0 * (2.0_f64 / count).sqrt() + 1e-3;
    for (squares, wanted) in squares.iter().zip([position, rotation, size]) {
        for axis in 0..3 {
            let ratio = squares[axis] / count / wanted[axis].powi(2);
            assert!((ratio - 1.0).abs() < allowed, "{ratio} along {axis} of {wanted:?}");
        }
    }
    let ratio = strength / count / strength_error.powi(2);
    assert!((ratio - 1.0).abs() < allowed, "{ratio} of the strength");
    for (squares, wanted) in direction.iter().zip(angles) {
        let ratio = squares / count / wanted.powi(2);
        assert!((ratio - 1.0).abs() < allowed, "{ratio} of a direction of {wanted}");
    }
}

#[test]
fn a_further_error_changes_no_other() {
    let only_position = TileErrors { position: normal([0.1; 3]), ..TileErrors::default() };
    let both = TileErrors { strength: Distribution::normal(0.1), ..only_position.clone() };
    let (one, other) = (film(&only_position).sample_tiles(5, 17), film(&both).sample_tiles(5, 17));
    for (one, other) in one.expect("valid").iter().zip(&other.expect("valid")) {
        assert_eq!(one.position(), other.position());
        assert_ne!(one.polarization_t(), other.polarization_t());
    }
}

/// Tiles that are cut, then placed, are those of the sample. A spare tile has errors of its own.
#[test]
fn tiles_are_cut_then_placed() {
    let [position, rotation, size] = [normal([0.1; 3]), normal([0.05; 3]), normal([0.02; 3])];
    let strength = Distribution::normal(0.1);
    let direction = [0.03, 0.02].map(Distribution::normal);
    let errors = TileErrors { position, rotation, size, strength, direction };
    let group = ErrorGroup { name: "row".to_owned(), tiles: vec![0, 2], errors: errors.clone() };
    let film = film(&errors);
    let tolerance = FilmTolerance { groups: vec![group], ..film.tolerance().clone() };
    let film = RealFilm::new(film.tiles(), &tolerance);
    let cut = film.cut_tiles(2, 9).expect("valid");
    let (placed, sample) = (film.placed_tiles(&cut, 2, 9).expect("valid"), film.sample_tiles(2, 9).expect("valid"));
    for (placed, sample) in placed.iter().zip(&sample) {
        assert!(placed.position().distance(sample.position()) < 1e-14);
        assert!(placed.size().distance(sample.size()) < 1e-14);
        assert!(placed.polarization_t().distance(sample.polarization_t()) < 1e-14);
        assert!(placed.rotation().dot(sample.rotation()).abs() > 1.0 - 1e-14);
    }
    let spare = film.spare_tile(1, 0, 2, 9).expect("valid");
    assert_eq!(spare.position(), film.tiles()[1].position());
    assert!(cut.iter().all(|tile| tile.polarization_t().distance(spare.polarization_t()) > 1e-4));
}

#[test]
fn tiles_that_cannot_exist_are_faults() {
    let errors = TileErrors { size: normal([10.0; 3]), ..TileErrors::default() };
    assert!((0..20).any(|sample| film(&errors).sample_tiles(1, sample).is_err()));
}

/// Distances within the group stay, distances to other tiles do not; strengths change by one
/// factor.
#[test]
fn a_group_is_a_rigid_body_of_equal_strength_errors() {
    let errors = TileErrors {
        position: normal([0.3; 3]),
        rotation: normal([0.2; 3]),
        strength: Distribution::normal(0.1),
        ..TileErrors::default()
    };
    let group = ErrorGroup { name: "row".to_owned(), tiles: vec![0, 1, 3], errors };
    let tiles = film(&TileErrors::default()).tiles().to_vec();
    let film = RealFilm::new(&tiles, &FilmTolerance { groups: vec![group], ..FilmTolerance::default() });
    let made = film.sample_tiles(3, 4).expect("valid");
    let distance = |tiles: &[Tile], a: usize, b: usize| tiles[a].position().distance(tiles[b].position());
    for (a, b) in [(0, 1), (1, 3)] {
        assert!((distance(&made, a, b) - distance(&tiles, a, b)).abs() < 1e-12);
    }
    assert!((distance(&made, 0, 2) - distance(&tiles, 0, 2)).abs() > 1e-3);
    assert_eq!(made[2], tiles[2]);
    let factor = |tile: usize| made[tile].polarization_t().length() / tiles[tile].polarization_t().length();
    assert!((factor(0) - 1.0).abs() > 1e-3 && (factor(0) - factor(3)).abs() < 1e-12);
    // The centre turns about itself, so that it has the errors of position alone.
    let moved = |tile: usize| made[tile].position() - tiles[tile].position();
    let mean = (moved(0) + moved(1) + moved(3)) / 3.0;
    let alone = TileErrors { position: normal([0.3; 3]), ..TileErrors::default() };
    let group = ErrorGroup { name: "row".to_owned(), tiles: vec![0, 1, 3], errors: alone };
    let shifted = RealFilm::new(&tiles, &FilmTolerance { groups: vec![group], ..FilmTolerance::default() });
    let shift = shifted.sample_tiles(3, 4).expect("valid")[1].position() - tiles[1].position();
    assert!(mean.distance(shift) < 1e-12, "{mean}, not {shift}");
}

/// Errors in the plane of the film keep J in it for tiles in any rotation about its normal.
#[test]
fn direction_errors_are_in_the_plane_of_the_film_and_out_of_it() {
    let j_t = DVec3::new(0.3, -0.4, 0.0);
    let turn = DQuat::from_rotation_z(0.7);
    let tile = Tile::new(DVec3::ZERO, DVec3::ONE, j_t).and_then(|tile| tile.rotated(turn)).expect("valid");
    let in_plane = turned_in_tile(&tile, [0.1, 0.0]);
    assert!(in_plane.z.abs() < 1e-15 && (in_plane.angle_between(j_t) - 0.1).abs() < 1e-12);
    let out = turned_in_tile(&tile, [0.0, 0.1]);
    assert!((out.z.abs() - 0.5 * 0.1_f64.sin()).abs() < 1e-12, "{out}");
}

/// J within a quarter of a degree of the film's normal turns about the tile's x first, or about its
/// y if x is along J.
#[test]
fn direction_errors_of_tiles_magnetized_along_the_normal_are_about_their_own_axes() {
    let along = |deg: f64| DVec3::new(f64::to_radians(deg).sin(), 0.0, f64::to_radians(deg).cos());
    let tile = |j_t: DVec3, rotation: DQuat| {
        Tile::new(DVec3::ZERO, DVec3::ONE, j_t).and_then(|tile| tile.rotated(rotation)).expect("valid")
    };
    for (deg, expected) in [(0.0, DVec3::X), (0.2, DVec3::X), (0.4, DVec3::Z), (180.0, DVec3::X), (90.0, DVec3::Z)] {
        assert_eq!(direction_normal(&tile(0.1 * along(deg), DQuat::IDENTITY)), Some(expected), "{deg}");
    }
    let x_up = DQuat::from_rotation_y(-std::f64::consts::FRAC_PI_2);
    let upright = tile(0.1 * DVec3::X, x_up);
    assert!(upright.scene_polarization_t().distance(0.1 * DVec3::Z) < 1e-15);
    assert_eq!(direction_normal(&upright), Some(DVec3::Y));
    let [first, second] = direction_axes(&upright).expect("J");
    assert!(first.distance(DVec3::Y) < 1e-15 && second.distance(DVec3::Z) < 1e-15, "{first} {second}");
    assert_eq!(direction_normal(&tile(DVec3::ZERO, DQuat::IDENTITY)), None);
}

/// A sample contains the film beside it, with the field of its tiles.
#[test]
fn sample_has_the_field_of_its_neighbour() {
    let tiles = film(&TileErrors::default()).tiles().to_vec();
    let mut tolerance = FilmTolerance::default();
    let alone = RealFilm::new(&tiles, &tolerance).sample(1, 2).expect("valid");
    assert!(alone.beside().is_none());
    let beside = vec![Tile::new(DVec3::new(20.0, 0.0, 0.0), DVec3::ONE, DVec3::Z).expect("valid")];
    tolerance.common.neighbour = Some(Neighbour {
        tiles: beside.clone(),
        layout: "beside.toml".to_owned(),
        position_mm: [20.0, 0.0, 0.0],
        rotation: None,
        later: false,
    });
    let sample = RealFilm::new(&tiles, &tolerance).sample(1, 2).expect("valid");
    let place = DVec3::new(15.0, 1.0, -4.0);
    let field_t = |scene: &Scene| scene.field(Quantity::FluxDensity, place).expect("outside");
    assert_eq!(field_t(sample.beside().expect("a neighbour")), field_t(&Scene::new(&beside)));
}

/// A film with recoil keeps its places with other errors, and its tiles have the polarization of
/// their places. It turns about the centre of its bounding box.
#[test]
fn film_with_recoil_keeps_it_with_other_errors() {
    let cube = |x: f64, j_t: DVec3| Tile::new(DVec3::new(x, 0.0, 0.0), DVec3::ONE, j_t).expect("valid");
    let ordered = [cube(0.0, DVec3::X), cube(4.0, DVec3::Y)];
    let means = [cube(0.0, 0.9 * DVec3::X), cube(4.0, 0.8 * DVec3::Y)];
    let plain = RealFilm::new(&ordered, &FilmTolerance::default());
    assert_eq!(plain.centre_mm(), DVec3::new(2.0, 0.0, 0.0));
    assert_eq!(plain.in_film(&ordered).expect("valid").as_ref(), ordered);
    assert_eq!(RealFilm::new(&[], &FilmTolerance::default()).centre_mm(), DVec3::ZERO);
    let film = plain.with_weakening(Weakening::new(&ordered, &means, Scene::new(&[])));
    let errors = TileErrors { strength: Distribution::Fixed(0.1), ..TileErrors::default() };
    let film = film.with_tolerance(&FilmTolerance::of_tiles(&errors, 2));
    assert_eq!(film.tolerance().tiles.len(), 2);
    let made = film.in_film(&film.sample_tiles(1, 0).expect("valid")).expect("valid").into_owned();
    for (made, mean) in made.iter().zip(&means) {
        assert!(made.polarization_t().distance(1.1 * mean.polarization_t()) < 1e-15, "{made:?}");
    }
}

/// Spare tiles are cut like one tile, without errors of position or rotation, and each has other
/// deviates than any tile of the film.
#[test]
fn spare_tiles_have_deviates_of_their_own() {
    let errors = TileErrors { position: normal([0.1; 3]), size: normal([0.02; 3]), ..TileErrors::default() };
    let film = film(&errors);
    let spare = |number: usize| film.spare_tile(1, number, 2, 9).expect("valid");
    let mut sizes: Vec<DVec3> = film.cut_tiles(2, 9).expect("valid").iter().map(Tile::size).collect();
    sizes.extend([spare(0).size(), spare(1).size(), spare(5).size()]);
    for (number, size) in sizes.iter().enumerate() {
        assert!(sizes[..number].iter().all(|other| other != size), "{number}: {size}");
    }
    assert_eq!((spare(3).position(), spare(3).rotation()), (film.tiles()[1].position(), film.tiles()[1].rotation()));
    let none = RealFilm::new(film.tiles(), &FilmTolerance::default());
    assert_eq!(none.spare_tile(1, 0, 2, 9).expect("valid"), film.tiles()[1]);
}

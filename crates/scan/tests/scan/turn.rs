//! A film that was turned about z against the positions of its scan.

use glam::{DMat3, DVec3};
use magsplice_field::Scene;
use magsplice_layout::{FilmTolerance, Preset};
use magsplice_magnet::Quantity;
use magsplice_scan::film_turn;
use magsplice_tolerance::RealFilm;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::diagnosis::{film, points};
use crate::noisy::readings;

/// The readings of a turned film in a stray field.
fn turned_t(angle_deg: f64) -> Vec<DVec3> {
    let turn = DMat3::from_rotation_z(angle_deg.to_radians());
    let places: Vec<DVec3> = points().iter().map(|point| turn.transpose() * *point).collect();
    let field_t = Scene::new(&film()).field_at(Quantity::FluxDensity, &places).unwrap();
    field_t.into_iter().map(|b| turn * b + DVec3::new(3e-5, 0.0, -2e-5)).collect()
}

/// The golden sections leave 0.02 degrees.
#[test]
fn turn_of_a_film_is_found() {
    for angle_deg in [-41.3, 0.9] {
        let found = film_turn(&Scene::new(&film()), &points(), &turned_t(angle_deg)).unwrap();
        assert!((found.angle_deg - angle_deg).abs() < 0.02, "{angle_deg}: {found:?}");
        let (places, fields_t) = found.undone(&points(), &turned_t(angle_deg));
        let ordered_t = Scene::new(&film()).field_at(Quantity::FluxDensity, &places).unwrap();
        // Round-off of the angle: 0.02 degrees at 10 mm times 1e-2 T/mm, beside the stray field.
        let worst = fields_t.iter().zip(ordered_t).map(|(a, b)| (*a - b).length()).fold(0.0, f64::max);
        assert!(worst < 2e-4, "{angle_deg}: {worst}");
    }
}

/// Errors of tiles of films made by hand, of a third of the readings here, look like no turn.
#[test]
fn errors_of_tiles_are_no_turn() {
    let expected = FilmTolerance::of_tiles(&Preset::ByHand.errors(), film().len());
    for seed in 0..2 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let tiles = RealFilm::new(&film(), &expected).sample_tiles(seed, 0).unwrap();
        let readings_t = readings(&tiles, &points(), 1e-6, &mut random);
        let ordered_t = Scene::new(&film()).field_at(Quantity::FluxDensity, &points()).unwrap();
        let squares: f64 = readings_t.iter().zip(ordered_t).map(|(a, b)| (*a - b).length_squared()).sum();
        let residual_t = (squares / (3 * readings_t.len()) as f64).sqrt();
        let found = film_turn(&Scene::new(&film()), &points(), &readings_t);
        assert!(found.is_none_or(|turn| turn.residual_t > 0.9 * residual_t), "{seed}: {found:?}");
    }
}

//! The tile of another strength is found by its field alone, wherever the sensor was.

use glam::{DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_magnet::{IronPlanes, Quantity, Tile};
use magsplice_scan::suspect_strength;

use crate::diagnosis::{film, points};

/// The film with one tile of another strength.
fn with_strength(tile: usize, factor: f64) -> Vec<Tile> {
    let mut tiles = film();
    let of = tiles[tile];
    tiles[tile] = Tile::new(of.position(), of.size(), factor * of.polarization_t()).unwrap();
    tiles
}

/// The field is linear in the strengths, so that the error has round-off alone.
#[test]
fn strength_of_one_tile_is_found_exactly() {
    let points = points();
    for (tile, error) in [(0, -2.0), (7, -1.0), (24, -0.3), (55, 1.5)] {
        let field_t = Scene::new(&with_strength(tile, 1.0 + error)).field_at(Quantity::FluxDensity, &points).unwrap();
        let (found, of) = suspect_strength(&film(), &IronPlanes::default(), &points, &field_t).unwrap().unwrap();
        assert_eq!(found, tile);
        assert!((of - error).abs() < 1e-9, "{tile}: {of}, {error}");
    }
    let impossible = Scene::new(&with_strength(3, 5.0)).field_at(Quantity::FluxDensity, &points).unwrap();
    assert_ne!(
        suspect_strength(&film(), &IronPlanes::default(), &points, &impossible).unwrap().map(|(tile, _)| tile),
        Some(3)
    );
}

/// A sensor 0.1 mm away and 2 degrees turned, with an offset and a reading that is missing: without
/// the parameters of the scan, the displacement alone would leave more than the tile.
#[test]
fn placement_of_the_sensor_hides_no_reversed_tile() {
    let points: Vec<DVec3> = points().iter().map(|point| *point - 2.0 * DVec3::Z).collect();
    let places: Vec<DVec3> = points.iter().map(|point| *point + DVec3::new(0.1, -0.1, 0.1)).collect();
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 2_f64.to_radians());
    for tile in 0..film().len() {
        let field_t = Scene::new(&with_strength(tile, -1.0)).field_at(Quantity::FluxDensity, &places).unwrap();
        let mut read_t: Vec<DVec3> = field_t.iter().map(|b| turn * *b + DVec3::new(3e-4, 0.0, -2e-4)).collect();
        read_t[11].y = f64::NAN;
        let (found, error) = suspect_strength(&film(), &IronPlanes::default(), &points, &read_t).unwrap().unwrap();
        assert_eq!(found, tile);
        assert!((error + 2.0).abs() < 0.3, "{tile}: {error}");
    }
}

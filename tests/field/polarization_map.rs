//! The linear map from polarizations to B, against the field of the scene.

use glam::{DQuat, DVec3};
use magsplice_field::{EXACT_BOUND, PointErrorCause, PolarizationMap, PolarizationMapError, Quantity, Scene, Tile};
use proptest::prelude::*;

fn vector(reach: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-reach..reach).prop_map(DVec3::from)
}

fn tile(position: DVec3, size: DVec3, j: DVec3, turn: DVec3) -> Tile {
    let tile = Tile::new(position, size, j).expect("a valid tile");
    tile.rotated(DQuat::from_scaled_axis(turn)).expect("a rotation")
}

proptest! {
    #[test]
    fn map_applied_to_polarizations_is_the_field_of_the_scene(
        tiles in prop::collection::vec((vector(5.0), vector(0.9), vector(1.0), vector(1.0)), 1..12),
        points in prop::collection::vec(vector(9.0), 1..80),
    ) {
        let places: Vec<_> =
            tiles.iter().map(|&(p, size, _, turn)| tile(p, size.map(|d| 10_f64.powf(d)), DVec3::Y, turn)).collect();
        let polarizations: Vec<DVec3> = tiles.iter().map(|&(_, _, j, _)| j).collect();
        let polarized: Vec<_> = places.iter().zip(&polarizations)
            .map(|(t, &j)| Tile::new(t.position(), t.size(), j).expect("valid").rotated(t.rotation()).expect("a rotation"))
            .collect();
        let map = PolarizationMap::new(&places, &points).expect("no point on an edge");
        prop_assert_eq!(map.memory_bytes(), 72 * tiles.len() * points.len());
        let found = map.flux_density(&polarizations);
        let scene = Scene::new(&polarized);
        let component = |t: &Tile, axis: DVec3| {
            let t = Tile::new(t.position(), t.size(), t.polarization_t() * axis).expect("valid").rotated(t.rotation());
            Scene::new(&[t.expect("a rotation")])
        };
        let components: Vec<Scene> =
            polarized.iter().flat_map(|t| DVec3::AXES.map(|axis| component(t, axis))).collect();
        for (index, &point) in points.iter().enumerate() {
            let field = |scene: &Scene| scene.field(Quantity::FluxDensity, point).expect("no point on an edge");
            let exact = field(&scene);
            let magnitude: f64 = components.iter().map(|scene| field(scene).length()).sum();
            // The bound of scenes for each side, plus the rounding of the sums.
            let allowed = (2.0 * EXACT_BOUND + 3.0 * tiles.len() as f64 * f64::EPSILON) * magnitude;
            prop_assert!((found[index] - exact).length() <= allowed, "{} is not {exact}", found[index]);
            for (component, value) in found[index].to_array().into_iter().enumerate() {
                let row = map.row(index, component).iter();
                let by_row: f64 = row.zip(polarizations.iter().flat_map(DVec3::to_array)).map(|(m, j)| m * j).sum();
                prop_assert!((by_row - value).abs() <= allowed);
            }
        }
    }
}

#[test]
fn points_on_an_edge_of_any_tile_are_refused() {
    let tiles = [0.0, 1.0].map(|x| tile(DVec3::new(x, 0.0, 0.0), DVec3::ONE, DVec3::Y, DVec3::ZERO));
    let points = [DVec3::new(0.5, 0.2, 3.0), DVec3::new(0.5, 0.2, 0.5)];
    // The seam is no edge in the scene of both tiles.
    assert!(Scene::new(&tiles).field(Quantity::FluxDensity, points[1]).is_ok());
    let error = PolarizationMap::new(&tiles, &points).unwrap_err();
    let PolarizationMapError::Points { tile: 0, errors } = &error else { panic!("{error}") };
    assert_eq!((errors.0.len(), errors.0[0].index), (1, 1));
    assert!(matches!(errors.0[0].cause, PointErrorCause::Unbounded { .. }));
}

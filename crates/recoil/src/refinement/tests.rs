//! Values and their errors against finer divisions.

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_magnet::{Permeability, Quantity};

use super::*;

fn magnet(size: [f64; 3], position: [f64; 3], polarization_t: [f64; 3], mu_r: f64) -> RecoilTile {
    let tile = Tile::new(position.into(), size.into(), polarization_t.into()).unwrap();
    RecoilTile { tile, permeability: Permeability::isotropic(mu_r).unwrap() }
}

/// Sets of tiles with points at which B is asked for.
fn cases() -> Vec<(Vec<RecoilTile>, Vec<DVec3>)> {
    let below = vec![DVec3::new(0.1, 0.2, -2.0), DVec3::new(0.6, -0.4, -1.0), DVec3::new(3.0, 2.0, 1.0)];
    vec![
        (vec![magnet([1.0; 3], [0.0; 3], [0.0, 0.0, 1.0], 1.1)], below.clone()),
        (vec![magnet([3.3, 0.85, 1.0], [0.0; 3], [0.1, 0.05, 0.0], 1.2)], below.clone()),
        (
            vec![
                magnet([1.0; 3], [0.0; 3], [0.0, 0.0, 1.0], 1.05),
                magnet([1.0, 2.0, 1.0], [1.0, 0.5, 0.0], [0.7, 0.0, -0.7], 1.3),
            ],
            below,
        ),
    ]
}

fn flux_densities(tiles: &[Tile], points: &[DVec3]) -> Vec<f64> {
    let field = Scene::new(tiles).field_at(Quantity::FluxDensity, points).unwrap();
    field.into_iter().flat_map(|b_t| b_t.to_array()).collect()
}

fn refine_to(
    tiles: &[RecoilTile],
    points: &[DVec3],
    (tolerance, most_cells): (f64, usize),
) -> Result<Refined, RefinementError> {
    let settings = RefinementSettings { tolerances: vec![tolerance; 3 * points.len()], most_cells };
    refine(tiles, &settings, |cells| flux_densities(cells, points), |_| {})
}

/// The best that is known at a level.
fn at_level(tiles: &[RecoilTile], points: &[DVec3], level: usize) -> Refined {
    let cells = tiles.iter().map(|each| cell_count(each.tile.size(), level)).sum();
    match refine_to(tiles, points, (0.0, cells)) {
        Err(RefinementError::NotConverged { best: Some(best), .. }) => *best,
        other => panic!("{other:?}"),
    }
}

/// Level 9, whose error estimate is a ninth of that at level 3, is inside the errors of levels 3 to 5.
/// Values that vanish by symmetry have round-off.
#[test]
fn errors_contain_a_finer_level() {
    for (index, (tiles, points)) in cases().into_iter().enumerate() {
        let finest = at_level(&tiles, &points, 9);
        for level in 3..=5 {
            let coarse = at_level(&tiles, &points, level);
            assert_eq!(coarse.level, level);
            for (i, value) in coarse.values.iter().enumerate() {
                let (difference, error) = ((value - finest.values[i]).abs(), coarse.errors[i]);
                assert!(difference <= error + 1e-13, "{index} {level} {i}: {value} {difference:e} {error:e}");
            }
        }
    }
}

#[test]
fn refinement_ends_within_its_tolerance() {
    let (tiles, points) = &cases()[1];
    let refined = refine_to(tiles, points, (1e-5, 4_000)).unwrap();
    assert!(refined.errors.iter().all(|error| *error <= 1e-5), "{:?}", refined.errors);
    assert_eq!(refined.magnetization.cells().len(), refined.level.pow(3));
}

#[test]
fn refinement_without_enough_cells_says_so() {
    let (tiles, points) = &cases()[0];
    let error = refine_to(tiles, points, (1e-12, 100)).unwrap_err();
    let RefinementError::NotConverged { needed_cells: 125, best: Some(best), .. } = &error else {
        panic!("{error:?}");
    };
    assert_eq!(best.level, 4);
    assert!(error.to_string().contains("allow 125 cells instead of 100"), "{error}");
    assert!(matches!(refine_to(tiles, points, (1.0, 7)), Err(RefinementError::NotConverged { best: None, .. })));
    let settings = RefinementSettings { tolerances: vec![1.0], most_cells: 30 };
    let unknown = refine(tiles, &settings, |_| vec![f64::NAN], |_| {});
    assert!(matches!(unknown, Err(RefinementError::NotConverged { .. })));
    let lengths = refine(tiles, &settings, |cells| vec![0.0; cells.len()], |_| {});
    assert_eq!(lengths, Err(RefinementError::Count { tolerances: 1, values: 8 }));
}

#[test]
fn rigid_tiles_need_one_level() {
    let tiles = [magnet([1.0; 3], [0.0; 3], [0.0, 0.0, 1.0], 1.0)];
    let points = [DVec3::new(0.1, 0.2, -2.0)];
    let refined = refine_to(&tiles, &points, (0.0, 1)).unwrap();
    assert_eq!(refined.values, flux_densities(&[tiles[0].tile], &points));
    assert_eq!((refined.level, refined.errors), (1, vec![0.0; 3]));
}

/// Values with an infinite tolerance need no level of their own.
#[test]
fn refinement_ends_when_the_values_with_tolerances_are_known() {
    let (tiles, points) = &cases()[0];
    let mut settings = RefinementSettings { tolerances: vec![f64::INFINITY; 3 * points.len()], most_cells: 4_000 };
    let quantity = |cells: &[Tile]| flux_densities(cells, points);
    assert_eq!(refine(tiles, &settings, quantity, |_| {}).unwrap().level, LEAST_LEVEL);
    settings.tolerances[2] = 1e-5;
    let refined = refine(tiles, &settings, quantity, |_| {}).unwrap();
    assert!(refined.level > LEAST_LEVEL && refined.errors[2] <= 1e-5);
}

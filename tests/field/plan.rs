//! Plans of evaluations to a tolerance, against the evaluations themselves.

use glam::DVec3;
use magsplice_field::{Accuracy, Grid, Model, Quantity, Scene, Tile, Tolerance};

fn film(across: usize) -> Vec<Tile> {
    let tile = |n: usize| {
        let (x, y) = ((n % across) as f64 - 0.5 * across as f64, (n / across) as f64 - 0.5 * across as f64);
        let j = DVec3::new((0.6 * x).sin(), (0.6 * y).sin(), 0.2) * 0.12;
        Tile::new(DVec3::new(x, y, 0.5), DVec3::ONE, j).expect("a valid tile")
    };
    (0..across * across).map(tile).collect()
}

fn within(tiles: &[Tile], tolerance: Tolerance) -> Scene {
    Scene::new(tiles).with_accuracy(Accuracy::Within(tolerance))
}

fn largest_error_t(scene: &Scene, points: &[DVec3], field: &[DVec3]) -> f64 {
    let mut exact = vec![DVec3::ZERO; points.len()];
    scene
        .clone()
        .with_accuracy(Accuracy::Exact)
        .field_into(Quantity::FluxDensity, points, &mut exact)
        .expect("bounded");
    field.iter().zip(exact).map(|(a, b)| (*a - b).length()).fold(0.0, f64::max)
}

#[test]
fn plan_of_an_exact_scene_is_direct_summation() {
    let grid = Grid::new(DVec3::splat(-2.0), DVec3::splat(-1.0), [3, 4, 5]).expect("a grid");
    let plan = Scene::new(&film(4)).plan_on_grid(&grid);
    assert_eq!(plan.parts.len(), 1);
    assert_eq!((&plan.parts[0].model, plan.parts[0].points), (&Model::Exact, 60));
    assert_eq!((plan.cost(), plan.exact_cost), (960.0, 960.0));
}

/// A grid extends from far below a film into it. Every point is in one part of the plan, and each
/// part keeps its own bound.
#[test]
fn parts_of_a_grid_cover_it_and_keep_their_bounds() {
    let tolerance = Tolerance::absolute_t(1e-7).expect("positive");
    let scene = within(&film(6), tolerance);
    let grid = Grid::new(DVec3::new(-2.1, -2.2, -7.0), DVec3::new(2.0, 2.3, 0.4), [31, 32, 61]).expect("a grid");
    let plan = scene.plan_on_grid(&grid);
    assert_eq!(plan.parts.iter().map(|part| part.points).sum::<usize>(), grid.len());
    let mut field = vec![DVec3::ZERO; grid.len()];
    scene.field_on_grid_into(Quantity::FluxDensity, &grid, &mut field).expect("bounded");
    let mut boxes = 0;
    for part in &plan.parts {
        let Model::Chebyshev { lower, upper, terms, error_t, distance } = part.model else { continue };
        boxes += 1;
        assert!(error_t <= 1e-7 && terms.iter().product::<usize>() <= part.points);
        // The lower faces of the film are at z = 0.
        assert!((distance - -upper.z).abs() < 1e-12, "{distance} above {upper}");
        let inside: Vec<usize> =
            (0..grid.len()).filter(|&i| grid.point(i).cmpge(lower).all() && grid.point(i).cmple(upper).all()).collect();
        assert_eq!(inside.len(), part.points);
        let (points, values): (Vec<DVec3>, Vec<DVec3>) = inside.iter().map(|&i| (grid.point(i), field[i])).unzip();
        let found_t = largest_error_t(&scene, &points, &values);
        assert!(found_t <= error_t && found_t > 1e-4 * error_t, "{found_t:e} where {error_t:e} was planned");
    }
    assert!(boxes > 0 && plan.cost() < 0.6 * plan.exact_cost, "{boxes} boxes");
    assert!(plan.parts.iter().any(|part| !matches!(part.model, Model::Chebyshev { .. })), "nothing near the film");
}

#[test]
fn truncation_error_of_the_tree_is_within_the_planned_bound() {
    // A small distant tile whose field is below the tolerance.
    let speck = Tile::new(DVec3::new(0.0, 0.0, -300.0), DVec3::splat(0.5), 0.3 * DVec3::X).expect("a valid tile");
    let tiles: Vec<Tile> = film(30).into_iter().chain([speck]).collect();
    let points: Vec<DVec3> = (0..2000)
        .map(|n| {
            let turn = f64::from(n);
            DVec3::new(12.0 * (1.7 * turn).sin(), 12.0 * (2.9 * turn).sin(), -4.0 - (0.7 * turn).cos())
        })
        .collect();
    let scene = within(&tiles, Tolerance::relative(1e-4).expect("positive"));
    let plan = scene.plan_at_points(&points);
    // At points far from each other direct summation is faster.
    let part = &plan.parts[0];
    let Model::Tree { expanded_tiles, exact_tiles, ignored_tiles, truncation_error_t, ignored_t, .. } = part.model
    else {
        panic!("{part:?}")
    };
    assert!((expanded_tiles + exact_tiles + ignored_tiles - tiles.len() as f64).abs() < 1e-9);
    assert!(ignored_tiles >= 1.0 && ignored_t <= truncation_error_t);
    let mut of_speck = vec![DVec3::ZERO; points.len()];
    Scene::new(&[speck]).field_into(Quantity::FluxDensity, &points, &mut of_speck).expect("bounded");
    let most_t = of_speck.iter().map(|b| b.length()).fold(0.0, f64::max);
    assert!(most_t <= ignored_t, "{most_t:e} was ignored, not {ignored_t:e}");
    let mut field = vec![DVec3::ZERO; points.len()];
    scene.field_into(Quantity::FluxDensity, &points, &mut field).expect("bounded");
    let found_t = largest_error_t(&scene, &points, &field);
    assert!(found_t <= truncation_error_t && found_t > 0.0, "{found_t:e} of {truncation_error_t:e}");
}

/// For every tolerance, a plan costs at most as much as direct summation.
#[test]
fn plans_never_cost_more_than_direct_summation() {
    let tiles = film(12);
    let below = Grid::new(DVec3::new(-2.0, -2.0, -4.0), DVec3::new(2.0, 2.0, -1.0), [31; 3]).expect("a grid");
    let points: Vec<DVec3> = below.points().step_by(37).collect();
    for exponent in 1..15 {
        let scene = within(&tiles, Tolerance::relative(10_f64.powi(-exponent)).expect("positive"));
        for plan in [scene.plan_on_grid(&below), scene.plan_at_points(&points)] {
            let cost = plan.cost() / plan.exact_cost;
            assert!(cost <= 1.0, "{cost} times the exact field within 1e-{exponent}: {plan:?}");
        }
    }
    let plan = within(&tiles, Tolerance::relative(1e-13).expect("positive")).plan_at_points(&points);
    assert!(plan.parts.iter().all(|part| part.model == Model::Exact), "{plan:?}");
}

/// A fit of the field of one tile must save its own time: close to the tile it needs a node for
/// every second point, and the proof of its error takes the time of thousands of exact values.
#[test]
fn grid_close_to_a_single_tile_is_summed_directly() {
    let one = Tile::new(DVec3::ZERO, DVec3::new(3.3, 1.7, 1.0), DVec3::new(0.3, -0.5, 0.7)).expect("a valid tile");
    let counts = [61, 61, 31];
    let close = Grid::new(DVec3::new(-2.0, -2.0, -3.0), DVec3::new(2.0, 2.0, -1.0), counts).expect("a grid");
    let far = Grid::new(DVec3::new(98.0, 98.0, 99.0), DVec3::new(102.0, 102.0, 101.0), counts).expect("a grid");
    // On a finer grid, parts of the box would have enough points for their nodes.
    let finer = Grid::new(close.lower(), close.upper(), [81, 81, 41]).expect("a grid");
    for exponent in 2..=10 {
        let scene = within(&[one], Tolerance::relative(10_f64.powi(-exponent)).expect("a tolerance"));
        for close in [&close, &finer] {
            let plan = scene.plan_on_grid(close);
            assert!(plan.parts.iter().all(|part| part.model == Model::Exact), "1e-{exponent}: {plan:?}");
        }
        let plan = scene.plan_on_grid(&far);
        assert!(plan.parts.iter().all(|part| part.model != Model::Exact), "1e-{exponent}: {plan:?}");
    }
}

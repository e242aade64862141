//! Forces of films, and placement orders.

use glam::DVec3;
use magsplice_force::{FilmForces, LeastHolding, OrderError, OrderSettings, PlacementOrder};
use magsplice_magnet::{IronPlane, IronPlanes, Tile};

const SETTINGS: OrderSettings = OrderSettings { runs: 2, moves: 20_000, examined_sets: 100_000, seed: 1 };

/// Tiles side by side in `rows` x `columns`, with polarizations that turn from tile to tile.
fn film(rows: usize, columns: usize) -> Vec<Tile> {
    let tile = |n: usize| {
        let (x, y) = ((n % columns) as f64, (n / columns) as f64);
        let angle = 0.9 * x + 0.4 * y * y;
        let polarization_t = 0.12 * DVec3::new(angle.cos(), 0.3 * y, angle.sin());
        Tile::new(DVec3::new(2.0 * x, 1.5 * y, 0.5), DVec3::new(2.0, 1.5, 1.0), polarization_t).unwrap()
    };
    (0..rows * columns).map(tile).collect()
}

fn forces(tiles: &[Tile]) -> FilmForces {
    FilmForces::new(tiles, 1e-9, || ()).unwrap()
}

/// Largest force on a tile during its placement, by the definition.
fn holding(forces: &FilmForces, order: &[usize]) -> f64 {
    let at = |step: usize| order[..=step].iter().map(|&by| forces.by_one(order[step], by).force).sum::<DVec3>();
    (0..order.len()).map(|step| at(step).length()).fold(0.0, f64::max)
}

fn permutations(left: &mut Vec<usize>, order: &mut Vec<usize>, visit: &mut impl FnMut(&[usize])) {
    if left.is_empty() {
        visit(order);
    }
    for n in 0..left.len() {
        let tile = left.remove(n);
        order.push(tile);
        permutations(left, order, visit);
        order.pop();
        left.insert(n, tile);
    }
}

#[test]
fn forces_and_torques_of_a_film_vanish_in_sum() {
    let tiles = film(4, 5);
    let loads = forces(&tiles).by_all();
    let largest = loads.iter().map(|load| load.force.length()).fold(0.0, f64::max);
    let force: DVec3 = loads.iter().map(|load| load.force).sum();
    let about_origin = |(tile, load): (&Tile, &magsplice_force::Load)| load.torque + tile.position().cross(load.force);
    let torque: DVec3 = tiles.iter().zip(&loads).map(about_origin).sum();
    // 20 tiles, 20 terms each, 10 lengths.
    assert!(force.length() < 400.0 * f64::EPSILON * largest, "{force}");
    assert!(torque.length() < 4000.0 * f64::EPSILON * largest, "{torque}");
}

#[test]
fn threads_do_not_change_forces_or_orders() {
    let tiles = film(3, 4);
    let with = |threads: usize| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| {
            let forces = forces(&tiles);
            let found = LeastHolding::search(&forces, &SETTINGS, || ());
            (forces, found)
        })
    };
    assert_eq!(with(1), with(3));
}

/// Every order of seven tiles is tried.
#[test]
fn least_order_of_few_tiles_is_the_least_of_all() {
    let tiles = film(1, 7);
    let forces = forces(&tiles);
    let mut least = f64::INFINITY;
    permutations(&mut (0..7).collect(), &mut Vec::new(), &mut |order| least = least.min(holding(&forces, order)));
    let found = LeastHolding::search(&forces, &SETTINGS, || ());
    assert!((found.order.holding() - least).abs() <= 1e-12 * least, "{} {least}", found.order.holding());
    assert!((found.bound - least).abs() <= 1e-11 * least, "{} {least}", found.bound);
    assert!(found.greedy >= least);
}

/// With few examined sets the bound is lower, and still a bound.
#[test]
fn bound_is_below_the_best_order() {
    let forces = forces(&film(3, 4));
    let best = LeastHolding::search(&forces, &OrderSettings { examined_sets: 1_000_000, ..SETTINGS }, || ());
    for examined_sets in [0, 1, 10, 100] {
        let found = LeastHolding::search(&forces, &OrderSettings { examined_sets, runs: 0, ..SETTINGS }, || ());
        assert!(found.bound <= best.order.holding() && found.order.holding() >= best.bound, "{examined_sets}");
    }
    assert_eq!(holding(&forces, best.order.tiles()), best.order.holding());
}

#[test]
fn orders_without_each_tile_once_are_refused() {
    let forces = forces(&film(1, 3));
    let refused = |tiles: &[usize]| PlacementOrder::new(&forces, tiles.to_vec()).unwrap_err();
    assert_eq!(refused(&[0, 1]), OrderError::Count { given: 2, tiles: 3 });
    assert_eq!(refused(&[0, 1, 3]), OrderError::NoTile { step: 2, tile: 3 });
    assert_eq!(refused(&[0, 1, 0]), OrderError::Twice { step: 2, tile: 0 });
}

#[test]
fn no_tiles_and_one_tile_have_no_forces() {
    for tiles in [film(0, 0), film(1, 1)] {
        let forces = forces(&tiles);
        let found = LeastHolding::search(&forces, &SETTINGS, || ());
        assert_eq!((found.order.holding(), found.bound), (0.0, 0.0));
    }
}

/// The loads of an order are the forces and torques by the tiles placed before.
#[test]
fn each_step_has_the_load_by_the_tiles_before() {
    let forces = forces(&film(2, 3));
    let tiles = vec![3, 0, 5, 1, 2, 4];
    let order = PlacementOrder::new(&forces, tiles.clone()).unwrap();
    assert_eq!(order.loads().len(), 6);
    for (step, load) in order.loads().iter().enumerate() {
        assert_eq!(*load, forces.by_some(tiles[step], tiles[..step].iter().copied()));
    }
    assert_eq!(order.holding(), holding(&forces, &tiles));
}

/// Without annealing and bound, the order is built from its end: of the tiles placed up to a step,
/// the tile of the step has the smallest force by all others. Forces differ by round-off from sums
/// in another order.
#[test]
fn greedy_order_ends_with_the_tile_of_the_smallest_force() {
    let forces = forces(&film(4, 5));
    let settings = OrderSettings { runs: 0, examined_sets: 0, ..SETTINGS };
    let found = LeastHolding::search(&forces, &settings, || ());
    assert_eq!(found.order.holding(), found.greedy);
    let order = found.order.tiles();
    for step in 0..order.len() {
        let force_n = |tile: usize| forces.by_some(tile, order[..=step].iter().copied()).force.length();
        let least = order[..=step].iter().map(|&tile| force_n(tile)).fold(f64::INFINITY, f64::min);
        assert!(force_n(order[step]) <= least + 1e-13 * found.greedy, "step {step}");
    }
}

/// A film below iron: the load on a tile by another and by its image is that by both as tiles, the
/// iron takes up the sum, and a tile holds on to the iron while it is placed.
#[test]
fn tiles_have_the_forces_of_their_images() {
    let tiles = film(2, 2);
    let plane = IronPlane::new(DVec3::new(0.0, 0.0, 1.5), DVec3::NEG_Z, 9.0).unwrap();
    let images = IronPlanes::new(vec![plane]).unwrap().images(&tiles).unwrap();
    let found = forces(&tiles).with_images(&tiles, &images.tiles, &images.owners, 1e-9, || ()).unwrap();
    let all = forces(&[&tiles[..], &images.tiles].concat());
    for of in 0..4 {
        for by in 0..4 {
            let expected = all.by_one(of, by).force + all.by_one(of, 4 + by).force;
            assert!((found.by_one(of, by).force - expected).length() < 1e-15, "{of} by {by}");
        }
    }
    let sum: DVec3 = found.by_all().iter().map(|load| load.force).sum();
    assert!(sum.z > 0.0 && sum.z > 10.0 * sum.truncate().length(), "the iron attracts the film: {sum}");
    let order = PlacementOrder::new(&found, vec![2, 0, 3, 1]).unwrap();
    assert_eq!(order.loads()[0], found.by_one(2, 2));
    assert!(order.loads()[0].force.z > 0.0);
    let mut least = f64::INFINITY;
    permutations(&mut (0..4).collect(), &mut Vec::new(), &mut |order| least = least.min(holding(&found, order)));
    let searched = LeastHolding::search(&found, &SETTINGS, || ());
    assert!((searched.order.holding() - least).abs() < 1e-14, "{searched:?}, not {least}");
    assert!(searched.bound <= least && searched.bound > 0.99 * least, "{searched:?}, not {least}");
}

//! The tree and mirror planes against the tensors of all pairs of cells.

use glam::DQuat;
use magsplice_field::Scene;
use magsplice_magnet::{IronPlane, Permeability, Quantity, Tile};

use super::*;
use crate::symmetry::Orbits;
use crate::tolerances::TREE_ERROR;

fn magnet(size: [f64; 3], position: [f64; 3], polarization_t: [f64; 3], mu_r: f64) -> RecoilTile {
    let tile = Tile::new(position.into(), size.into(), polarization_t.into()).unwrap();
    RecoilTile { tile, permeability: Permeability::isotropic(mu_r).unwrap() }
}

fn solve(tiles: &[RecoilTile], level: usize) -> Magnetization {
    Magnetization::solve(tiles, &IronPlanes::default(), level, |_| {}).unwrap()
}

/// The tree against the tensors of all pairs: the change of B outside by a permeability agrees to a
/// few millionths of its largest value, for compact and for flat and long cells, and among turned
/// tiles.
#[test]
fn tree_agrees_with_all_tensors() {
    let frame = DQuat::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), 0.9);
    let board = |x: i32, y: i32| {
        let up = if (x + y) % 2 == 0 { 1.0 } else { -1.0 };
        magnet([1.0, 1.5, 0.75], [f64::from(x), 1.5 * f64::from(y), 0.0], [0.1, 0.3, up], 1.2)
    };
    let mut tiles: Vec<RecoilTile> = (0..12).map(|index| board(index % 4, index / 4)).collect();
    tiles[3].permeability = Permeability::along_and_across(1.05, 3.0).unwrap();
    tiles.push(magnet([8.0, 0.5, 0.5], [2.0, -2.0, 1.0], [0.5, 0.0, 0.0], 1.1));
    let turned = tiles.iter().map(|each| {
        let tile = Tile::new(frame * each.tile.position(), each.tile.size(), each.tile.polarization_t()).unwrap();
        RecoilTile { tile: tile.rotated(frame).unwrap(), ..*each }
    });
    let points = [[1.5, 1.5, -2.0], [0.3, 4.0, -1.0], [-3.0, 0.0, 0.5], [2.0, -3.0, 2.0]].map(DVec3::from);
    for (tiles, to_scene, level) in [(tiles.clone(), DQuat::IDENTITY, 5), (turned.collect(), frame, 3)] {
        let fields_t = |cells: &[Tile]| {
            Scene::new(cells).field_at(Quantity::FluxDensity, &points.map(|point| to_scene * point)).unwrap()
        };
        let division = Division::new(&tiles, &IronPlanes::default(), level).unwrap();
        let [tree, all] = [
            PairSums::by_tree(&division, |_| {}),
            PairSums::by_tensors(&division, Orbits::trivial(division.cells.len()), |_| {}),
        ]
        .map(|sums| Magnetization::from_sums(&tiles, division.clone(), &sums.unwrap(), |_| {}).unwrap());
        let bare: Vec<Tile> = tiles.iter().map(|each| each.tile).collect();
        let (by_tree, by_all, rigid) = (fields_t(tree.cells()), fields_t(all.cells()), fields_t(&bare));
        let largest = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max);
        let (error, change) = (largest(&by_tree, &by_all), largest(&by_all, &rigid));
        assert!(error <= TREE_ERROR * change, "{error:e} {change:e}");
    }
}

/// The sums by a tree equal the sums of a symmetric matrix, to round-off.
#[test]
fn tree_is_symmetric() {
    let tiles = [
        magnet([3.0, 2.0, 1.0], [0.0; 3], [0.1, 0.3, 1.0], 1.2),
        magnet([1.0; 3], [9.0, 1.0, 0.0], [1.0, 0.0, 0.0], 1.2),
    ];
    let division = Division::new(&tiles, &IronPlanes::default(), 7).unwrap();
    let sums = PairSums::by_tree(&division, |_| {}).unwrap();
    let vector = |phase: f64| -> Vec<DVec3> {
        (0..division.cells.len()).map(|i| (phase * DVec3::new(1.3, 2.1, 0.7) * i as f64).map(f64::sin)).collect()
    };
    let product = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum::<f64>();
    let (a, b) = (vector(1.0), vector(1.7));
    let [there, back] = [product(&a, &sums.apply(&b)), product(&b, &sums.apply(&a))];
    let norm = (product(&a, &a) * product(&b, &b)).sqrt();
    assert!((there - back).abs() <= 1e-14 * norm, "{there} {back}");
}

/// Films with three mirror planes, one crossed by tiles, and with one plane: the solution equals
/// the solution of all cells, and the change of J is symmetric to the last bit.
#[test]
fn mirror_planes_change_nothing() {
    let across = [
        magnet([1.0, 2.0, 1.0], [0.0; 3], [0.5, 0.0, 0.0], 1.2),
        magnet([2.0, 1.0, 1.0], [1.5, 0.0, 0.0], [0.0, 0.0, 0.3], 1.1),
        magnet([2.0, 1.0, 1.0], [-1.5, 0.0, 0.0], [0.0, 0.0, -0.3], 1.1),
    ];
    let mut beside = across.to_vec();
    beside[1].tile = magnet([2.0, 1.0, 1.0], [1.5, 0.25, 0.0], [0.0, 0.0, 0.3], 1.1).tile;
    beside[2].tile = magnet([2.0, 1.0, 1.0], [-1.5, 0.25, 0.0], [0.0, 0.0, -0.3], 1.1).tile;
    let mut easy = across.to_vec();
    easy.iter_mut().for_each(|each| each.permeability = Permeability::along_and_across(1.05, 1.5).unwrap());
    let lone = vec![magnet([1.0; 3], [0.0; 3], [0.3, 0.4, 0.5], 1.2)];
    // Their positions are mirror images across x, their sizes are not.
    let unlike = vec![
        magnet([1.0; 3], [-2.0, 0.0, 0.0], [0.0, 0.3, 0.0], 1.2),
        magnet([1.0, 2.0, 1.0], [2.0, 0.0, 0.0], [0.0, 0.3, 0.0], 1.2),
    ];
    for (tiles, images) in [(across.to_vec(), 4), (beside, 2), (easy, 4), (lone, 1), (unlike, 4)] {
        for level in [2, 3] {
            let division = Division::new(&tiles, &IronPlanes::default(), level).unwrap();
            let orbits = Orbits::new(&tiles, &division, &IronPlanes::default(), level);
            assert_eq!(orbits.images.len(), images, "{tiles:?}");
            let all = PairSums::by_tensors(&division, Orbits::trivial(division.cells.len()), |_| {}).unwrap();
            let all = Magnetization::from_sums(&tiles, division.clone(), &all, |_| {}).unwrap();
            let solution = solve(&tiles, level);
            let errors = all.cells().iter().zip(solution.cells());
            let error = errors.map(|(a, b)| (a.polarization_t() - b.polarization_t()).length()).fold(0.0, f64::max);
            assert!(error <= 1e-11, "{level} {images}: {error:e}");
            for (images, signs) in &orbits.images {
                for (cell, image) in images.iter().enumerate() {
                    let fields_t = solution.fields_t();
                    assert_eq!(fields_t[*image], *signs * fields_t[cell], "{level} {cell} {image}");
                }
            }
        }
    }
}

/// The solution takes one product for each distinct eigenvalue, here four from 1 to 100, apart from
/// round-off. Directions that are not conjugate take hundreds.
#[test]
fn conjugate_gradients_take_one_product_for_each_eigenvalue() {
    const EIGENVALUES: [f64; 4] = [1.0, 7.0, 40.0, 100.0];
    let right: Vec<DVec3> = (0..20).map(|n| DVec3::new(1.0, 0.5 + f64::from(n), -2.0)).collect();
    let products = std::cell::Cell::new(0);
    let matrix = |x: &[DVec3]| {
        products.set(products.get() + 1);
        x.iter().enumerate().map(|(n, x)| EIGENVALUES[n % 4] * *x).collect()
    };
    let solution = conjugate_gradients(&right, 1e-10, matrix).unwrap();
    assert!(products.get() <= 5, "{} products", products.get());
    for (n, (x, right)) in solution.iter().zip(&right).enumerate() {
        // The residual is 1e-10 of the right side, whose norm is 53, and the least eigenvalue is 1.
        assert!((*x - *right / EIGENVALUES[n % 4]).length() < 1e-8, "{n}: {x}");
    }
}

/// Between two planes of iron the tree, and mirrors across the other axes, agree with the tensors
/// of all pairs.
#[test]
fn tree_and_mirrors_agree_with_all_tensors_between_iron() {
    let tiles = [
        magnet([1.0, 2.0, 1.0], [0.0; 3], [0.5, 0.0, 0.0], 1.2),
        magnet([2.0, 1.0, 1.0], [1.5, 0.0, 0.0], [0.3, 0.0, 0.0], 1.1),
        magnet([2.0, 1.0, 1.0], [-1.5, 0.0, 0.0], [0.3, 0.0, 0.0], 1.1),
    ];
    let plane = |z: f64, up: f64| IronPlane::new(DVec3::new(0.0, 0.0, z), DVec3::new(0.0, 0.0, up), 10.0).unwrap();
    let iron = IronPlanes::new(vec![plane(-0.5, 1.0), plane(3.0, -1.0)]).unwrap();
    let division = Division::new(&tiles, &iron, 3).unwrap();
    let orbits = Orbits::new(&tiles, &division, &iron, 3);
    let without = Orbits::new(&tiles, &division, &IronPlanes::default(), 3);
    assert_eq!((without.images.len(), orbits.images.len()), (8, 4));
    let trivial = Orbits::trivial(division.cells.len());
    let [all, mirrored, tree] = [
        PairSums::by_tensors(&division, trivial, |_| {}),
        PairSums::by_tensors(&division, orbits, |_| {}),
        PairSums::by_tree(&division, |_| {}),
    ]
    .map(|sums| Magnetization::from_sums(&tiles, division.clone(), &sums.unwrap(), |_| {}).unwrap());
    let alone = solve(&tiles, 3);
    let largest = |one: &Magnetization, other: &Magnetization| {
        let pairs = one.cells().iter().zip(other.cells());
        pairs.map(|(a, b)| (a.polarization_t() - b.polarization_t()).length()).fold(0.0, f64::max)
    };
    let change = largest(&all, &alone);
    assert!(change > 1e-3, "{change:e}");
    assert!(largest(&all, &mirrored) < 1e-11, "{:e}", largest(&all, &mirrored));
    assert!(largest(&all, &tree) < 1e2 * TREE_ERROR * change, "{:e} {change:e}", largest(&all, &tree));
}

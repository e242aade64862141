//! Flat iron by its images: against a plate of soft cells, and recoil beside it.

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_force::FilmForces;
use magsplice_magnet::{IronPlane, IronPlanes, MU_0, Quantity, Tile};
use magsplice_recoil::{Magnetization, RecoilTile};

use crate::magnet;

/// Boundaries of the boxes of the plate, from its middle outwards and from its face downwards, in
/// millimetres. The plate is 44 mm wide and 16 mm thick.
const ACROSS_MM: [f64; 9] = [0.0, 0.5, 1.0, 1.6, 2.4, 3.6, 6.0, 11.0, 22.0];
const DOWN_MM: [f64; 7] = [0.0, 0.5, 1.1, 2.0, 3.6, 7.0, 16.0];

/// Magnet above the plate.
const SIDE_MM: f64 = 2.0;
const GAP_MM: f64 = 1.0;

/// The boxes of the plate, with every boundary or every second one.
fn plate(step: usize, mu_r: f64) -> Vec<RecoilTile> {
    let half: Vec<f64> = ACROSS_MM.into_iter().step_by(step).collect();
    let across: Vec<f64> = half.iter().skip(1).rev().map(|x| -x).chain(half.iter().copied()).collect();
    let down: Vec<f64> = DOWN_MM.into_iter().step_by(step).collect();
    let mut boxes = Vec::new();
    for x in across.windows(2) {
        for y in across.windows(2) {
            for z in down.windows(2) {
                let (lower, upper) = (DVec3::new(x[0], y[0], -z[1]), DVec3::new(x[1], y[1], -z[0]));
                let (size, centre) = (upper - lower, 0.5 * (lower + upper));
                boxes.push(magnet(size.to_array(), centre.to_array(), [0.0; 3], mu_r));
            }
        }
    }
    boxes
}

/// The field of the plate at points that are as far from it as its boxes are large, from boxes of
/// two sizes. What is left is the next order in their size, and the end of the plate: (5 mm / 44
/// mm)^3, some tenths of a per cent. Without images the error would be 1.
#[test]
fn a_thick_plate_of_soft_cells_has_the_field_of_images() {
    let points = [[1.5, 0.5, 1.0], [2.5, 1.0, 2.0], [0.5, 0.0, 4.0], [2.5, 1.5, 1.6], [0.0, 0.5, 5.0]];
    let points: Vec<DVec3> = points.into_iter().map(DVec3::from).collect();
    for (mu_r, j_t) in [(4.0, [1.0, 0.0, 0.0]), (20.0, [0.0, 0.0, 1.0])] {
        let cube = magnet([SIDE_MM; 3], [0.0, 0.0, GAP_MM + 0.5 * SIDE_MM], j_t, 1.0);
        let plane = IronPlane::new(DVec3::ZERO, DVec3::Z, mu_r).unwrap();
        let images = IronPlanes::new(vec![plane]).unwrap().images(&[cube.tile]).unwrap();
        let by_images_t = Scene::new(&images.tiles).field_at(Quantity::FluxDensity, &points).unwrap();
        let of_plate_t = |step: usize| {
            let solution =
                Magnetization::solve(&[&[cube][..], &plate(step, mu_r)].concat(), &IronPlanes::default(), 1, |_| {})
                    .unwrap();
            Scene::new(&solution.cells()[1..]).field_at(Quantity::FluxDensity, &points).unwrap()
        };
        let [coarse_t, fine_t] = [2, 1].map(of_plate_t);
        for (index, image_t) in by_images_t.iter().enumerate() {
            // The error falls as the square of the sides of the boxes.
            let limit_t = fine_t[index] + (fine_t[index] - coarse_t[index]) / 3.0;
            let error = (limit_t - *image_t).length() / image_t.length();
            assert!(error < 0.01, "mu_r {mu_r}, {}: {limit_t}, not {image_t}: {error}", points[index]);
        }
    }
}

/// Iron below z = `z`.
fn iron(z: f64, mu_r: f64) -> IronPlanes {
    IronPlanes::new(vec![IronPlane::new(DVec3::new(0.0, 0.0, z), DVec3::Z, mu_r).unwrap()]).unwrap()
}

/// Magnets of different shapes, one on the iron at z = -0.5.
fn magnets() -> Vec<RecoilTile> {
    vec![
        magnet([1.0, 2.0, 1.0], [0.0; 3], [0.5, 0.0, 0.2], 1.2),
        magnet([2.0, 1.0, 1.0], [1.7, 0.0, 0.3], [0.0, 0.1, 0.3], 1.1),
        magnet([2.0, 1.0, 1.0], [-1.7, 0.5, 1.1], [0.0, 0.2, -0.3], 1.5),
    ]
}

fn largest_difference(some: &[Tile], others: &[Tile]) -> f64 {
    let pairs = some.iter().zip(others);
    pairs.map(|(a, b)| (a.scene_polarization_t() - b.scene_polarization_t()).length()).fold(0.0, f64::max)
}

/// With iron of infinite permeability, magnets at the places of the images have their
/// polarizations. The iron is normal to an axis, or oblique and apart from the magnets.
#[test]
fn magnets_at_the_places_of_images_have_their_recoil() {
    let normal = DVec3::new(0.2, -0.3, 1.0);
    let oblique = IronPlane::new(DVec3::new(0.0, 0.0, -4.0), normal, f64::INFINITY).unwrap();
    for iron in [iron(-0.5, f64::INFINITY), IronPlanes::new(vec![oblique]).unwrap()] {
        let tiles = magnets();
        let bare: Vec<Tile> = tiles.iter().map(|each| each.tile).collect();
        let images = iron.images(&bare).unwrap().tiles;
        let images = images.iter().zip(&tiles).map(|(tile, of)| RecoilTile { tile: *tile, ..*of });
        let both: Vec<RecoilTile> = tiles.iter().copied().chain(images).collect();
        let by_magnets = Magnetization::solve(&both, &IronPlanes::default(), 2, |_| {}).unwrap();
        let by_iron = Magnetization::solve(&tiles, &iron, 2, |_| {}).unwrap();
        let alone = Magnetization::solve(&tiles, &IronPlanes::default(), 2, |_| {}).unwrap();
        let error = largest_difference(by_iron.cells(), &by_magnets.cells()[..by_iron.cells().len()]);
        let change = largest_difference(by_iron.cells(), alone.cells());
        assert!(error < 1e-11 && change > 1e-5, "{error:e} {change:e}");
    }
}

/// J = J_r + chi (-J / 3 + the mean field of the image) for a cube over iron of finite
/// permeability, whose image field is integrated by the points of Gauss.
#[test]
fn a_cube_over_iron_is_weakened_as_its_image_acts() {
    let (mu_r, j_r) = (1.5, DVec3::new(0.3, 0.0, 0.8));
    let iron = iron(-2.0, 5.0);
    let cube = magnet([1.0; 3], [0.0; 3], j_r.to_array(), mu_r);
    let j_t = Magnetization::solve(&[cube], &iron, 1, |_| {}).unwrap().cells()[0].polarization_t();
    let image = iron.images(&[Tile::new(DVec3::ZERO, DVec3::ONE, j_t).unwrap()]).unwrap();
    // Points and weights of five points of Gauss on a side of 1.
    let nodes: [f64; 3] = [0.0, 0.269_234_655_052_841_55, 0.453_089_922_969_332];
    let weights = [0.284_444_444_444_444_44, 0.239_314_335_249_683_25, 0.118_463_442_528_094_54];
    let side: Vec<(f64, f64)> =
        (0..3).flat_map(|n| [(nodes[n], weights[n]), (-nodes[n], weights[n])]).skip(1).collect();
    let scene = Scene::new(&image.tiles);
    let mut mean_t = DVec3::ZERO;
    for (x, of_x) in &side {
        for (y, of_y) in &side {
            for (z, of_z) in &side {
                mean_t += of_x * of_y * of_z * scene.field(Quantity::FluxDensity, DVec3::new(*x, *y, *z)).unwrap();
            }
        }
    }
    let expected = j_r + (mu_r - 1.0) * (mean_t - j_t / 3.0);
    // Five points integrate the field of a magnet three sides away to a millionth of it.
    assert!((j_t - expected).length() < 1e-6 * mean_t.length(), "{j_t} {expected}");
    assert!(mean_t.length() > 1e-3);
}

/// The force on magnets above iron is the decrease of the energy, the integral of -J_r H / 2. All
/// pairs are near, so that cells act on cells.
#[test]
fn the_force_on_recoiling_magnets_is_the_decrease_of_their_energy() {
    let solved = |moved: f64| {
        let tiles: Vec<RecoilTile> = magnets()
            .into_iter()
            .take(2)
            .map(|of| {
                magnet(
                    of.tile.size().to_array(),
                    (of.tile.position() + moved * DVec3::Z).to_array(),
                    of.tile.polarization_t().to_array(),
                    of.permeability.along(),
                )
            })
            .collect();
        let iron = iron(-1.0, 20.0);
        (Magnetization::solve(&tiles, &iron, 2, |_| {}).unwrap(), iron)
    };
    let energy = |moved: f64| -> f64 {
        let (solution, _) = solved(moved);
        let cells = solution.cells().iter().zip(solution.owners()).zip(solution.fields_t());
        let of_cell = |((cell, owner), field_t): ((&Tile, &usize), &DVec3)| {
            -0.5 * cell.size().element_product() * solution.tiles()[*owner].tile.polarization_t().dot(*field_t)
        };
        cells.map(of_cell).sum()
    };
    let (solution, iron) = solved(0.0);
    let means = solution.mean_tiles();
    let (both, owners) = ([&means[..], solution.cells()], solution.owners());
    let [of_means, of_cells] = both.map(|tiles| iron.images(tiles).unwrap());
    let forces = FilmForces::of_cells(&means, solution.cells(), owners, 1e-9, || ()).unwrap();
    let forces = forces.with_images_of_cells(both, owners, [&of_means, &of_cells], 1e-9, || ()).unwrap();
    let force: f64 = MU_0 * forces.by_all().iter().map(|load| load.force.z).sum::<f64>();
    let step = 0.01;
    let [first, second] = [1.0, 2.0].map(|times| (energy(-times * step) - energy(times * step)) / (2.0 * times * step));
    // The error of the difference is of fourth order in the step over the gap, 0.5.
    let expected = (4.0 * first - second) / 3.0;
    assert!((force / expected - 1.0).abs() < 1e-5 && force.abs() > 1e-4, "{force} {expected}");
}

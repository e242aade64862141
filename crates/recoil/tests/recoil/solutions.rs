//! The polarization against closed forms, laws, and solutions of other programs.

use std::path::Path;

use glam::{DQuat, DVec3};
use magsplice_field::Scene;
use magsplice_layout::Layout;
use magsplice_magnet::{IronPlanes, Permeability, Quantity, Tile};
use magsplice_recoil::{Magnetization, RecoilError, RecoilTile, cell_count};

use crate::magnet;

fn solve(tiles: &[RecoilTile], level: usize) -> Magnetization {
    Magnetization::solve(tiles, &IronPlanes::default(), level, |_| {}).unwrap()
}

/// Two boxes of one cell each. The six equations were solved with mpmath 1.3.0 in 80 digits, their
/// tensors from the functions f and g of Newell, Williams and Dunlop (1993).
#[test]
fn two_boxes_agree_with_eighty_digits() {
    let cubes = [
        magnet([1.0; 3], [0.0; 3], [1.0, 0.0, 0.5], 1.25),
        magnet([1.0; 3], [1.25, 0.25, -0.125], [0.0, -1.0, 0.25], 1.25),
    ];
    let isotropic = [
        [0.918_987_506_728_296, 0.006_605_320_265_456_366, 0.460_097_239_494_179_2],
        [0.012_835_791_389_962_095, -0.919_482_641_172_773_7, 0.225_276_094_502_578_5],
    ];
    let mut boxes = cubes;
    boxes[0].permeability = Permeability::along_and_across(2.0, 1.125).unwrap();
    boxes[1] = magnet([1.0, 2.0, 0.75], [1.25, 0.25, -0.125], [0.0, -1.0, 0.25], 1.0);
    boxes[1].permeability = Permeability::along_and_across(1.0, 4.0).unwrap();
    let anisotropic = [
        [0.742_678_263_482_797_6, 0.003_729_088_194_179_491, 0.371_155_142_959_899_26],
        [0.050_854_241_885_446_73, -1.026_919_127_742_324_4, 0.142_323_489_030_701_86],
    ];
    for (tiles, expected) in [(cubes, isotropic), (boxes, anisotropic)] {
        let solution = solve(&tiles, 1);
        for (cell, expected) in solution.cells().iter().zip(expected) {
            let error = (cell.polarization_t() - DVec3::from(expected)).length();
            assert!(error <= 1e-11, "{cell:?} {expected:?}: {error:e}");
        }
    }
}

/// Tiles turned together: polarizations turn too.
#[test]
fn solution_turns_with_the_tiles() {
    let tiles = [
        magnet([1.0, 2.0, 0.5], [0.0; 3], [1.0, 0.0, 0.5], 1.3),
        magnet([1.0; 3], [1.25, 0.25, -0.125], [0.0, -1.0, 0.25], 1.1),
    ];
    let rotation = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.7);
    let turned = tiles.map(|each| {
        let tile = Tile::new(rotation * each.tile.position(), each.tile.size(), each.tile.polarization_t()).unwrap();
        RecoilTile { tile: tile.rotated(rotation).unwrap(), ..each }
    });
    let (upright, turned) = (solve(&tiles, 2), solve(&turned, 2));
    for (upright, turned) in upright.cells().iter().zip(turned.cells()) {
        assert!((upright.polarization_t() - turned.polarization_t()).length() <= 1e-9);
    }
}

#[test]
fn unit_permeability_keeps_every_bit() {
    let tiles = [
        magnet([1.0; 3], [0.0; 3], [0.1, -0.2, 0.3], 1.0),
        magnet([1.0; 3], [1.0, 0.0, 0.0], [0.7, 0.1, 0.3], 1.2),
        magnet([1.0, 0.5, 1.0], [0.0, 0.0, 1.0], [0.3, 0.7, -0.9], 1.0),
    ];
    let solution = solve(&tiles, 2);
    for (cell, owner) in solution.cells().iter().zip(solution.owners()) {
        let same = cell.polarization_t() == tiles[*owner].tile.polarization_t();
        assert_eq!(same, *owner != 1, "{cell:?}");
    }
    assert_eq!(solve(&[tiles[0]], 1).cells(), [tiles[0].tile]);
}

/// A sphere of cubes: J = J_r 3 / (mu_r + 2). The mean factor over a shape with the symmetry of a
/// cube is 1/3, so the steps of the surface change the mean polarization in second order only: by
/// chi^2 d^2 / (1 + chi / 3)^3, where d is the deviation of the factor of cells from 1/3. It is
/// below a tenth: a cell at a step has factors between the factor of a cube, 1/3, and about 1/3 +-
/// 0.2, and half of the cells are inside.
#[test]
fn sphere_of_cubes_weakens_as_a_sphere() {
    for mu_r in [1.05_f64, 1.5, 3.0] {
        let mut tiles = Vec::new();
        let across = 10_i32;
        for index in 0..across.pow(3) {
            let at = [0, 1, 2].map(|axis| f64::from(index / across.pow(axis) % across) - 0.5 * f64::from(across - 1));
            if DVec3::from(at).length() <= 0.5 * f64::from(across) {
                tiles.push(magnet([1.0; 3], at, [0.0, 0.0, 1.0], mu_r));
            }
        }
        let solution = solve(&tiles, 1);
        let sum: DVec3 = solution.cells().iter().map(Tile::polarization_t).sum();
        let mean = sum / tiles.len() as f64;
        let expected = 3.0 / (mu_r + 2.0);
        let staircase = 0.1 * (mu_r - 1.0);
        let allowed = staircase.powi(2) * expected.powi(3);
        let change = mean - expected * DVec3::Z;
        assert!(change.z > 0.0 && change.length() <= allowed, "{mu_r}: {mean} {expected}");
    }
}

/// The middle of a rod along J keeps J_r; the middle of a plate across J has J_r / mu_r. The
/// demagnetizing factors there are (sqrt(2) side / length) / pi and 1 minus it, to first order in
/// the ratio.
#[test]
fn rods_and_plates_reach_their_limits() {
    let mu_r = 1.2;
    for (size, limit) in [([1.0, 1.0, 100.0], 1.0), ([100.0, 100.0, 1.0], 1.0 / mu_r)] {
        let solution = solve(&[magnet(size, [0.0; 3], [0.0, 0.0, 1.0], mu_r)], 2);
        let middle = solution.cells().iter().min_by(|a, b| a.position().length().total_cmp(&b.position().length()));
        let j_t = middle.unwrap().polarization_t();
        assert!((j_t.z - limit).abs() <= 0.01 * (mu_r - 1.0), "{size:?}: {j_t} {limit}");
    }
}

/// J - J_r = chi mu0 H in each cell, with the field of the cells averaged by `magsplice-field`.
#[test]
fn polarization_agrees_with_the_exact_field() {
    let tiles = [
        magnet([1.0; 3], [0.0; 3], [0.0, 0.0, 1.0], 1.5),
        magnet([1.0, 2.0, 1.0], [1.5, 0.0, 0.25], [1.0, 0.0, 0.0], 1.5),
    ];
    let solution = solve(&tiles, 1);
    let scene = magsplice_field::Scene::new(solution.cells());
    for (cell, each) in solution.cells().iter().zip(&tiles) {
        // The midpoint rule over cells has an error of the order of 1 / count^2 at edges.
        let count = 24;
        let node = |i: i32| (f64::from(i) + 0.5) / f64::from(count) - 0.5;
        let points: Vec<DVec3> = (0..count * count * count)
            .map(|n| {
                let at = DVec3::new(node(n % count), node(n / count % count), node(n / count / count));
                cell.position() + at * cell.size()
            })
            .collect();
        let fields = scene.field_at(magsplice_magnet::Quantity::FieldStrength, &points).unwrap();
        let mean = magsplice_magnet::MU_0 * fields.iter().sum::<DVec3>() / points.len() as f64;
        let error = (cell.polarization_t() - each.tile.polarization_t() - 0.5 * mean).length();
        assert!(error <= 1e-3, "{error:e}");
    }
}

#[test]
fn number_of_threads_does_not_matter() {
    let tiles =
        [magnet([1.0; 3], [0.0; 3], [0.1, -0.2, 0.3], 1.3), magnet([1.0; 3], [1.0, 0.0, 0.0], [0.7, 0.1, 0.3], 1.2)];
    let with_threads = |threads, level| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&tiles, level))
    };
    // By all tensors, and by a tree.
    for level in [3, 9] {
        assert_eq!(with_threads(1, level), with_threads(3, level));
    }
}

#[test]
fn bad_input_is_refused() {
    let cube = magnet([1.0; 3], [0.0; 3], [0.0, 0.0, 1.0], 1.1);
    let solve =
        |tiles: &[RecoilTile], level| Magnetization::solve(tiles, &IronPlanes::default(), level, |_| {}).unwrap_err();
    assert_eq!(solve(&[cube], 0), RecoilError::NoLevel);
    let beside = magnet([1.0; 3], [0.5, 0.0, 0.0], [0.0, 0.0, 1.0], 1.1);
    assert_eq!(solve(&[cube, beside], 1), RecoilError::Overlap { first: 0, second: 1 });
    assert_eq!(solve(&[cube], 100), RecoilError::TooManyCells { count: 1_000_000 });
    assert!(matches!(solve(&[cube], usize::MAX), RecoilError::TooManyCells { .. }));
    for mu_r in [0.99, -1.0, f64::NAN, f64::INFINITY, 1e5] {
        assert!(Permeability::isotropic(mu_r).is_err(), "{mu_r}");
    }
    assert!(Magnetization::solve(&[], &IronPlanes::default(), 1, |_| {}).unwrap().cells().is_empty());
}

/// A stack of two tiles, the upper turned about the axis of the stack by a small angle and by none:
/// the averages over turned cells and the closed form differ in proportion to the angle.
#[test]
fn turned_stack_is_continuous_in_its_angle() {
    let lower = magnet([1.0; 3], [0.0; 3], [0.3, 0.0, 1.0], 1.2);
    let upper = magnet([1.0; 3], [0.0, 0.0, 1.0], [0.0, 0.5, -1.0], 1.2);
    let angle = 1e-6;
    let tile = upper.tile.rotated(DQuat::from_rotation_z(angle)).unwrap();
    let turned = RecoilTile { tile, ..upper };
    let (straight, turned) = (solve(&[lower, upper], 2), solve(&[lower, turned], 2));
    for (a, b) in straight.cells().iter().zip(turned.cells()) {
        let change = (a.polarization_t() - b.polarization_t()).length();
        assert!(change <= angle, "{a:?} {b:?}: {change:e}");
    }
}

/// The tiles of the published film, each in three equal cells along its longest side, the first of
/// two.
fn thirds_of_the_published_film(mu_r: f64) -> Vec<RecoilTile> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../layouts/published-film.toml");
    let permeability = Permeability::isotropic(mu_r).unwrap();
    let third = |tile: &Tile, shift: f64| {
        let axis = tile.size().to_array().iter().rposition(|side| *side == tile.size().max_element()).unwrap();
        let along = DVec3::AXES[if axis == 1 && tile.size().x == tile.size().y { 0 } else { axis }];
        let size = tile.size() * (DVec3::ONE - 2.0 / 3.0 * along);
        let position = tile.position() + shift * tile.size() * along;
        RecoilTile { tile: Tile::new(position, size, tile.polarization_t()).unwrap(), permeability }
    };
    let tiles = Layout::read(path).unwrap().bare_tiles();
    tiles.iter().flat_map(|tile| [-1.0, 0.0, 1.0].map(|step| third(tile, step / 3.0))).collect()
}

/// Equal cells give equal fields: B agrees to 1e-6 of its largest value with the dense solution of
/// magpylib-material-response, whose interaction is averaged over cells.
#[test]
fn fields_agree_with_another_program() {
    let boxes = [
        ([1.0, 1.0, 1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.2], [1.05, 1.05]),
        ([1.0, 2.0, 1.0], [1.0, 0.5, 0.0], [0.7, 0.0, -0.7], [1.3, 1.3]),
        ([0.5, 1.0, 0.75], [-0.75, 0.25, 0.125], [0.0, -1.0, 0.2], [2.0, 2.0]),
        ([2.0, 1.5, 0.5], [0.25, 0.25, 0.75], [0.0, 0.0, -0.9], [1.04, 1.15]),
    ];
    let boxes = boxes.map(|(size, position, polarization_t, [along, across])| RecoilTile {
        permeability: Permeability::along_and_across(along, across).unwrap(),
        ..magnet(size, position, polarization_t, 1.0)
    });
    let rows = reference_fields(101);
    for (set, tiles, count) in [
        ("film-1.05", thirds_of_the_published_film(1.05), 48),
        ("film-1.20", thirds_of_the_published_film(1.2), 48),
        ("boxes", boxes.to_vec(), 5),
    ] {
        assert!(tiles.iter().all(|each| cell_count(each.tile.size(), 1) == 1));
        let rows: Vec<_> = rows.iter().filter(|(of, ..)| of == set).collect();
        assert_eq!(rows.len(), count, "{set}");
        let points: Vec<DVec3> = rows.iter().map(|(_, point, _)| *point).collect();
        let fields = Scene::new(solve(&tiles, 1).cells()).field_at(Quantity::FluxDensity, &points).unwrap();
        let largest = fields.iter().map(|b_t| b_t.length()).fold(0.0, f64::max);
        for (b_t, (_, point, expected)) in fields.iter().zip(rows) {
            let error = (*b_t - *expected).length();
            assert!(error <= 1e-6 * largest, "{set}, {point}: {b_t} {expected}");
        }
    }
}

/// Set, point and B of the rows of `tests/reference/recoil_fields.csv`, whose README describes
/// their computation.
fn reference_fields(count: usize) -> Vec<(String, DVec3, DVec3)> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference/recoil_fields.csv");
    let mut reader = csv::Reader::from_path(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let row = |record: Result<csv::StringRecord, csv::Error>| {
        let record = record.expect("a well-formed row");
        let numbers: Vec<f64> = record.iter().skip(1).map(|text| text.parse().expect("a number")).collect();
        (record[0].to_owned(), DVec3::from_slice(&numbers), DVec3::from_slice(&numbers[3..]))
    };
    let rows: Vec<_> = reader.records().map(row).collect();
    assert_eq!(rows.len(), count, "{} is not the table this test was written for", path.display());
    rows
}

#[test]
fn tree_refuses_what_it_cannot_solve() {
    let soft = [magnet([1.0; 3], [0.0; 3], [0.0, 0.0, 1.0], 200.0)];
    let error = Magnetization::solve(&soft, &IronPlanes::default(), 15, |_| {}).unwrap_err();
    assert_eq!(error, RecoilError::TooPermeable { permeability: 200.0, cells: 3375 });
    assert!(error.to_string().contains("lower it"), "{error}");
}

/// `progress` receives each cell once, by all methods.
#[test]
fn progress_counts_cells() {
    let cube = [magnet([1.0; 3], [0.0; 3], [0.0, 0.0, 1.0], 1.1)];
    for level in [1, 4, 5, 15] {
        let count = std::sync::atomic::AtomicUsize::new(0);
        let add = |cells| {
            count.fetch_add(cells, std::sync::atomic::Ordering::Relaxed);
        };
        let cells = Magnetization::solve(&cube, &IronPlanes::default(), level, add).unwrap().cells().len();
        assert_eq!(count.into_inner(), cells, "level {level}");
    }
}

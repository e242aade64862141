//! Values and their errors against finer divisions.

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_magnet::{IronPlanes, Permeability, Quantity, Tile};
use magsplice_recoil::tolerances::MAX_CELLS;
use magsplice_recoil::{
    Group, RecoilTile, Refined, RefinementError, RefinementSettings, extrapolated_at, refine, refine_within,
};

use crate::magnet;

/// Number of levels needed for errors.
const LEAST_LEVEL: usize = 3;

/// Sets of tiles with points for B.
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
    let settings =
        RefinementSettings { tolerances: vec![tolerance; 3 * points.len()], most_cells, iron: IronPlanes::default() };
    refine(tiles, &settings, |cells| flux_densities(cells, points), |_| {})
}

fn at_level(tiles: &[RecoilTile], level: usize, groups: &[Group], quantity: impl Fn(&[Tile]) -> Vec<f64>) -> Refined {
    extrapolated_at(tiles, &IronPlanes::default(), level, groups, quantity, |_| {}).unwrap()
}

/// A tile with permeabilities along the easy axis and across it.
fn anisotropic(size: [f64; 3], polarization_t: [f64; 3], [along, across]: [f64; 2]) -> RecoilTile {
    let permeability = Permeability::along_and_across(along, across).unwrap();
    RecoilTile { permeability, ..magnet(size, [0.0; 3], polarization_t, 1.0) }
}

/// Sets of tiles of many kinds: rods, plates, cubes, pairs, rows, and a film.
fn shapes() -> Vec<Vec<RecoilTile>> {
    let (here, up, down) = ([0.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]);
    let cube = |position, polarization_t, mu_r| magnet([1.0; 3], position, polarization_t, mu_r);
    let turned = cube([1.6, 0.2, 0.1], [0.0, 1.0, 0.3], 1.2);
    let turned = RecoilTile { tile: turned.tile.rotated(glam::DQuat::from_rotation_z(0.5)).unwrap(), ..turned };
    let quarter_turns = |i: i32| {
        let angle = f64::from(i) * std::f64::consts::FRAC_PI_2;
        cube([f64::from(i), 0.0, 0.0], [angle.sin(), 0.0, angle.cos()], 1.1)
    };
    let squares = |i: i32| {
        let polarization_t = if (i % 3 + i / 3) % 2 == 0 { up } else { down };
        cube([f64::from(i % 3), f64::from(i / 3), 0.0], polarization_t, 1.1)
    };
    vec![
        vec![magnet([1.0, 1.0, 6.0], here, up, 1.1)],
        vec![magnet([6.0, 1.0, 1.0], here, up, 1.1)],
        vec![magnet([1.0, 1.0, 4.0], here, [0.6, 0.0, 0.8], 3.0)],
        vec![magnet([5.0, 5.0, 1.0], here, up, 1.2)],
        vec![magnet([5.0, 4.0, 1.0], here, [1.0, 0.3, 0.0], 1.2)],
        vec![magnet([4.0, 4.0, 1.0], here, up, 3.0)],
        vec![cube(here, [0.5, 0.4, 1.0], 2.0)],
        vec![anisotropic([1.0; 3], [0.0, 0.6, 0.8], [1.05, 1.3])],
        vec![anisotropic([2.0, 3.0, 1.0], [0.6, 0.0, 0.8], [1.05, 1.5])],
        vec![cube(here, up, 1.1), cube([1.0, 0.0, 0.0], down, 1.1)],
        vec![cube(here, up, 2.0), cube([0.0, 0.0, 1.0], down, 2.0)],
        vec![cube(here, up, 1.3), cube([1.1, 0.0, 0.0], up, 1.3)],
        vec![cube(here, up, 1.1), magnet([2.0, 1.0, 1.0], [2.5, 0.4, 0.0], [0.0, -1.0, 0.5], 1.4)],
        vec![cube(here, up, 1.05), magnet([1.0, 1.0, 0.5], [0.0, 0.0, -0.75], here, 3.0)],
        vec![cube(here, up, 1.2), turned],
        (0..5).map(quarter_turns).collect(),
        (0..9).map(squares).collect(),
    ]
}

/// B at points beside and below the box of all tiles, half a unit to three away from it, a
/// difference of two values that nearly cancel, and the mean polarization.
fn values(tiles: &[RecoilTile], cells: &[Tile]) -> Vec<f64> {
    let half = tiles.iter().map(|each| 0.5 * each.tile.size());
    let ends = tiles.iter().map(|each| each.tile.position()).zip(half);
    let upper = ends.clone().map(|(middle, half)| middle + half).fold(DVec3::NEG_INFINITY, DVec3::max);
    let lower = ends.map(|(middle, half)| middle - half).fold(DVec3::INFINITY, DVec3::min);
    let (centre, half) = (0.5 * (lower + upper), 0.5 * (upper - lower));
    let places = [
        ([0.1, 0.2, -1.0], [0.0, 0.0, -0.5]),
        ([0.55, -0.3, -1.0], [0.0, 0.0, -1.0]),
        ([0.9, 0.8, 1.0], [0.0, 0.0, 0.7]),
        ([1.0, 0.1, 0.3], [0.6, 0.0, 0.0]),
        ([0.2, -1.0, -0.2], [0.0, -2.0, 0.0]),
        ([-0.4, 0.6, -1.0], [0.0, 0.0, -3.0]),
    ];
    let points = places.map(|(on, away)| centre + DVec3::from(on) * half + DVec3::from(away));
    let mut values = flux_densities(cells, &points);
    values.push(values[2] - 3.0 * values[17]);
    let volume = |cell: &Tile| cell.size().element_product();
    let sum: DVec3 = cells.iter().map(|cell| cell.scene_polarization_t() * volume(cell)).sum();
    values.extend((sum / cells.iter().map(volume).sum::<f64>()).to_array());
    values
}

/// Values extrapolated from levels to 3 and to 4 contain those from levels to 6 within their
/// errors. Values that vanish by symmetry have the error of the solution.
#[test]
fn errors_contain_finer_levels_of_many_shapes() {
    let solution_error = 1e-7;
    for (index, tiles) in shapes().into_iter().enumerate() {
        let groups = [[6, 3], [1, 1], [1, 3]].map(|[vectors, components]| Group { vectors, components });
        let at = |level| at_level(&tiles, level, &groups, |cells| values(&tiles, cells));
        let finest = at(6).values;
        for level in 3..=4 {
            let Refined { values, errors, .. } = at(level);
            for (i, (value, error)) in values.iter().zip(errors).enumerate() {
                let difference = (value - finest[i]).abs();
                assert!(difference <= error + solution_error, "{index} {level} {i}: {value} {difference:e} {error:e}");
            }
        }
    }
}

/// Mean polarization of cubes that fill a sphere: J_r 3 / (mu_r + 2), within the error, for three
/// numbers of cubes across. The mean factor of a shape with the symmetry of a cube is 1/3, so steps
/// of the surface change the mean in second order only.
#[test]
fn errors_contain_the_factor_of_a_sphere() {
    for (across, mu_r) in [(4_i32, 1.05_f64), (5, 1.2), (6, 1.5)] {
        let middle = 0.5 * f64::from(across - 1);
        let places =
            (0..across.pow(3)).map(|index| [0, 1, 2].map(|axis| f64::from(index / across.pow(axis) % across) - middle));
        let inside = places.filter(|place| DVec3::from(*place).length() <= 0.5 * f64::from(across));
        let tiles: Vec<RecoilTile> = inside.map(|place| magnet([1.0; 3], place, [0.0, 0.0, 1.0], mu_r)).collect();
        let mean = |cells: &[Tile]| {
            let sum: f64 = cells.iter().map(|cell| cell.polarization_t().z * cell.size().element_product()).sum();
            vec![sum / tiles.len() as f64]
        };
        let best = at_level(&tiles, 3, &[], mean);
        let (difference, error) = ((best.values[0] - 3.0 / (mu_r + 2.0)).abs(), best.errors[0]);
        assert!(difference <= error && error <= 0.15 * (mu_r - 1.0), "{mu_r}: {difference:e} {error:e}");
    }
}

/// The mean polarization of a rod and of a plate along z is J_r / (1 + chi N) with the
/// magnetometric demagnetizing factor N of A. Aharoni, J. Appl. Phys. 83 (1998) 3432, up to the
/// second order of chi.
#[test]
fn errors_contain_the_factors_of_a_rod_and_a_plate() {
    let chi = 1e-3;
    for (size, factor) in [([1.0, 1.0, 6.0], 0.074_466_093_259_526_94), ([6.0, 6.0, 1.0], 0.726_985_815_276_951_5)] {
        let tiles = [magnet(size, [0.0; 3], [0.0, 0.0, 1.0], 1.0 + chi)];
        let volume: f64 = size.iter().product();
        let mean = |cells: &[Tile]| {
            let sum: f64 = cells.iter().map(|cell| cell.polarization_t().z * cell.size().element_product()).sum();
            vec![sum / volume]
        };
        let best = at_level(&tiles, 4, &[], mean);
        let difference = (best.values[0] - 1.0 / (1.0 + chi * factor)).abs();
        assert!(difference <= best.errors[0] + chi * chi, "{size:?}: {} {difference:e}", (1.0 - best.values[0]) / chi);
    }
}

#[test]
fn refinement_ends_within_its_tolerance() {
    let (tiles, points) = &cases()[1];
    let refined = refine_to(tiles, points, (2e-4, 4_000)).unwrap();
    assert!(refined.errors.iter().all(|error| *error <= 2e-4), "{:?}", refined.errors);
    let cells = |level: usize| level.pow(3);
    assert_eq!(refined.magnetization.cells().len(), cells(refined.level) + cells(refined.level - 1));
}

#[test]
fn refinement_without_enough_cells_says_so() {
    let (tiles, points) = &cases()[0];
    let best_of = |most_cells, tolerance| match refine_to(tiles, points, (tolerance, most_cells)) {
        Err(RefinementError::NotConverged { needed_cells, reached, best, .. }) => (needed_cells, reached, best),
        other => panic!("{other:?}"),
    };
    // With two levels no error is known.
    let (needed_cells, reached, best) = best_of(8, 1.0);
    assert_eq!((needed_cells, reached, best), (27, f64::INFINITY, None));
    // An error that falls with the fourth power of the level would be small enough at level 10, but
    // not at level 4.
    let (_, third, _) = best_of(27, 1e-9);
    let tolerance = third * (3.0_f64 / 10.0).powi(4) * 1.1;
    let (needed_cells, reached, best) = best_of(100, tolerance);
    assert_eq!((reached, best.unwrap().level), (third, LEAST_LEVEL));
    assert_eq!(needed_cells, ((3.0 * (third / tolerance).powf(0.25)).ceil() as usize).pow(3));
    assert!(best_of(1000, tolerance).2.unwrap().level > LEAST_LEVEL);
    assert_eq!(best_of(1000, 0.8 * tolerance).2.unwrap().level, LEAST_LEVEL);
}

/// A tenth of a side below two cubes the error falls so slowly that a thousandth of the change
/// needs more cells than possible. This is known after a few hundred.
#[test]
fn tolerance_out_of_reach_is_refused_early() {
    let tiles = [-0.5, 0.5].map(|x: f64| magnet([1.0; 3], [x, 0.0, 0.5], [0.0, 0.0, -1.2 * x.signum()], 2.0));
    let points: Vec<DVec3> = (-4..=4).map(|x| DVec3::new(0.25 * f64::from(x), 0.1, -0.1)).collect();
    let groups = [Group { vectors: points.len(), components: 3 }];
    let tolerances = |_: &[f64], values: &[f64]| vec![2e-4; values.len()];
    let refined = refine_within(
        &tiles,
        &IronPlanes::default(),
        MAX_CELLS,
        &groups,
        tolerances,
        |cells| flux_densities(cells, &points),
        |_| {},
    );
    let Err(RefinementError::NotConverged { best: Some(best), needed_cells, .. }) = refined else {
        panic!("{:?}", refined.map(|refined| refined.level));
    };
    assert!(best.level <= 8 && needed_cells > MAX_CELLS, "{} {needed_cells}", best.level);
}

#[test]
fn refinement_of_no_numbers_ends_at_the_first_error() {
    let (tiles, _) = &cases()[0];
    let settings = RefinementSettings { tolerances: vec![1.0], most_cells: MAX_CELLS, iron: IronPlanes::default() };
    let unknown = refine(tiles, &settings, |_| vec![f64::NAN], |_| {});
    assert!(
        matches!(&unknown, Err(RefinementError::NotConverged { best: Some(best), .. }) if best.level == LEAST_LEVEL),
        "{unknown:?}"
    );
    let lengths = refine(tiles, &settings, |cells| vec![0.0; cells.len()], |_| {});
    assert_eq!(lengths, Err(RefinementError::Count { tolerances: 1, values: 9 }));
}

#[test]
fn rigid_tiles_need_one_level() {
    let tiles = [magnet([1.0; 3], [0.0; 3], [0.0, 0.0, 1.0], 1.0)];
    let points = [DVec3::new(0.1, 0.2, -2.0)];
    let refined = refine_to(&tiles, &points, (0.0, 1)).unwrap();
    assert_eq!(refined.values, flux_densities(&[tiles[0].tile], &points));
    assert_eq!((refined.level, refined.errors), (1, vec![0.0; 3]));
}

/// Values with an infinite tolerance need no further level.
#[test]
fn refinement_ends_when_the_values_with_tolerances_are_known() {
    let (tiles, points) = &cases()[0];
    let mut settings = RefinementSettings {
        tolerances: vec![f64::INFINITY; 3 * points.len()],
        most_cells: 4_000,
        iron: IronPlanes::default(),
    };
    let quantity = |cells: &[Tile]| flux_densities(cells, points);
    assert_eq!(refine(tiles, &settings, quantity, |_| {}).unwrap().level, LEAST_LEVEL);
    settings.tolerances[2] = 1e-5;
    let refined = refine(tiles, &settings, quantity, |_| {}).unwrap();
    assert!(refined.level > LEAST_LEVEL && refined.errors[2] <= 1e-5);
}

/// Points near faces, edges and corners, at distances down to a hundredth of the shortest side.
/// Errors fall slowly there, and so do their estimates. Nearer to a face than a tenth of the
/// shortest side the estimate of the finest level is as large as the change, so the test is weak
/// there.
#[test]
fn errors_contain_finer_levels_near_a_tile() {
    let tiles = [magnet([3.0, 6.0, 1.0], [0.0; 3], [0.12, 0.0, 0.0], 1.2)];
    let near = |distance: f64| {
        [[0.2, 0.3, -0.5], [1.5, 0.3, 0.1], [1.5, 0.3, -0.5], [1.5, 3.0, -0.5]].map(|surface: [f64; 3]| {
            let outward =
                DVec3::new(f64::from(surface[0] == 1.5), f64::from(surface[1] == 3.0), -f64::from(surface[2] == -0.5));
            DVec3::from(surface) + distance * outward.normalize()
        })
    };
    let points: Vec<DVec3> = [0.3, 0.1, 0.03, 0.01].into_iter().flat_map(near).collect();
    let field_t = |cells: &[Tile]| flux_densities(cells, &points);
    let finest = at_level(&tiles, 12, &[], field_t);
    for level in [3, 4] {
        let of_level = at_level(&tiles, level, &[], field_t);
        let cells_t = field_t(of_level.magnetization.cells());
        for (i, cells_t) in cells_t.chunks(3).enumerate() {
            let of = |values: &[f64]| DVec3::from_slice(&values[3 * i..]);
            let cells_t = DVec3::from_slice(cells_t);
            let stated_t = of(&of_level.errors).length() + (cells_t - of(&of_level.values)).length();
            let error_t = (cells_t - of(&finest.values)).length();
            assert!(error_t <= stated_t, "level {level}, {}: {error_t:e}, stated {stated_t:e}", points[i]);
        }
    }
}

//! Boxes of measured tiles: sorted films against unsorted films.

use glam::DVec3;
use magsplice_layout::{FilmTolerance, Layout};
use magsplice_magnet::Tile;
use magsplice_making::{
    AssignmentError, AssignmentProblem, AssignmentSettings, CutTile, Orientation, PlaceGroup, ShortGroup,
};
use magsplice_tolerance::{EvaluationGrid, RealFilm, TileChanges};

use crate::boxed::boxed;

fn shipped(name: &str) -> (Layout, EvaluationGrid) {
    let layout = Layout::read(format!("../../layouts/{name}.toml")).unwrap_or_else(|e| panic!("{e}"));
    let volume = layout.volume.expect("a volume");
    (layout, EvaluationGrid { grid: volume.grid, reference: volume.reference_mm })
}

fn percentile_95(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[(0.95 * sorted.len() as f64) as usize]
}

/// Boxes of random tiles in the order of cutting, and sorted. The ratio of the 95th percentiles of
/// 20 boxes has a standard error of about 15 %.
#[test]
fn sorted_films_are_many_times_better() {
    for (name, factor) in [("designed-displacement", 8.0), ("designed-stock", 11.0)] {
        let (layout, volume) = shipped(name);
        let tiles = layout.bare_tiles();
        let model =
            TileChanges::new(&RealFilm::new(&tiles, &FilmTolerance::default()), &volume, &layout.ideal.unwrap())
                .unwrap();
        let settings = AssignmentSettings { starts: Some(4), kicks: 50, ..AssignmentSettings::default() };
        let (mut random, mut sorted) = (Vec::new(), Vec::new());
        for seed in 0..20 {
            let groups = boxed(&layout, seed, 0.0);
            let problem = AssignmentProblem::new(&model, &tiles, &groups, &[], &settings).unwrap();
            let found = problem.solve(&settings, || ()).unwrap();
            random.push(found.in_order_rms_mm);
            sorted.push(found.rms_mm);
        }
        let ratio = percentile_95(&random) / percentile_95(&sorted);
        assert!(ratio > factor, "{name}: {} to {}", percentile_95(&random), percentile_95(&sorted));
    }
}

/// Four places have so few orders that every search ends at the best. 56 places have many, and
/// short searches rarely agree.
#[test]
fn starts_are_added_until_some_agree_on_the_best() {
    let (layout, volume) = shipped("designed-displacement");
    let tiles = layout.bare_tiles();
    let model =
        TileChanges::new(&RealFilm::new(&tiles, &FilmTolerance::default()), &volume, &layout.ideal.unwrap()).unwrap();
    let whole = boxed(&layout, 1, 0.0);
    let few =
        [PlaceGroup { places: whole[0].places[..4].to_vec(), tiles: whole[0].tiles[..4].to_vec(), ..whole[0].clone() }];
    let none = [PlaceGroup { places: Vec::new(), tiles: Vec::new(), ..whole[0].clone() }];
    for (groups, kicks, starts) in [(&few[..], 20, 16), (&whole[..], 0, 128), (&none[..], 20, 16)] {
        let settings = AssignmentSettings { kicks, ..AssignmentSettings::default() };
        let problem = AssignmentProblem::new(&model, &tiles, groups, &[], &settings).unwrap();
        assert_eq!(problem.solve(&settings, || ()).unwrap().starts_rms_mm.len(), starts);
    }
}

/// The resulting film consists of tiles of the box, each used once, in fitting orientations.
#[test]
fn answer_is_a_film_of_the_box() {
    let (layout, volume) = shipped("published-film");
    let tiles = layout.bare_tiles();
    let model =
        TileChanges::new(&RealFilm::new(&tiles, &FilmTolerance::default()), &volume, &layout.ideal.unwrap()).unwrap();
    let groups = boxed(&layout, 3, 0.25);
    let settings = AssignmentSettings { starts: Some(2), kicks: 5, ..AssignmentSettings::default() };
    let problem = AssignmentProblem::new(&model, &tiles, &groups, &[], &settings).unwrap();
    let found = problem.solve(&settings, || ()).unwrap();
    assert_eq!(found.placed.len(), tiles.len());
    let film = problem.film(&found.placed, &[]).unwrap();
    for (number, placed) in found.placed.iter().enumerate() {
        assert_eq!(placed.place, number);
        let group = &groups[placed.group];
        assert!(group.places.contains(&number));
        let others = found.placed.iter().filter(|o| (o.group, o.tile) == (placed.group, placed.tile));
        assert_eq!(others.count(), 1);
        // 3 % and 1 degree from the ordered tile: four deviations of each.
        let change = film[number].polarization_t() - tiles[number].polarization_t();
        assert!(change.length() < 0.17 * tiles[number].polarization_t().length(), "{number}: {change}");
        assert!((film[number].size() - tiles[number].size()).length() < 1e-9);
        assert_eq!(film[number].position(), tiles[number].position());
    }
    assert_eq!(problem.rms_mm(&found.placed, &[]).unwrap(), found.rms_mm);
    assert!(found.rms_mm < 0.7 * found.in_order_rms_mm, "{} and {}", found.rms_mm, found.in_order_rms_mm);
    assert_eq!(found.starts_rms_mm.len(), 2);
    assert!(found.starts_rms_mm[0] <= found.starts_rms_mm[1]);
    assert!((found.starts_rms_mm[0] / found.rms_mm - 1.0).abs() < 0.01, "{found:?}");
    assert_eq!(problem.solve(&settings, || ()).unwrap(), found);
}

/// For two tiles and two places, the result is the best of all orders.
#[test]
fn small_boxes_are_solved_exactly() {
    let (layout, volume) = shipped("published-film");
    let tiles = layout.bare_tiles();
    let model =
        TileChanges::new(&RealFilm::new(&tiles, &FilmTolerance::default()), &volume, &layout.ideal.unwrap()).unwrap();
    for seed in 0..10 {
        let whole = boxed(&layout, seed, 0.0);
        // Three places of the first part.
        let group = PlaceGroup {
            places: whole[0].places[..3].to_vec(),
            tiles: whole[0].tiles[..4].to_vec(),
            ..whole[0].clone()
        };
        let groups = [group];
        let settings = AssignmentSettings { starts: Some(8), kicks: 20, seed, may_turn_over: true };
        let problem = AssignmentProblem::new(&model, &tiles, &groups, &[], &settings).unwrap();
        let found = problem.solve(&settings, || ()).unwrap();
        let mut least = f64::INFINITY;
        let fits = |place: usize| -> Vec<Orientation> {
            let fits = |orientation: &Orientation| {
                let j_t = orientation.apply(groups[0].polarization_t);
                (j_t - tiles[place].polarization_t()).length() < 1e-9
                    && (orientation.sides(groups[0].size_mm) - tiles[place].size()).length() < 1e-9
            };
            Orientation::all().into_iter().filter(fits).collect()
        };
        let places = groups[0].places.clone();
        for order in 0..64_usize {
            let order = [order % 4, order / 4 % 4, order / 16];
            if order[0] == order[1] || order[0] == order[2] || order[1] == order[2] {
                continue;
            }
            for a in fits(places[0]) {
                for b in fits(places[1]) {
                    for c in fits(places[2]) {
                        let mut placed = found.placed.clone();
                        for one in &mut placed {
                            let number = places.iter().position(|place| *place == one.place).unwrap();
                            (one.tile, one.orientation) = (order[number], [a, b, c][number]);
                        }
                        least = least.min(problem.rms_mm(&placed, &[]).unwrap());
                    }
                }
            }
        }
        assert!(found.rms_mm <= least * (1.0 + 1e-6), "seed {seed}: {} and {least}", found.rms_mm);
    }
}

/// A tile with J across its thickness cannot be reversed without turning it over.
#[test]
fn tiles_that_may_not_be_turned_over_are_not() {
    let (layout, volume) = shipped("published-film");
    let tiles = layout.bare_tiles();
    let model =
        TileChanges::new(&RealFilm::new(&tiles, &FilmTolerance::default()), &volume, &layout.ideal.unwrap()).unwrap();
    let groups = boxed(&layout, 1, 0.0);
    let settings =
        AssignmentSettings { starts: Some(2), kicks: 5, may_turn_over: false, ..AssignmentSettings::default() };
    let problem = AssignmentProblem::new(&model, &tiles, &groups, &[], &settings).unwrap();
    let found = problem.solve(&settings, || ()).unwrap();
    assert!(found.placed.iter().all(|placed| placed.orientation.keeps_upper_side()));
    let upright = |sign: f64| Tile::new(DVec3::new(2.0 * sign, 0.0, 0.5), DVec3::new(3.0, 2.0, 1.0), DVec3::Z * sign);
    let film = [upright(1.0).unwrap(), upright(-1.0).unwrap()];
    let cut = CutTile { name: "a".to_owned(), polarization_t: DVec3::Z, size_mm: DVec3::new(3.0, 2.0, 1.0) };
    let group = PlaceGroup {
        size_mm: cut.size_mm,
        polarization_t: DVec3::Z,
        places: vec![0, 1],
        tiles: vec![cut.clone(), cut.clone()],
    };
    let refused = |groups: &[PlaceGroup]| AssignmentProblem::new(&model, &film, groups, &[], &settings).err();
    assert_eq!(refused(std::slice::from_ref(&group)), Some(AssignmentError::NoOrientation { place: 1 }));
    let few = PlaceGroup { tiles: vec![cut], ..group };
    let none = PlaceGroup { tiles: Vec::new(), ..few.clone() };
    let short = |group, tiles| ShortGroup { group, places: 2, tiles };
    assert_eq!(refused(&[few, none]), Some(AssignmentError::TooFew(vec![short(0, 1), short(1, 0)])));
}

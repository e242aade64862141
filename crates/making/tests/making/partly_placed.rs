//! Films with some tiles already placed.

use glam::{DQuat, DVec3};
use magsplice_layout::Layout;
use magsplice_magnet::Tile;
use magsplice_making::{CutTile, FixedTile, PartlyPlaced, PlaceGroup, Placement};

const LAYOUT: &str = r#"
format = 1
name = "three places"
[[tile]]
name = "east"
position_mm = [0, 0, 0.5]
size_mm = [3, 3, 1]
polarization_t = [0.1, 0, 0]
[[tile]]
name = "west"
position_mm = [5, 0, 0.5]
size_mm = [3, 3, 1]
polarization_t = [-0.1, 0, 0]
[[tile]]
name = "strip"
position_mm = [10, 0, 0.5]
size_mm = [3, 1.5, 1]
polarization_t = [0, 0, 0.1]
"#;

const MEASURED_T: [DVec3; 2] = [DVec3::new(0.097, 0.002, 0.003), DVec3::new(0.102, -0.001, 0.002)];

/// The layout, and the squares "s0" and "s1" and the strip "t0".
fn measured() -> (Layout, Vec<PlaceGroup>) {
    let layout = Layout::parse(LAYOUT, "places.toml").unwrap_or_else(|e| panic!("{e}"));
    let mut groups = PlaceGroup::from_layout(&layout);
    for group in &mut groups {
        let is_square = group.size_mm.y == 3.0;
        let polarizations_t = if is_square { MEASURED_T.to_vec() } else { vec![DVec3::new(0.0, 0.0, 0.1)] };
        let name = |number: usize| format!("{}{number}", if is_square { "s" } else { "t" });
        let tile = |(number, polarization_t)| CutTile { name: name(number), polarization_t, size_mm: group.size_mm };
        group.tiles = polarizations_t.into_iter().enumerate().map(tile).collect();
    }
    (layout, groups)
}

fn at<'a>(place: &'a str, tile: &'a str, up: &'a str, mark_deg: f64) -> FixedTile<'a> {
    FixedTile { place, tile, position_mm: None, up, mark_deg }
}

fn placed(tiles: &[FixedTile]) -> PartlyPlaced {
    let (layout, groups) = measured();
    let mut placement = Placement::new(&layout, &groups);
    tiles.iter().for_each(|tile| placement.place(tile).unwrap_or_else(|faults| panic!("{faults:?}")));
    placement.finish()
}

#[track_caller]
fn assert_lies(tile: &Tile, polarization_t: DVec3) {
    let apart_t = (tile.scene_polarization_t() - polarization_t).length();
    assert!(apart_t < 1e-15, "{} instead of {polarization_t}", tile.scene_polarization_t());
}

#[test]
fn film_without_a_tile_is_the_film_as_ordered() {
    let (layout, groups) = measured();
    let empty = placed(&[]);
    assert_eq!(empty, PartlyPlaced { film: layout.bare_tiles(), groups, plan: Vec::new() });
}

/// J follows the tile: as measured, turned over, turned about the upright axis, and both.
#[test]
fn tile_lies_as_its_upper_side_and_its_mark_say() {
    let DVec3 { x, y, z } = MEASURED_T[0];
    for (place, up, mark_deg, polarization_t) in [
        ("east", "+z", 0.0, DVec3::new(x, y, z)),
        ("east", "-z", 0.0, DVec3::new(x, -y, -z)),
        ("west", "+z", 180.0, DVec3::new(-x, -y, z)),
        ("west", "-z", 180.0, DVec3::new(-x, y, -z)),
    ] {
        let partly = placed(&[at(place, "s0", up, mark_deg)]);
        let (index, row) = &partly.plan[0];
        let (film, ordered) = (&partly.film, placed(&[]).film);
        assert_eq!(film[*index].position(), ordered[*index].position());
        assert_lies(&film[*index], polarization_t);
        assert!(film.iter().enumerate().all(|(other, tile)| other == *index || *tile == ordered[other]));
        assert_eq!((row.place.as_str(), row.tile.as_str(), row.up, row.mark), (place, "s0", up, "+x"));
        assert_eq!((row.mark_deg, row.is_placed, row.is_upright()), (mark_deg, true, up == "+z"));
        assert_eq!(row.centre_mm, film[*index].position());
    }
}

#[test]
fn tile_lies_where_it_was_measured_and_turned_as_its_mark() {
    let position_mm = DVec3::new(5.02, -0.01, 0.503);
    // 3 degrees beyond west, counted in three ways, and 3 degrees before it.
    for (mark_deg, from_east_deg) in [(183.0, 183.0), (-177.0, 183.0), (543.0, 183.0), (177.0, 177.0)] {
        let partly = placed(&[FixedTile { position_mm: Some(position_mm), ..at("west", "s1", "+z", mark_deg) }]);
        let tile = &partly.film[1];
        assert_eq!(tile.position(), position_mm);
        assert_lies(tile, DQuat::from_rotation_z(f64::to_radians(from_east_deg)) * MEASURED_T[1]);
        assert_eq!(partly.plan[0].1.mark_deg, from_east_deg);
    }
}

#[test]
fn places_and_tiles_that_are_used_are_not_left() {
    let partly = placed(&[at("west", "s0", "+z", 180.0), at("strip", "t0", "+z", 0.0)]);
    let left: Vec<(Vec<usize>, Vec<&str>)> = (partly.groups.iter())
        .map(|group| (group.places.clone(), group.tiles.iter().map(|tile| tile.name.as_str()).collect()))
        .collect();
    assert_eq!(left, [(vec![0], vec!["s1"]), (vec![], vec![])]);
    assert_eq!(partly.plan.iter().map(|(place, _)| *place).collect::<Vec<_>>(), [1, 2]);
}

#[test]
fn every_rule_that_a_tile_breaks_is_named_and_the_film_stays_as_it_was() {
    let (layout, mut groups) = measured();
    // A shim has a place in the layout, but in no group.
    let is_strip = |group: &&mut PlaceGroup| group.size_mm.y == 1.5;
    let strips = groups.iter_mut().find(is_strip).expect("strips");
    strips.places.clear();
    let mut placement = Placement::new(&layout, &groups);
    placement.place(&at("east", "s0", "+z", 0.0)).expect("a good tile");
    let before = placement.clone().finish();
    for (tile, parts) in [
        (
            at("north", "u0", "+z", 0.0),
            &["place = \"north\", must be the name of a tile", "tile = \"u0\", must be one"][..],
        ),
        (
            at("east", "s0", "+z", 0.0),
            &["place \"east\" already has a tile", "tile \"s0\" is already placed elsewhere"],
        ),
        (at("west", "t0", "+z", 0.0), &["tile \"t0\" is of part 2, place \"west\" of part 1"]),
        (at("strip", "t0", "+z", 0.0), &["place \"strip\" is a shim"]),
        (at("west", "s1", "+z", 134.0), &["must be near: +z at 180, -z at 180 deg"]),
        (at("west", "s1", "+z", 226.0), &["with +z up and its mark at 226 deg, its polarization does not fit"]),
        (at("west", "s1", "+x", 180.0), &["with +x up"]),
        (at("west", "s1", "up", 180.0), &["with up up"]),
        // A position in centimetres.
        (
            FixedTile { position_mm: Some(DVec3::new(-0.5, 0.0, 0.05)), ..at("west", "s1", "+z", 180.0) },
            &["the tile at (-0.5, 0, 0.05) mm is not at place \"west\", whose centre is at"],
        ),
        (FixedTile { position_mm: Some(DVec3::NAN), ..at("west", "s1", "+z", 180.0) }, &["position"]),
    ] {
        let faults = placement.place(&tile).expect_err("a bad tile");
        assert_eq!(faults.len(), parts.len(), "{faults:?}");
        for (fault, part) in faults.iter().zip(parts) {
            assert!(fault.contains(part), "{fault:?} does not contain {part:?}");
        }
        assert_eq!(placement.clone().finish(), before);
    }
    // Just within the largest angle of a mark.
    placement.place(&at("west", "s1", "+z", 136.0)).expect("a good tile");
}

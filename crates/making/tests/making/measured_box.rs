//! Boxes of measured tiles, sorted by the parts of a layout.

use glam::DVec3;
use magsplice_layout::Layout;
use magsplice_making::{MeasuredBox, MeasuredMagnet, MeasuredTile, PlaceGroup};

/// Squares along x and against it, which form one part, a square along z, and a strip.
const LAYOUT: &str = r#"
format = 1
name = "three parts"
[kind.square]
size_mm = [3, 3, 1]
[kind.any]
size_mm = [3, 3, 1]
[[tile]]
name = "a"
kind = "square"
position_mm = [0, 0, 0.5]
polarization_t = [0.1, 0, 0]
[[tile]]
name = "b"
kind = "any"
position_mm = [5, 0, 0.5]
polarization_t = [-0.1, 0, 0]
[[tile]]
name = "strip"
position_mm = [10, 0, 0.5]
size_mm = [3, 1.5, 1]
polarization_t = [0, 0, 0.1]
[[tile]]
name = "thick"
kind = "any"
position_mm = [15, 0, 0.5]
polarization_t = [0, 0, 0.1]
"#;

fn layout() -> Layout {
    Layout::parse(LAYOUT, "parts.toml").unwrap_or_else(|e| panic!("{e}"))
}

fn tile(name: &str) -> MeasuredTile<'_> {
    MeasuredTile { name, part: Some("a"), size_mm: None, magnet: MeasuredMagnet::Strength(0.1) }
}

/// The rules broken by a tile in a box that contains the tile "t1".
fn faults(tile: &MeasuredTile) -> Vec<String> {
    let layout = layout();
    let mut measured = MeasuredBox::new(&layout);
    measured.add(&self::tile("t1")).expect("a good tile");
    let faults = measured.add(tile).expect_err("a bad tile");
    assert_eq!(measured.tile_count(), 1, "a tile that is refused is not in the box");
    faults
}

#[track_caller]
fn assert_refused(tile: &MeasuredTile, parts: &[&str]) {
    let faults = faults(tile);
    assert_eq!(faults.len(), parts.len(), "{faults:?}");
    for (fault, part) in faults.iter().zip(parts) {
        assert!(fault.contains(part), "{fault:?} does not contain {part:?}");
    }
}

/// The index of the part to which a tile is added.
fn part_of(tile: &MeasuredTile) -> Option<usize> {
    let layout = layout();
    let mut measured = MeasuredBox::new(&layout);
    measured.add(tile).ok()?;
    measured.into_groups().iter().position(|group| !group.tiles.is_empty())
}

#[test]
fn groups_are_the_parts_of_the_layout_with_their_places() {
    let layout = layout();
    let groups = PlaceGroup::from_layout(&layout);
    let places: Vec<&[usize]> = groups.iter().map(|group| group.places.as_slice()).collect();
    assert_eq!(places.len(), 3);
    assert_eq!(places, layout.parts().iter().map(|part| part.tiles.as_slice()).collect::<Vec<_>>());
    for (group, part) in groups.iter().zip(layout.parts()) {
        assert_eq!(group.size_mm, part.size_mm);
        // Strengths of parts have nine digits.
        assert!((group.polarization_t.length() - 0.1).abs() < 1e-9);
        assert!(group.tiles.is_empty());
    }
    assert_eq!(PlaceGroup::from_layout(&layout), MeasuredBox::new(&layout).into_groups());
}

/// A part is identified by its number from 1, the name of a tile, the name of a kind of one part,
/// or its sizes.
#[test]
fn part_is_told_by_number_name_kind_or_sizes() {
    let layout = layout();
    let of_tile = |name: &str| {
        let index = layout.tiles.iter().position(|named| named.name == name).expect("a tile");
        layout.parts().iter().position(|part| part.tiles.contains(&index))
    };
    let named = |part| part_of(&MeasuredTile { part: Some(part), ..tile("t") });
    for (number, part) in ["1", "2", "3"].into_iter().enumerate() {
        assert_eq!(named(part), Some(number));
    }
    assert_eq!(named("b"), of_tile("b"));
    assert_eq!(named("thick"), of_tile("thick"));
    assert_eq!(named("square"), of_tile("a"));
    for unknown in ["0", "4", "any", "none", ""] {
        assert_refused(
            &MeasuredTile { part: Some(unknown), ..tile("t") },
            &[&format!("part = \"{unknown}\", must be a number from 1 to 3")],
        );
    }
    let sized = |size_mm| MeasuredTile { part: None, size_mm: Some(size_mm), ..tile("t") };
    for size_mm in [DVec3::new(3.02, 1.49, 1.01), DVec3::new(3.2, 1.4, 0.9)] {
        assert_eq!(part_of(&sized(size_mm)), of_tile("strip"));
    }
    // A gauge for two sides.
    assert_eq!(part_of(&sized(DVec3::new(3.02, 1.49, f64::NAN))), of_tile("strip"));
    // Squares belong to two parts, one strip is between two parts, and two tiles are far from all.
    for size_mm in
        [DVec3::new(3.0, 3.0, 1.0), DVec3::new(3.0, 2.2, 1.0), DVec3::new(9.0, 1.5, 1.0), DVec3::new(3.0, 0.2, 1.0)]
    {
        assert_refused(&sized(size_mm), &["fit no single part"]);
    }
    assert_refused(&MeasuredTile { part: None, ..tile("t") }, &["has no part, must have the number of one"]);
}

#[test]
fn only_part_needs_no_name() {
    let one = LAYOUT.split("[[tile]]\nname = \"b\"").next().expect("a beginning");
    let layout = Layout::parse(one, "one.toml").unwrap_or_else(|e| panic!("{e}"));
    let mut measured = MeasuredBox::new(&layout);
    measured.add(&MeasuredTile { part: None, ..tile("t") }).expect("a good tile");
    assert_eq!(measured.tile_count(), 1);
}

#[test]
fn names_are_there_short_free_and_printable() {
    assert_refused(&tile(""), &["has no name"]);
    assert_refused(&tile("t1"), &["tile \"t1\" is already in the box"]);
    assert_refused(&tile("a\tb"), &["has control characters"]);
    let longest = "n".repeat(200);
    assert_eq!(part_of(&tile(&longest)), part_of(&tile("t")));
    assert_refused(&tile(&(longest + "n")), &["has 201 bytes, must have at most 200"]);
}

/// Both bounds of sides, strengths and angles, from both sides.
#[test]
fn measured_numbers_are_near_what_was_ordered() {
    let sized = |x| MeasuredTile { size_mm: Some(DVec3::new(x, 3.0, 1.0)), ..tile("t") };
    for good in [1.51, 5.99] {
        assert!(part_of(&sized(good)).is_some(), "{good}");
    }
    assert!(part_of(&sized(f64::NAN)).is_some(), "a side that was not measured");
    for bad in [1.49, 6.01] {
        assert_refused(&sized(bad), &[&format!("the first side is {bad} mm, must be within 0.5 to 2 times the 3 mm")]);
    }
    assert_refused(
        &MeasuredTile { size_mm: Some(DVec3::new(9.0, 3.0, 0.1)), ..tile("t") },
        &["the first side is 9 mm", "the third side is 0.1 mm"],
    );
    let strong = |strength_t| MeasuredTile { magnet: MeasuredMagnet::Strength(strength_t), ..tile("t") };
    for good in [0.0501, 0.1999] {
        assert!(part_of(&strong(good)).is_some(), "{good}");
    }
    for bad in [0.0499, 0.2001] {
        assert_refused(&strong(bad), &[&format!("its polarization is {bad} T, must be within 0.5 to 2 times")]);
    }
    let turned = |deg: f64| {
        let direction = DVec3::new(deg.to_radians().cos(), 0.0, deg.to_radians().sin());
        MeasuredTile { magnet: MeasuredMagnet::Polarization(0.1 * direction), ..tile("t") }
    };
    assert!(part_of(&turned(44.9)).is_some());
    assert_refused(&turned(45.2), &["its polarization is 45.2 deg from the polarization of part"]);
    // 45 deg, with nine decimals: 4e-7 deg short of it.
    let rounded_t = MeasuredMagnet::Polarization(DVec3::new(0.070710679, 0.0, 0.070710678));
    assert_refused(&MeasuredTile { magnet: rounded_t, ..tile("t") }, &["its polarization is 45.0 deg from"]);
}

/// J = mu0 m / V with the measured sides; 0.1 T in 3 x 3 x 1 mm are 7.16e-4 A m2.
#[test]
fn moment_and_polarization_and_strength_are_the_same_tile() {
    let layout = layout();
    let size_mm = DVec3::new(3.03, 2.98, 1.01);
    let j_t = DVec3::new(0.098, 0.001, -0.002);
    let mu_0 = 4e-7 * std::f64::consts::PI;
    let moment = j_t * (size_mm.x * size_mm.y * size_mm.z * 1e-9 / mu_0);
    let mut measured = MeasuredBox::new(&layout);
    assert!(!measured.has_sizes());
    measured.add(&tile("by strength")).expect("a good tile");
    assert!(!measured.has_sizes());
    for (name, magnet) in
        [("by polarization", MeasuredMagnet::Polarization(j_t)), ("by moment", MeasuredMagnet::Moment(moment))]
    {
        measured.add(&MeasuredTile { size_mm: Some(size_mm), magnet, ..tile(name) }).expect("a good tile");
    }
    assert!(measured.has_sizes());
    assert_eq!(measured.tile_count(), 3);
    let groups = measured.into_groups();
    let tiles: Vec<_> = groups.iter().flat_map(|group| &group.tiles).collect();
    assert_eq!(
        tiles.iter().map(|tile| tile.name.as_str()).collect::<Vec<_>>(),
        ["by strength", "by polarization", "by moment"]
    );
    assert_eq!(tiles[0].size_mm, DVec3::new(3.0, 3.0, 1.0));
    assert_eq!(tiles[0].polarization_t, DVec3::new(0.1, 0.0, 0.0));
    assert_eq!(tiles[1].polarization_t, j_t);
    assert_eq!(tiles[1].size_mm, size_mm);
    // mu0 as measured is 4 pi 1e-7 to ten digits.
    assert!((tiles[2].polarization_t - j_t).length() < 1e-9 * j_t.length());
}

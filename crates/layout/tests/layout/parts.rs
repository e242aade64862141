//! The bill of materials.

use glam::DVec3;
use magsplice_layout::{Layout, Part};

fn parts(tiles: &str) -> Vec<Part> {
    let text = format!("format = 1\nname = \"test\"\n{tiles}");
    Layout::parse(&text, "test").unwrap_or_else(|e| panic!("{e}")).parts()
}

fn tile(place: i32, size: &str, polarization: &str) -> String {
    format!("[[tile]]\nposition_mm = [{place}, 0, 0]\nsize_mm = [{size}]\npolarization_t = [{polarization}]\n")
}

#[test]
fn rotated_tiles_are_one_part() {
    let same = [tile(0, "3, 2, 1", "0.1, 0, 0"), tile(9, "2, 3, 1", "0, -0.1, 0"), tile(18, "1, 2, 3", "0, 0, 0.1")];
    let found = parts(&same.concat());
    assert_eq!(found.len(), 1, "{found:?}");
    let Part { count, size_mm, strength_t, direction, example, tiles } = &found[0];
    assert_eq!(tiles[..], [0, 1, 2]);
    assert_eq!((*count, *size_mm, *strength_t), (3, DVec3::new(3.0, 2.0, 1.0), 0.1));
    assert_eq!((*direction, example.as_str()), (DVec3::X, "tile-1"));
}

#[test]
fn parts_differ_by_size_strength_direction_and_handedness() {
    let others = [
        tile(0, "3, 2, 1", "0.1, 0, 0"),
        tile(9, "3, 2, 1", "0, 0.1, 0"),
        tile(18, "3, 2, 1", "0.2, 0, 0"),
        tile(27, "3, 2, 1.5", "0.1, 0, 0"),
        tile(36, "3, 2, 1", "0.1, 0.2, 0.3"),
        tile(45, "3, 2, 1", "0.1, 0.2, -0.3"),
        tile(54, "3, 2, 1", "0, 0, 0"),
    ];
    assert_eq!(parts(&others.concat()).len(), others.len());
    // A cuboid polarized in a plane of symmetry is its own mirror image.
    assert_eq!(parts(&[tile(0, "3, 2, 1", "1, 2, 0"), tile(9, "3, 2, 1", "1, -2, 0")].concat()).len(), 1);
}

#[test]
fn round_off_does_not_make_new_parts() {
    let near = [tile(0, "3.3, 1, 1", "0.3, 0, 0"), tile(9, "3.3000000000000003, 1, 1", "0.30000000000000004, 0, 0")];
    assert_eq!(parts(&near.concat()).len(), 1);
    let tiny = [tile(0, "1e-20, 1e-20, 1e-20", "1e-200, 0, 0"), tile(9, "2e-20, 1e-20, 1e-20", "1e-200, 0, 0")];
    assert_eq!(parts(&tiny.concat()).len(), 2);
}

#[test]
fn parts_without_polarization_have_strength_0() {
    let found = parts(&tile(0, "3, 2, 1", "0, 0, 0"));
    assert_eq!((found[0].strength_t, found[0].direction), (0.0, DVec3::ZERO));
}

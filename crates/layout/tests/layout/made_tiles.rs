//! Layouts of films that were made.

use glam::{DQuat, DVec3};
use magsplice_layout::{Layout, NamedTile};
use magsplice_magnet::Tile;

/// Two tiles of a kind side by side, with requirements and a brief.
const ORDERED: &str = r#"
format = 1
name = "pair"
[ideal]
wavelength_mm = 10.0
thickness_mm = 1.0
amplitude_t = 0.12
[volume]
x_mm = [-1.0, 1.0]
y_mm = [-1.0, 1.0]
z_mm = [-5.0, -4.0]
step_mm = 0.5
[expect]
clearance_mm = { min = 3.0 }
[design]
vary = ["direction"]
[kind.square]
size_mm = [2, 2, 1]
[[tile]]
name = "left"
kind = "square"
position_mm = [-1, 0, 0.5]
polarization_t = [0.1, 0, 0]
[[tile]]
name = "right"
kind = "square"
position_mm = [1, 0, 0.5]
rotation = { axis = [0, 0, 1], angle_deg = 90 }
polarization_t = [0.1, 0, 0]
"#;

fn ordered() -> Layout {
    Layout::parse(ORDERED, "pair.toml").unwrap_or_else(|e| panic!("{e}"))
}

fn written_and_read(layout: &Layout) -> Layout {
    Layout::parse(&layout.to_toml(), "written.toml").unwrap_or_else(|e| panic!("{e}\n{}", layout.to_toml()))
}

#[test]
fn film_made_as_ordered_keeps_all_but_requirements_and_brief() {
    let ordered = ordered();
    assert!(ordered.brief.is_some() && ordered.expectations.least_clearance_mm.is_some());
    let made = ordered.clone().with_made_tiles(&ordered.bare_tiles());
    assert_eq!(made.tiles, ordered.tiles);
    assert_eq!(made.overlap_mm, 0.0);
    assert!(made.brief.is_none() && made.expectations.least_clearance_mm.is_none());
    assert_eq!(made.volume, ordered.volume);
}

/// A tile of another size is no longer of its kind; the rotation is written as that of the tile is,
/// and the layout that is read back has the same tiles.
#[test]
fn tiles_as_made_are_read_back_with_their_numbers() {
    let ordered = ordered();
    let [left, right] = ordered.bare_tiles()[..] else { panic!("two tiles") };
    let larger = Tile::new(left.position(), DVec3::new(2.01, 1.98, 1.0), DVec3::new(0.097, 0.002, -0.001)).unwrap();
    let unturned = Tile::new(right.position(), right.size(), right.polarization_t()).unwrap();
    let turned = unturned.rotated(DQuat::from_rotation_z(1.6)).unwrap();
    for (made_right, is_rotated) in [(turned, true), (unturned, false)] {
        let made = ordered.clone().with_made_tiles(&[larger, made_right]);
        let names: Vec<&str> = made.tiles.iter().map(|tile| tile.name.as_str()).collect();
        assert_eq!(names, ["left", "right"]);
        assert!(made.tiles.iter().all(|tile| tile.kind.is_none()));
        assert_eq!(made.tiles[0], NamedTile { tile: larger, kind: None, ..ordered.tiles[0].clone() });
        assert_eq!(made.tiles[1].rotation.is_some(), is_rotated);
        let apart = made.tiles[1].tile.rotation().angle_between(made_right.rotation());
        // The arc cosine of the scalar product loses half of the digits.
        assert!(apart < 1e-7, "turned by {apart}");
        assert_eq!(written_and_read(&made).bare_tiles(), made.bare_tiles());
    }
}

/// Only the depth of an overlap that the tiles have is allowed, in whole micrometres.
#[test]
fn overlap_of_tiles_as_made_is_allowed_to_the_next_micrometre() {
    let ordered = ordered();
    let mut tiles = ordered.bare_tiles();
    let DVec3 { y, z, .. } = tiles[0].position();
    tiles[0] = Tile::new(DVec3::new(-0.9873, y, z), tiles[0].size(), tiles[0].polarization_t()).unwrap();
    let made = ordered.clone().with_made_tiles(&tiles);
    assert_eq!(made.overlap_mm, 0.013, "the tiles overlap by 0.0127 mm");
    assert_eq!(written_and_read(&made).bare_tiles(), tiles);
    // What the layout allowed before is not taken back.
    let looser = Layout { overlap_mm: 0.02, ..ordered };
    assert_eq!(looser.with_made_tiles(&tiles).overlap_mm, 0.02);
}

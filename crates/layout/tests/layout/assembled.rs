//! Layouts whose tiles are moved, turned, selected or joined.

use glam::{DQuat, DVec3};
use magsplice_layout::{Layout, Rotation};
use magsplice_magnet::{Permeability, Tile};

const PAD: &str = r#"
format = 1
name = "pad"
[volume]
x_mm = [-1.0, 1.0]
y_mm = [-1.0, 1.0]
z_mm = [-5.0, -4.0]
step_mm = 0.5
[expect]
clearance_mm = { min = 3.0 }
[tolerance]
position_mm = 0.1
[[tolerance.group]]
name = "row"
tiles = ["right"]
size_mm = 0.2
[[tile]]
name = "left"
position_mm = [-1.1, 0.2, 0.5]
size_mm = [2, 1, 0.5]
polarization_t = [0.1, 0.02, 0.03]
[[tile]]
name = "right"
position_mm = [1.3, 0, 0.5]
size_mm = [2, 1, 0.5]
rotation = { axis = [1, 2, 3], angle_deg = 20 }
polarization_t = [0.1, 0, 0]
recoil_permeability = 1.05
"#;

fn pad() -> Layout {
    Layout::parse(PAD, "pad.toml").unwrap_or_else(|e| panic!("{e}"))
}

/// The layout as it is read back from its text.
fn read_back(layout: &Layout) -> Layout {
    Layout::parse(&layout.to_toml(), "again").unwrap_or_else(|e| panic!("{e}"))
}

/// Whether two tiles are the same body: their corners, each with the others' permutation, and J.
fn are_same(one: &Tile, other: &Tile) -> bool {
    let corners = |tile: &Tile| -> Vec<DVec3> {
        let signs = [-0.5, 0.5];
        let corner = |x, y, z| tile.position() + tile.rotation() * (DVec3::new(x, y, z) * tile.size());
        signs.iter().flat_map(|&x| signs.iter().flat_map(move |&y| signs.map(|z| corner(x, y, z)))).collect()
    };
    let of_other = corners(other);
    let has = |corner: &DVec3| of_other.iter().any(|of| (*of - *corner).length() < 1e-9);
    corners(one).iter().all(has) && (one.scene_polarization_t() - other.scene_polarization_t()).length() < 1e-12
}

#[test]
fn moved_tiles_keep_all_but_their_position() {
    let moved = read_back(&pad().moved(DVec3::new(0.1, 0.2, -8.0)).unwrap());
    assert_eq!(moved.tiles[0].tile.position(), DVec3::new(-1.0, 0.4, -7.5));
    for (moved, before) in moved.tiles.iter().zip(&pad().tiles) {
        assert_eq!(moved.tile.rotation(), before.tile.rotation());
        assert_eq!((moved.permeability, &moved.name), (before.permeability, &before.name));
    }
    assert_eq!(moved.volume, pad().volume);
    assert_eq!(moved.expectations.least_clearance_mm, None);
    let designed = Layout { brief: Some(Default::default()), ..pad() };
    assert_eq!(designed.moved(DVec3::ZERO).unwrap().brief, None);
    assert!(pad().moved(DVec3::new(f64::INFINITY, 0.0, 0.0)).is_err());
}

#[test]
fn turned_tiles_are_turned_bodies() {
    let about = DVec3::new(1.0, -2.0, 3.0);
    for (axis, angle_deg) in
        [([1.0, 0.0, 0.0], 180.0), ([0.0, 0.0, 1.0], 90.0), ([1.0, 1.0, 1.0], -120.0), ([1.0, 2.0, -1.0], 33.0)]
    {
        let rotation = Rotation::AxisAngle { axis, angle_deg };
        let turned = read_back(&pad().rotated(rotation, about).unwrap());
        let turn = DQuat::from_axis_angle(DVec3::from(axis).normalize(), f64::to_radians(angle_deg));
        for (turned, before) in turned.tiles.iter().zip(&pad().tiles) {
            let tile = before.tile;
            let position = about + turn * (tile.position() - about);
            let expected = Tile::new(position, tile.size(), tile.polarization_t())
                .unwrap()
                .rotated((turn * tile.rotation()).normalize())
                .unwrap();
            assert!(are_same(&turned.tile, &expected), "{axis:?} {angle_deg}: {:?}", turned.tile);
        }
        // Quarter turns keep edges along the axes.
        let is_along_axes = turned.tiles[0].tile.rotation() == DQuat::IDENTITY;
        assert_eq!(is_along_axes, angle_deg != 33.0);
    }
}

/// Tiles that touch still touch after turns and moves, as the round-off of their positions is that
/// of the turn.
#[test]
fn turned_films_do_not_overlap() {
    for text in [
        include_str!("../../../../layouts/published-film.toml"),
        include_str!("../../../../layouts/designed-tilted.toml"),
    ] {
        let film = Layout::parse(text, "film").unwrap_or_else(|error| panic!("{error}"));
        for (axis, angle_deg) in [([0.0, 0.0, 1.0], 30.0), ([1.0, -2.0, 0.3], 77.7)] {
            let turned =
                film.clone().rotated(Rotation::AxisAngle { axis, angle_deg }, DVec3::new(3.3, 0.1, -20.0)).unwrap();
            read_back(&read_back(&turned).moved(DVec3::new(0.7, -33.3, 1.0 / 3.0)).unwrap());
        }
    }
}

/// Iron moves and turns with the tiles: the film keeps its field.
#[test]
fn iron_moves_with_the_tiles() {
    let plate = pad().to_toml() + "[[plane]]\npoint_mm = [0, 0, 20]\nnormal = [0, 0, -1]\nrelative_permeability = 50\n";
    let film = Layout::parse(&plate, "plate").unwrap_or_else(|error| panic!("{error}"));
    let half_turn = Rotation::AxisAngle { axis: [1.0, 0.0, 0.0], angle_deg: 180.0 };
    let moved = read_back(&film.rotated(half_turn, DVec3::ZERO).unwrap().moved(DVec3::new(1.0, 2.0, -3.0)).unwrap());
    let plane = moved.iron.planes()[0];
    assert_eq!((plane.point(), plane.normal()), (DVec3::new(1.0, 2.0, -23.0), DVec3::Z));
    assert_eq!(plane.relative_permeability(), 50.0);
}

#[test]
fn selected_tiles_keep_their_errors() {
    let one = read_back(&pad().with_selected_tiles(&[1]));
    assert_eq!(one.tiles, pad().tiles[1..]);
    let tolerance = one.tolerance.unwrap();
    assert_eq!((tolerance.tiles.len(), &tolerance.groups[0].tiles[..]), (1, &[0][..]));
    let other = read_back(&pad().with_selected_tiles(&[0]));
    assert!(other.tolerance.unwrap().groups.is_empty());
}

#[test]
fn joined_layouts_have_the_tiles_of_both() {
    let mut rigid = pad().moved(DVec3::new(0.0, 0.0, -8.0)).unwrap();
    rigid.tolerance = None;
    let mut first = pad();
    first.material.permeability = Permeability::isotropic(1.1).unwrap();
    let both = read_back(&first.clone().joined(&rigid));
    let names: Vec<&str> = both.tiles.iter().map(|named| &named.name[..]).collect();
    assert_eq!(names, ["left", "right", "left-2", "right-2"]);
    let expected = [first.permeabilities(), rigid.permeabilities()].concat();
    assert_eq!(both.permeabilities(), expected);
    let tolerance = both.tolerance.unwrap();
    assert_eq!(tolerance.tiles[..2], first.tolerance.clone().unwrap().tiles[..]);
    assert_eq!(tolerance.tiles[2..], vec![Default::default(); 2]);
    // With errors of both, each group has its own tiles.
    let above = pad().moved(DVec3::new(0.0, 0.0, 4.0)).unwrap();
    let tolerance = read_back(&pad().joined(&above)).tolerance.unwrap();
    let groups: Vec<_> = tolerance.groups.iter().map(|group| (&group.name[..], &group.tiles[..])).collect();
    assert_eq!(groups, [("row", &[1][..]), ("row-2", &[3][..])]);
    // Tiles that overlap are refused where the layout is read.
    assert!(Layout::parse(&pad().joined(&pad()).to_toml(), "pair").is_err());
}

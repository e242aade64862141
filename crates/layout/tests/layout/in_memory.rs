//! Layouts that were made in memory.

use glam::{DQuat, DVec3};
use magsplice_ideal::IdealFilm;
use magsplice_layout::{Brief, FilmTolerance, Layout, LayoutError, NamedTile, TileForm, WorkingVolume};
use magsplice_magnet::Tile;

const WRITTEN: &str = "format = 1\nname = \"film\"\n\
    [ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.12\n\
    [volume]\nx_mm = [-2, 2]\ny_mm = [-1, 1]\nz_mm = [-5, -3]\nstep_mm = [0.5, 0.5, 1]\nreference_mm = [0, 0, -5]\n\
    [[tile]]\nname = \"a\"\nposition_mm = [0, 0, 0.5]\nsize_mm = [2, 2, 1]\npolarization_t = [0.1, 0, 0]\n";

fn volume() -> WorkingVolume {
    let [lower, upper] = [DVec3::new(-2.0, -1.0, -5.0), DVec3::new(2.0, 1.0, -3.0)];
    WorkingVolume::new(lower, upper, DVec3::new(0.5, 0.5, 1.0), DVec3::new(0.0, 0.0, -5.0)).expect("a volume")
}

#[test]
fn layout_from_parts_equals_the_same_layout_read() {
    let read = Layout::parse(WRITTEN, "film").unwrap_or_else(|e| panic!("{e}"));
    let tile = Tile::new(DVec3::new(0.0, 0.0, 0.5), DVec3::new(2.0, 2.0, 1.0), DVec3::new(0.1, 0.0, 0.0));
    let made = Layout {
        name: "film".to_owned(),
        ideal: Some(IdealFilm::new(10.0, 1.0, 0.12).expect("a film")),
        volume: Some(volume()),
        tiles: vec![NamedTile::new("a", tile.expect("a tile"))],
        ..Layout::default()
    };
    let made = made.checked("made").unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((made.ideal, made.volume, &made.tiles), (read.ideal, read.volume, &read.tiles));
    assert_eq!(made.to_toml(), read.to_toml());
}

#[test]
fn turned_tile_is_written_with_its_rotation() {
    let turn = DQuat::from_rotation_z(0.5);
    let tile = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::X).and_then(|tile| tile.rotated(turn)).expect("a tile");
    let layout = Layout { tiles: vec![NamedTile::new("a", tile)], ..Layout::default() };
    assert_eq!(layout.checked("made").unwrap_or_else(|e| panic!("{e}")).tiles[0].tile, tile);
}

#[test]
fn broken_rules_of_parts_are_named() {
    let faults = WorkingVolume::new(DVec3::ZERO, DVec3::new(1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0), DVec3::NAN);
    let faults: Vec<String> = faults.expect_err("faults").iter().map(ToString::to_string).collect();
    assert_eq!(
        faults,
        [
            "volume: y_mm = [0, -1] is inverted, the first must not be greater than the second",
            "volume: step_mm[2] = 0, must be a finite number greater than 0",
            "volume: reference_mm = [NaN, NaN, NaN], must be three finite numbers",
        ]
    );
    assert!(Layout::default().checked("nothing").is_err_and(|error| error.to_string().contains("has no tiles")));
}

/// The integers of TOML have a sign.
#[test]
fn seeds_that_no_file_can_express_are_refused() {
    let read = Layout::parse(WRITTEN, "film").unwrap_or_else(|e| panic!("{e}"));
    let seeded = |seed| Layout { brief: Some(Brief { seed, ..Brief::default() }), ..read.clone() };
    let refused = |found: Result<(), LayoutError>| found.expect_err("a seed that is too large").to_string();
    let large = seeded(1 << 63);
    let message = "made: [design]: seed = 9223372036854775808, must be at most 9223372036854775807";
    assert_eq!(refused(large.checked("made").map(|_| ())), message);
    assert_eq!(refused(large.to_edited_toml(TileForm::Compact, "", "made").map(|_| ())), message);
    let tolerance = FilmTolerance { seed: u64::MAX, ..FilmTolerance::default() };
    let both = Layout { tolerance: Some(tolerance), ..large };
    assert_eq!(refused(both.checked("made").map(|_| ())).lines().count(), 2);
    assert!(!refused(seeded(i64::MAX as u64).checked("made").map(|_| ())).contains("seed"));
}

#[test]
fn fingerprint_depends_on_what_samples_depend_on() {
    let film = |change: [&str; 2]| {
        let text = format!("{WRITTEN}[tolerance]\nposition_mm = 0.05\nsamples = 100\n").replace(change[0], change[1]);
        Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}")).sample_fingerprint(&())
    };
    let own = film(["", ""]);
    assert_eq!((own.len(), own.chars().all(|c| c.is_ascii_hexdigit())), (64, true));
    for same in [["\"a\"", "\"b\""], ["\"film\"", "\"other\""], ["samples = 100", "seed = 2"]] {
        assert_eq!(film(same), own, "{same:?}");
    }
    for other in [["0.05", "0.06"], ["0.12", "0.13"], ["z_mm = [-5,", "z_mm = [-6,"], ["[0.1, 0, 0]", "[0.1, 0.1, 0]"]]
    {
        assert_ne!(film(other), own, "{other:?}");
    }
}

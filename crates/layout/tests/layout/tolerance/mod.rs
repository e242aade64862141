//! `[tolerance]` and `[expect.made]`: what a table means, and each rule where it is just broken.

use std::fmt::Write;
use std::fs;

/// Its rules, each where it is just broken.
mod rules;
/// Writing it, and files beside the layout.
mod writing;

use glam::DVec3;
use magsplice_layout::{
    CommonErrors, Distribution, ErrorGroup, FigureBounds, FilmTolerance, Finding, Layout, MadeExpectations, Preset,
    SensorErrors, StrayField, Temperature, TileErrors,
};

const HEAD: &str = "format = 1\nname = \"test\"\n";
const IDEAL: &str = "[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.12\n";
const VOLUME: &str = "[volume]\nx_mm = [-2, 2]\ny_mm = [-2, 2]\nz_mm = [-5, -3]\nstep_mm = 0.5\n";
/// Eight tiles of two kinds in two rows along x: four square ones and four bars.
const TILES: &str = "[kind.square]\nsize_mm = [3, 3, 1]\nstrength_t = 0.12\n\
    [kind.bar]\nsize_mm = [2, 4, 1.5]\nstrength_t = 0.12\n\
    [[tile]]\nname = \"corner\"\nkind = \"square\"\nposition_mm = [2, 4, 0.5]\ndirection = [1, 1, 0]\nmirror = { axes = [\"x\", \"y\"] }\n\
    [[tile]]\nname = \"bar\"\nkind = \"bar\"\nposition_mm = [6, 4, 0.75]\ndirection = [1, 0, 0]\nmirror = { axes = [\"x\", \"y\"] }\n";

/// The text of a layout; lines 1 to 12 are its head, ideal film and volume, and [tolerance] is line
/// 13 if `tables` begins with it.
fn text(tables: &str) -> String {
    format!("{HEAD}{IDEAL}{VOLUME}{}\n{tables}\n{TILES}", "")
}

fn parse(tables: &str) -> Result<Layout, String> {
    Layout::parse(&text(tables), "test.toml").map_err(|error| error.to_string())
}

fn tolerance(tables: &str) -> FilmTolerance {
    parse(tables).unwrap_or_else(|e| panic!("{tables}: {e}")).tolerance.expect("a table [tolerance]")
}

/// The errors of the tile with this name.
fn of_tile(tables: &str, name: &str) -> TileErrors {
    let layout = parse(tables).unwrap_or_else(|e| panic!("{tables}: {e}"));
    let index = layout.tiles.iter().position(|tile| tile.name == name).expect("a tile");
    layout.tolerance.expect("a table [tolerance]").tiles[index].clone()
}

fn normal<const N: usize>(deviations: [f64; N]) -> [Distribution; N] {
    deviations.map(Distribution::normal)
}

fn degrees<const N: usize>(deviations: [f64; N]) -> [Distribution; N] {
    normal(deviations.map(f64::to_radians))
}

#[test]
fn plain_numbers_are_standard_deviations_of_each_tile() {
    let found = tolerance(
        "[tolerance]\nposition_mm = [0.05, 0.06, 0]\nrotation_deg = 0.5\nsize_mm = 0.02\nstrength = 0.01\n\
         direction_deg = [1, 2]\nsamples = 2000\nseed = 7",
    );
    let errors = TileErrors {
        position: normal([0.05, 0.06, 0.0]),
        rotation: degrees([0.5; 3]),
        size: normal([0.02; 3]),
        strength: Distribution::Normal { deviation: 0.01 },
        direction: degrees([1.0, 2.0]),
    };
    let wanted = FilmTolerance { samples: 2000, seed: 7, ..FilmTolerance::of_tiles(&errors, 8) };
    assert_eq!(found, wanted);
    let defaults = tolerance("[tolerance]\nstrength = 0.01");
    assert_eq!((defaults.samples, defaults.seed), (1000, 1));
    assert!(parse("").expect("no tolerance").tolerance.is_none());
}

#[test]
fn presets_have_their_numbers_and_keys_replace_them() {
    for (preset, wanted) in
        [("workshop", Preset::Workshop.errors()), ("by-hand", Preset::ByHand.errors()), ("jig", Preset::Jig.errors())]
    {
        assert_eq!(tolerance(&format!("[tolerance]\npreset = \"{preset}\"")), FilmTolerance::of_tiles(&wanted, 8));
    }
    let replaced = TileErrors { strength: Distribution::normal(0.02), ..Preset::Workshop.errors() };
    let found = tolerance("[tolerance]\npreset = \"workshop\"\nstrength = 0.02");
    assert_eq!(found, FilmTolerance::of_tiles(&replaced, 8));
    // The numbers of the documentation.
    let hand = Preset::ByHand.errors();
    assert_eq!((hand.position, hand.rotation), (normal([0.15; 3]), degrees([1.5; 3])));
    assert_eq!((hand.size, hand.strength), (normal([0.05; 3]), Distribution::normal(0.03)));
    assert_eq!(hand.direction, degrees([2.0; 2]));
    let jig = Preset::Jig.errors();
    assert_eq!((jig.position, jig.rotation), (normal([0.02; 3]), degrees([0.2; 3])));
    assert_eq!((jig.size, jig.strength), (normal([0.02; 3]), Distribution::normal(0.01)));
    assert_eq!(jig.direction, degrees([1.0; 2]));
    let message = parse("[tolerance]\npreset = \"workshp\"").expect_err("unknown");
    assert!(message.contains("did you mean \"workshop\"?"), "{message}");
}

#[test]
fn tables_give_other_distributions() {
    for (written, wanted) in [
        ("{ normal = 0.05 }", Distribution::Normal { deviation: 0.05 }),
        ("{ normal = 0.05, within = 0.1 }", Distribution::Truncated { deviation: 0.05, limit: 0.1 }),
        // The nearest limit is a hundredth of the deviation.
        ("{ normal = 0.05, within = 0.0006 }", Distribution::Truncated { deviation: 0.05, limit: 0.0006 }),
        ("{ uniform = 0.1 }", Distribution::Uniform { half_width: 0.1 }),
        ("{ fixed = -0.1 }", Distribution::Fixed(-0.1)),
        ("{ values = [0.2, -0.1, 0, 0] }", Distribution::Tabulated([-0.1, 0.0, 0.0, 0.2].into())),
        ("0", Distribution::NONE),
        ("{ uniform = 0 }", Distribution::NONE),
        ("{ fixed = 0 }", Distribution::NONE),
    ] {
        let table = format!("[tolerance]\nstrength = 0.1\nposition_mm = [0, {written}, 0]");
        assert_eq!(of_tile(&table, "bar").position[1], wanted, "{written}");
        let table = format!("[tolerance]\nstrength = 0.1\nposition_mm = {written}");
        assert_eq!(of_tile(&table, "bar").position, [wanted.clone(), wanted.clone(), wanted], "{written}");
    }
    let turned = of_tile("[tolerance]\nrotation_deg = [0, 0, { normal = 1, within = 2 }]", "bar").rotation;
    let radians = [1.0_f64, 2.0].map(f64::to_radians);
    assert_eq!(turned[2], Distribution::Truncated { deviation: radians[0], limit: radians[1] });
}

#[test]
fn kinds_and_names_replace_errors_key_by_key() {
    let table = "[tolerance]\nposition_mm = 0.05\nstrength = 0.01\n\
        [tolerance.kind.square]\nstrength = 0.02\n\
        [[tolerance.tile]]\ntiles = [\"corner*\", \"bar\"]\nposition_mm = 0.1\n\
        [[tolerance.tile]]\ntiles = [\"*-mx-my\"]\nposition_mm = 0.2\nstrength = 0\n";
    for (tile, position_mm, strength) in [
        ("corner", 0.1, 0.02),
        ("corner-mx", 0.1, 0.02),
        ("corner-mx-my", 0.2, 0.0),
        ("bar", 0.1, 0.01),
        ("bar-mx", 0.05, 0.01),
        ("bar-mx-my", 0.2, 0.0),
    ] {
        let found = of_tile(table, tile);
        assert_eq!(found.position, normal([position_mm; 3]), "{tile}");
        assert_eq!(found.strength, Distribution::normal(strength), "{tile}");
    }
}

/// The names of groups, and those of their tiles.
fn groups(tables: &str) -> Vec<(String, String)> {
    let layout = parse(tables).unwrap_or_else(|e| panic!("{tables}: {e}"));
    let names = |group: &ErrorGroup| {
        let names: Vec<&str> = group.tiles.iter().map(|&index| layout.tiles[index].name.as_str()).collect();
        (group.name.clone(), names.join(" "))
    };
    layout.tolerance.as_ref().expect("stated").groups.iter().map(names).collect()
}

#[test]
fn groups_are_of_names_kinds_or_rows() {
    let found = |keys: &str| groups(&format!("[[tolerance.group]]\n{keys}\nposition_mm = 0.1"));
    let owned = |all: &[(&str, &str)]| -> Vec<(String, String)> {
        all.iter().map(|(name, tiles)| ((*name).to_owned(), (*tiles).to_owned())).collect()
    };
    let squares = "corner corner-mx corner-my corner-mx-my";
    let bars = "bar bar-mx bar-my bar-mx-my";
    assert_eq!(found("tiles = [\"bar\", \"corner\"]"), owned(&[("group-1", "corner bar")]));
    assert_eq!(found("name = \"batch\"\nkinds = [\"square\"]"), owned(&[("batch", squares)]));
    assert_eq!(found("each = \"kind\""), owned(&[("group-1-bar", bars), ("group-1-square", squares)]));
    // Squares and bars have different heights, so that their centres are on different rows.
    let rows = [
        ("r-1", "corner-my corner-mx-my"),
        ("r-2", "corner corner-mx"),
        ("r-3", "bar-my bar-mx-my"),
        ("r-4", "bar bar-mx"),
    ];
    assert_eq!(found("name = \"r\"\nrows_along = \"x\""), owned(&rows));
    assert_eq!(found("name = \"r\"\nrows_along = \"x\"\nkinds = [\"square\"]"), owned(&rows[..2]));
    let errors =
        tolerance("[[tolerance.group]]\ntiles = [\"*\"]\nposition_mm = [0.1, 0, 0]\nrotation_deg = [0, 0, 0.2]");
    assert!(errors.tiles.is_empty() && errors.groups[0].tiles.len() == 8);
    assert_eq!(errors.groups[0].errors.position, normal([0.1, 0.0, 0.0]));
    assert_eq!(errors.groups[0].errors.rotation, degrees([0.0, 0.0, 0.2]));
}

const COMMON: &str = "[tolerance.film]\nposition_mm = 0.2\nrotation_deg = [0, 0, 0.5]\n\
    [tolerance.stray_field]\nfield_ut = [{ fixed = 50 }, 0, 0]\nany_direction_ut = { fixed = 20 }\nwhen = \"after\"\n\
    [tolerance.temperature]\nchange_k = { fixed = 10 }\nstrength_per_k = -0.0012\n\
    [tolerance.sensor]\nposition_mm = [0.03, 0, 0]\noffset_ut = 20\nrotation_deg = 0.5\ngain = [0.01, 0.01, 0.02]\nnoise_ut = 5\n";

#[test]
fn common_errors_are_read_in_their_units() {
    let CommonErrors { film, stray_field, neighbour, iron, temperature, sensor } = tolerance(COMMON).common;
    assert_eq!((film.position_mm, film.rotation_rad), (normal([0.2; 3]), degrees([0.0, 0.0, 0.5])));
    let field_t = [Distribution::Fixed(5e-5), Distribution::NONE, Distribution::NONE];
    let any_direction_t = Distribution::Fixed(2e-5);
    assert_eq!(stray_field, Some(StrayField { field_t, any_direction_t, later: true }));
    assert_eq!((neighbour, iron), (None, None));
    assert_eq!(temperature, Some(Temperature { change_k: Distribution::Fixed(10.0), strength_per_k: -0.0012 }));
    let wanted = SensorErrors {
        position_mm: normal([0.03, 0.0, 0.0]),
        offset_t: normal([2e-5; 3]),
        rotation_rad: degrees([0.5; 3]),
        gain: normal([0.01, 0.01, 0.02]),
        noise_t: normal([5e-6; 3]),
    };
    assert_eq!(sensor, wanted);
}

#[test]
fn scaled_errors_keep_their_distribution() {
    for (distribution, scaled) in [
        (Distribution::Fixed(-0.5), Distribution::Fixed(-2.0)),
        (Distribution::normal(0.25), Distribution::normal(1.0)),
        (
            Distribution::Truncated { deviation: 0.25, limit: 0.5 },
            Distribution::Truncated { deviation: 1.0, limit: 2.0 },
        ),
        (Distribution::Uniform { half_width: 0.5 }, Distribution::Uniform { half_width: 2.0 }),
        (Distribution::Tabulated([-0.5, 0.25].into()), Distribution::Tabulated([-2.0, 1.0].into())),
    ] {
        assert_eq!(distribution.scaled(4.0), scaled);
    }
}

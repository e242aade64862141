//! `[tolerance]` and `[expect.made]`: what a table means, and each rule where it is just broken.

use std::fmt::Write;
use std::fs;

use glam::DVec3;
use magsplice_layout::{
    CommonErrors, Distribution, ErrorGroup, FilmTolerance, Finding, Layout, MadeExpectations, SensorErrors, StrayField,
    Temperature, TileErrors,
};

const HEAD: &str = "format = 1\nname = \"test\"\n";
const IDEAL: &str = "[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.12\n";
const VOLUME: &str = "[volume]\nx_mm = [-2, 2]\ny_mm = [-2, 2]\nz_mm = [-5, -3]\nstep_mm = 0.5\n";
/// Eight tiles of two kinds in two rows along x: four square ones and four bars.
const TILES: &str = "[kind.square]\nsize_mm = [3, 3, 1]\nstrength_t = 0.12\n\
    [kind.bar]\nsize_mm = [2, 4, 1.5]\nstrength_t = 0.12\n\
    [[tile]]\nname = \"corner\"\nkind = \"square\"\nposition_mm = [2, 4, 0.5]\ndirection = [1, 1, 0]\nmirror = { axes = [\"x\", \"y\"] }\n\
    [[tile]]\nname = \"bar\"\nkind = \"bar\"\nposition_mm = [6, 4, 0.75]\ndirection = [1, 0, 0]\nmirror = { axes = [\"x\", \"y\"] }\n";

/// The text of a layout; lines 1 to 12 are its head, ideal film and volume, and [tolerance] is line 13
/// if `tables` begins with it.
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
        position_mm: normal([0.05, 0.06, 0.0]),
        rotation_rad: degrees([0.5; 3]),
        size_mm: normal([0.02; 3]),
        strength: Distribution::Normal { deviation: 0.01 },
        direction_rad: degrees([1.0, 2.0]),
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
        [("workshop", TileErrors::workshop()), ("by-hand", TileErrors::by_hand()), ("jig", TileErrors::jig())]
    {
        assert_eq!(tolerance(&format!("[tolerance]\npreset = \"{preset}\"")), FilmTolerance::of_tiles(&wanted, 8));
    }
    let replaced = TileErrors { strength: Distribution::normal(0.02), ..TileErrors::workshop() };
    let found = tolerance("[tolerance]\npreset = \"workshop\"\nstrength = 0.02");
    assert_eq!(found, FilmTolerance::of_tiles(&replaced, 8));
    // The numbers of the documentation.
    let hand = TileErrors::by_hand();
    assert_eq!((hand.position_mm, hand.rotation_rad), (normal([0.15; 3]), degrees([1.5; 3])));
    assert_eq!((hand.size_mm, hand.strength), (normal([0.05; 3]), Distribution::normal(0.03)));
    assert_eq!(hand.direction_rad, degrees([2.0; 2]));
    let jig = TileErrors::jig();
    assert_eq!((jig.position_mm, jig.rotation_rad), (normal([0.02; 3]), degrees([0.2; 3])));
    assert_eq!((jig.size_mm, jig.strength), (normal([0.02; 3]), Distribution::normal(0.01)));
    assert_eq!(jig.direction_rad, degrees([1.0; 2]));
    let message = parse("[tolerance]\npreset = \"workshp\"").expect_err("unknown");
    assert!(message.contains("did you mean \"workshop\"?"), "{message}");
}

#[test]
fn tables_give_other_distributions() {
    for (written, wanted) in [
        ("{ normal = 0.05 }", Distribution::Normal { deviation: 0.05 }),
        ("{ normal = 0.05, within = 0.1 }", Distribution::Truncated { deviation: 0.05, limit: 0.1 }),
        ("{ uniform = 0.1 }", Distribution::Uniform { half_width: 0.1 }),
        ("{ fixed = -0.1 }", Distribution::Fixed(-0.1)),
        ("{ values = [0.2, -0.1, 0, 0] }", Distribution::Tabulated([-0.1, 0.0, 0.0, 0.2].into())),
        ("0", Distribution::NONE),
        ("{ uniform = 0 }", Distribution::NONE),
        ("{ fixed = 0 }", Distribution::NONE),
    ] {
        let table = format!("[tolerance]\nstrength = 0.1\nposition_mm = [0, {written}, 0]");
        assert_eq!(of_tile(&table, "bar").position_mm[1], wanted, "{written}");
        let table = format!("[tolerance]\nstrength = 0.1\nposition_mm = {written}");
        assert_eq!(of_tile(&table, "bar").position_mm, [wanted.clone(), wanted.clone(), wanted], "{written}");
    }
    let turned = of_tile("[tolerance]\nrotation_deg = [0, 0, { normal = 1, within = 2 }]", "bar").rotation_rad;
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
        assert_eq!(found.position_mm, normal([position_mm; 3]), "{tile}");
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
    assert_eq!(errors.groups[0].errors.position_mm, normal([0.1, 0.0, 0.0]));
    assert_eq!(errors.groups[0].errors.rotation_rad, degrees([0.0, 0.0, 0.2]));
}

const COMMON: &str = "[tolerance.film]\nposition_mm = 0.2\nrotation_deg = [0, 0, 0.5]\n\
    [tolerance.stray_field]\nfield_ut = [{ fixed = 50 }, 0, 0]\nany_direction_ut = { fixed = 20 }\nwhen = \"after\"\n\
    [tolerance.temperature]\nchange_k = { fixed = 10 }\nstrength_per_k = -0.0012\n\
    [tolerance.sensor]\noffset_ut = 20\nrotation_deg = 0.5\ngain = [0.01, 0.01, 0.02]\nnoise_ut = 5\n";

#[test]
fn common_errors_are_read_in_their_units() {
    let CommonErrors { film, stray_field, neighbour, temperature, sensor } = tolerance(COMMON).common;
    assert_eq!((film.position_mm, film.rotation_rad), (normal([0.2; 3]), degrees([0.0, 0.0, 0.5])));
    let field_t = [Distribution::Fixed(5e-5), Distribution::NONE, Distribution::NONE];
    let any_direction_t = Distribution::Fixed(2e-5);
    assert_eq!(stray_field, Some(StrayField { field_t, any_direction_t, later: true }));
    assert_eq!(neighbour, None);
    assert_eq!(temperature, Some(Temperature { change_k: Distribution::Fixed(10.0), strength_per_k: -0.0012 }));
    let wanted = SensorErrors {
        offset_t: normal([2e-5; 3]),
        rotation_rad: degrees([0.5; 3]),
        gain: normal([0.01, 0.01, 0.02]),
        noise_t: normal([5e-6; 3]),
    };
    assert_eq!(sensor, wanted);
}

#[test]
fn each_rule_states_value_and_place() {
    let strength_of = |written: &str| format!("[tolerance]\nstrength = {written}");
    let with = |keys: &str| format!("[tolerance]\nstrength = 0.01\n{keys}");
    let group = |keys: &str| format!("[[tolerance.group]]\nname = \"g\"\n{keys}");
    let mut cases: Vec<(String, &str)> = vec![
        (
            strength_of("-0.01"),
            "tolerance: strength = -0.01, must be a finite number of at least 0, a standard deviation",
        ),
        (strength_of("inf"), "strength = inf, must be a finite number"),
        (strength_of("nan"), "strength = NaN, must be a finite number"),
        (strength_of("1"), "strength = 1, must be at most 0.5 (a fraction, not per cent: 0.01?)"),
        (strength_of("{}"), "strength gives nothing, must give one of: normal; uniform; fixed; file; values"),
        (strength_of("{ normal = 0.1, uniform = 0.1 }"), "strength gives normal, uniform, must give one of"),
        (strength_of("{ uniform = 0.1, within = 0.2 }"), "strength gives within, which goes with normal"),
        (strength_of("{ values = [0.1], column = \"a\" }"), "strength gives column, which goes with file"),
        (strength_of("{ normal = 0.1, within = 0 }"), "strength.within = 0, must be a finite number greater than 0"),
        (
            strength_of("{ normal = 0.1, within = 0.0009 }"),
            "strength.within = 0.0009, must be at least a hundredth of normal = 0.1: write { uniform = 0.0009 }",
        ),
        (strength_of("{ uniform = -1 }"), "strength.uniform = -1, must be a finite number of at least 0"),
        (strength_of("{ fixed = inf }"), "strength.fixed = inf, must be a finite number"),
        (strength_of("{ fixed = -0.6 }"), "strength = 0.6, must be at most 0.5"),
        (strength_of("{ values = [] }"), "strength.values: has no values"),
        (strength_of("{ values = [0, nan] }"), "strength.values: value 2 = NaN, must be a finite number"),
        (strength_of("{ values = [0, -0.7] }"), "strength = 0.7, must be at most 0.5"),
        (
            with("position_mm = [0, 50, 0]"),
            "position_mm[1] = 50, must be less than the shortest side of tile \"corner\", 1 mm (mm, not um: 0.05?)",
        ),
        (with("size_mm = 1"), "size_mm = 1, must be less than the shortest side of tile \"corner\", 1 mm"),
        (with("rotation_deg = [0, 0, 45.5]"), "rotation_deg[2] = 45.5, must be at most 45 (an error in degrees)"),
        (with("direction_deg = 46"), "direction_deg = 46, must be at most 45"),
        (with("samples = 9"), "samples = 9, must be from 10 to 10000000"),
        (
            with("[tolerance.kind.sqare]\nstrength = 0.1"),
            "tolerance.kind \"sqare\": [tolerance.kind] names \"sqare\", no kind has this name (did you mean \"square\"?)",
        ),
        (
            with("[tolerance.kind.bar]\n"),
            "tolerance.kind \"bar\": gives no errors, must give at least one of position_mm",
        ),
        (
            with("[tolerance.kind.bar]\nposition_mm = 1.5"),
            "tolerance.kind \"bar\": position_mm = 1.5, must be less than the shortest side of tile \"bar\", 1.5 mm",
        ),
        (
            with("[[tolerance.tile]]\ntiles = [\"corner-mz\"]\nstrength = 0"),
            "tolerance.tile: tiles names \"corner-mz\", no tile has this name (did you mean \"corner-m",
        ),
        (
            with("[[tolerance.tile]]\ntiles = [\"edge*\"]\nstrength = 0"),
            "tiles names \"edge*\", no tile has a name like this",
        ),
        (with("[[tolerance.tile]]\ntiles = []\nstrength = 0"), "tiles is empty, must name at least one tile"),
        (with("[[tolerance.tile]]\ntiles = [\"bar\"]"), "tolerance.tile: gives no errors"),
        (group("position_mm = 0.1"), "tolerance.group \"g\": has no tiles, must give tiles, kinds, rows_along or each"),
        (group("tiles = []\nposition_mm = 0.1"), "has no tiles, must have at least one"),
        (group("tiles = [\"bar\"]"), "tolerance.group \"g\": gives no errors"),
        (group("tiles = [\"bar\", \"bar*\"]\nstrength = 0.1"), "has tile \"bar\" twice, must have a tile once"),
        (group("kinds = [\"bar\", \"bar\"]\nstrength = 0.1"), "kinds names \"bar\" twice, must name a kind once"),
        (
            group("kinds = [\"bars\"]\nstrength = 0.1"),
            "kinds names \"bars\", no kind has this name (did you mean \"bar\"?)",
        ),
        (group("tiles = [\"bar\"]\nkinds = [\"bar\"]\nstrength = 0.1"), "gives both tiles and kinds"),
        (group("rows_along = \"x\"\neach = \"kind\"\nstrength = 0.1"), "gives both rows_along and each"),
        (
            group("tiles = [\"*\"]\nposition_mm = 1"),
            "position_mm = 1, must be less than the shortest side of tile \"corner\"",
        ),
        (
            format!("{}\n{}", group("tiles = [\"bar\"]\nstrength = 0.1"), group("kinds = [\"bar\"]\nstrength = 0.1")),
            "several groups are named \"g\", names must be unique",
        ),
        (
            with("[tolerance.film]\nposition_mm = 15"),
            "tolerance.film: position_mm = 15, must be less than the longest side of the film, 14 mm",
        ),
        (
            with("[tolerance.film]\nrotation_deg = { fixed = 90 }"),
            "tolerance.film: rotation_deg = 90, must be at most 45",
        ),
        (
            with("[tolerance.stray_field]\nfield_ut = 100001"),
            "tolerance.stray_field: field_ut = 100001, must be at most 100000 (in microtesla",
        ),
        (
            with("[tolerance.stray_field]\nany_direction_ut = { fixed = 2e5 }"),
            "any_direction_ut = 200000, must be at most 100000",
        ),
        (
            with("[tolerance.temperature]\nchange_k = 1001\nstrength_per_k = -0.001"),
            "change_k = 1001, must be at most 1000",
        ),
        (
            with("[tolerance.temperature]\nchange_k = 10\nstrength_per_k = -0.12"),
            "strength_per_k = -0.12, must be from -0.02 to 0.02 (a fraction, not per cent: -0.0012?)",
        ),
        (
            with("[tolerance.temperature]\nchange_k = 10\nstrength_per_k = nan"),
            "strength_per_k = NaN, must be a finite number",
        ),
        (with("[tolerance.sensor]\nnoise_ut = 1e6"), "tolerance.sensor: noise_ut = 1000000, must be at most 100000"),
        (
            with("[tolerance.sensor]\ngain = [1, 0, 0]"),
            "gain[0] = 1, must be at most 0.5 (a fraction, not per cent: 0.01?)",
        ),
        (with("[tolerance.sensor]\noffset_ut = -1"), "offset_ut = -1, must be a finite number of at least 0"),
        (
            with("[tolerance.neighbour]\nlayout = \"nowhere.toml\"\nposition_mm = [0, 0, -12]"),
            "tolerance.neighbour: layout = \"nowhere.toml\": cannot be read: ",
        ),
        (
            with("[tolerance.neighbour]\nlayout = \"/dev/zero\"\nposition_mm = [0, 0, -12]"),
            "layout = \"/dev/zero\": cannot be read: it is not a regular file",
        ),
        (
            strength_of("{ file = \"/dev/zero\" }"),
            "strength: file \"/dev/zero\": cannot be read: it is not a regular file",
        ),
        (strength_of("{ file = \"nowhere.csv\" }"), "strength: file \"nowhere.csv\": cannot be read: "),
    ];
    let long = format!("x{}", "y".repeat(200));
    cases.push((
        with(&format!("[[tolerance.group]]\nname = \"{long}\"\ntiles = [\"*\"]\nstrength = 0")),
        "has 201 bytes",
    ));
    for (tables, rule) in cases {
        let message = parse(&tables).expect_err(&tables);
        assert!(message.starts_with("test.toml: line ") && message.contains(rule), "{tables:?}: {message}");
        assert_eq!(message.lines().count(), 1, "{tables:?}: {message}");
    }
    // A distribution of the wrong type or with an unknown key is a syntax error with its place.
    for (tables, rule) in [
        (strength_of("\"1 %\""), "expected a number, or a table such as { uniform = 0.1 }"),
        (strength_of("{ sigma = 1 }"), "unknown field `sigma`"),
        (
            with("position_mm = [1, 2]"),
            "invalid length 2, expected a number, a table such as { uniform = 0.1 }, or a list of 3",
        ),
        (with("positions_mm = 1"), "did you mean `position_mm`?"),
        (with("[tolerance.stray_field]\nfield = 1"), "did you mean `field_ut`, in microtesla?"),
    ] {
        let message = parse(&tables).expect_err(&tables);
        assert!(message.contains(rule) && message.contains("at line 1"), "{tables:?}: {message}");
    }
}

#[test]
fn rules_are_told_together_with_the_lines_of_their_tables() {
    let message = parse(
        "[tolerance]\nstrength = 1\nsamples = 1\n[tolerance.film]\nrotation_deg = 50\n[[tolerance.tile]]\ntiles = [\"no\"]\nstrength = 2",
    )
    .expect_err("five rules are broken");
    let lines: Vec<&str> = message.lines().collect();
    let starts = [
        "line 13: tolerance: samples",
        "line 13: tolerance: strength",
        "line 16: tolerance.film",
        "line 18: tolerance.tile: tiles",
        "line 18: tolerance.tile: strength",
    ];
    assert_eq!(lines.len(), starts.len(), "{message}");
    for (line, start) in lines.iter().zip(starts) {
        assert!(line.starts_with(&format!("test.toml: {start}")), "{line} {start}");
    }
    // A tile with a fault of its own is not also missing for names.
    let tile = "[[tolerance.tile]]\ntiles = [\"bad\"]\nstrength = 0.1\n[[tile]]\nname = \"bad\"\nposition_mm = [0, 0, 20]\nsize_mm = [0, 1, 1]\npolarization_t = [0, 0, 1]";
    let message = parse(tile).expect_err("a bad size");
    assert!(message.contains("size_mm[0] = 0") && message.lines().count() == 1, "{message}");
}

fn findings(tables: &str) -> Vec<String> {
    parse(tables).unwrap_or_else(|e| panic!("{tables}: {e}")).findings.iter().map(Finding::to_string).collect()
}

#[test]
fn tolerances_without_effect_are_findings() {
    assert_eq!(findings(COMMON), Vec::<String>::new());
    for (tables, finding) in [
        ("[tolerance]", "tolerance: states no errors"),
        ("[tolerance]\nsamples = 10", "tolerance: states no errors"),
        ("[tolerance]\nstrength = 0.1\n[tolerance.film]", "tolerance.film: all errors are 0"),
        ("[tolerance]\nstrength = 0.1\n[tolerance.sensor]\nnoise_ut = 0", "tolerance.sensor: all errors are 0"),
        ("[tolerance.stray_field]\nfield_ut = [0, 0, 0]\nwhen = \"after\"", "tolerance.stray_field: all errors are 0"),
        ("[tolerance.temperature]\nchange_k = 0\nstrength_per_k = -0.001", "tolerance.temperature: all errors are 0"),
        ("[[tolerance.group]]\ntiles = [\"*\"]\nstrength = 0", "tolerance.group \"group-1\": all errors are 0"),
        ("[tolerance.temperature]\nchange_k = 1\nstrength_per_k = 0.001", "strength_per_k = 0.001 is positive"),
        (
            "[tolerance.stray_field]\nfield_ut = [{ fixed = -5e-5 }, 0, 0]",
            "tolerance.stray_field.field_ut = 0.00005 is below 0.001 microtesla (microtesla, not T: 50?)",
        ),
        ("[tolerance.sensor]\nnoise_ut = 5e-6", "tolerance.sensor.noise_ut = 0.000005 is below"),
    ] {
        let found = findings(tables);
        assert!(found.len() == 1 && found[0].contains(finding), "{tables:?}: {found:?}");
    }
    let alone = Layout::parse(&format!("{HEAD}[tolerance]\npreset = \"jig\"\n{TILES}"), "test").expect("valid");
    let found: Vec<String> = alone.findings.iter().map(Finding::to_string).collect();
    assert!(found.len() == 1 && found[0].contains("beside [ideal] and [volume]"), "{found:?}");
}

/// Asserts that a layout is read again with the same errors of each tile and group, from the plain and
/// the compact form.
#[track_caller]
fn assert_is_written(layout: &Layout, folder: &std::path::Path) {
    let wanted = layout.tolerance.as_ref().expect("stated");
    let again = |text: &str| Layout::parse_beside(text, "again", folder).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let plain = again(&layout.to_toml());
    assert_eq!(plain.tolerance.as_ref(), Some(wanted), "{}", layout.to_toml());
    assert_eq!(plain.expectations, layout.expectations);
    let text = layout.to_compact_toml();
    let compact = again(&text);
    let found = compact.tolerance.as_ref().expect("stated");
    assert_eq!(compact.expectations, layout.expectations);
    assert_eq!((&found.common, found.samples, found.seed), (&wanted.common, wanted.samples, wanted.seed), "{text}");
    // The tiles have another order.
    let place = |index: usize| {
        let tile = layout.tiles[index].tile;
        compact.tiles.iter().position(|named| named.tile == tile).expect("the same tile")
    };
    let places: Vec<usize> = (0..layout.tiles.len()).map(place).collect();
    for (index, errors) in wanted.tiles.iter().enumerate() {
        assert_eq!(&found.tiles[places[index]], errors, "{}", layout.tiles[index].name);
    }
    assert_eq!(found.groups.len(), wanted.groups.len());
    for (found, wanted) in found.groups.iter().zip(&wanted.groups) {
        let mut tiles: Vec<usize> = wanted.tiles.iter().map(|&tile| places[tile]).collect();
        tiles.sort_unstable();
        assert_eq!((&found.name, &found.tiles, &found.errors), (&wanted.name, &tiles, &wanted.errors));
    }
}

#[test]
fn layouts_are_written_with_their_tolerances() {
    let folder = tempfile::tempdir().expect("a folder");
    for tables in [
        "[tolerance]".to_owned(),
        "[tolerance]\npreset = \"by-hand\"\nsamples = 123\nseed = 456".to_owned(),
        COMMON.to_owned(),
        "[tolerance.stray_field]\nwhen = \"after\"".to_owned(),
        format!(
            "[tolerance]\nposition_mm = [0.05, {{ uniform = 0.1 }}, {{ fixed = -0.01 }}]\nrotation_deg = {{ normal = 0.7, within = 1.1 }}\n\
             direction_deg = {{ values = [0.3, -0.1, 1.7] }}\n\
             [tolerance.kind.square]\nstrength = 0.02\n[[tolerance.tile]]\ntiles = [\"corner*\", \"bar\"]\nposition_mm = 0.1\n\
             [[tolerance.tile]]\ntiles = [\"bar-my\"]\nrotation_deg = 0\n\
             [[tolerance.group]]\nname = \"rows\"\nrows_along = \"x\"\nposition_mm = [0.1, 0, 0]\nrotation_deg = [0, 0, 0.2]\n\
             [[tolerance.group]]\neach = \"kind\"\nstrength = 0.01\n[[tolerance.group]]\ntiles = [\"bar*\"]\nsize_mm = 0\n{COMMON}\n\
             [expect.made]\namplitude = {{ min = 0.8 }}"
        ),
    ] {
        assert_is_written(&parse(&tables).unwrap_or_else(|e| panic!("{tables}: {e}")), folder.path());
    }
}

#[test]
fn asterisks_in_names_of_tiles_are_these_names() {
    let tile = |name: &str, x: f64| {
        format!(
            "[[tile]]\nname = \"{name}\"\nposition_mm = [{x}, 0, 20]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n"
        )
    };
    let tables =
        format!("[[tolerance.tile]]\ntiles = [\"a*\"]\nstrength = 0.1\n{}{}", tile("a*", 0.0), tile("ab", 5.0));
    let layout = parse(&tables).expect("valid");
    let with: Vec<&str> = layout
        .tiles
        .iter()
        .zip(&layout.tolerance.as_ref().expect("stated").tiles)
        .filter(|(_, errors)| !errors.strength.is_none())
        .map(|(tile, _)| tile.name.as_str())
        .collect();
    assert_eq!(with, ["a*"]);
    assert_is_written(&layout, std::path::Path::new(""));
}

#[test]
fn files_beside_the_layout_give_measured_errors_and_a_neighbour() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("written");
    write("measured.csv", "# laid by hand\nn;dx_mm;turn_deg\n1;0.02;0.5\n2;-0.03;-1\n");
    write(
        "other.toml",
        &format!(
            "{HEAD}[tolerance]\nposition_mm = {{ file = \"none.csv\" }}\n[[tile]]\nposition_mm = [1, 2, 0.5]\nsize_mm = [3, 2, 1]\npolarization_t = [0.1, 0, 0]\n"
        ),
    );
    let tables = "[tolerance]\nposition_mm = [{ file = \"measured.csv\", column = \"dx_mm\" }, 0, 0]\n\
        rotation_deg = { file = \"measured.csv\", column = \"turn_deg\" }\n\
        [tolerance.neighbour]\nlayout = \"other.toml\"\nposition_mm = [0, 0, -12]\n\
        rotation = { axis = [0, 1, 0], angle_deg = 180 }\nwhen = \"after\"";
    write("film.toml", &text(tables));
    let layout = Layout::read(folder.path().join("film.toml")).expect("valid");
    let found = layout.tolerance.as_ref().expect("stated");
    assert_eq!(found.tiles[3].position_mm[0], Distribution::Tabulated([-0.03, 0.02].into()));
    let turns = [(-1.0_f64).to_radians(), 0.5_f64.to_radians()];
    assert_eq!(found.tiles[3].rotation_rad[2], Distribution::Tabulated(turns.into()));
    let neighbour = found.common.neighbour.as_ref().expect("stated");
    assert!(neighbour.later && neighbour.layout == "other.toml" && neighbour.tiles.len() == 1);
    let tile = neighbour.tiles[0];
    assert!((tile.position() - DVec3::new(-1.0, 2.0, -12.5)).length() < 1e-12, "{tile:?}");
    assert!((tile.scene_polarization_t() - DVec3::new(-0.1, 0.0, 0.0)).length() < 1e-15, "{tile:?}");
    assert_is_written(&layout, folder.path());
    // From a text, paths are relative to the folder of its file.
    let origin = folder.path().join("film.toml").display().to_string();
    assert_eq!(Layout::parse(&text(tables), &origin).expect("valid").tolerance, layout.tolerance);
    assert!(Layout::parse(&text(tables), "film.toml").is_err());

    write("bad.csv", "a,b\n1,2\n3,x\n");
    write(
        "bad.toml",
        "format = 1\nname = \"bad\"\n[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 0, 1]\npolarization_t = [0, 0, 1]\n",
    );
    write("broken.toml", "format = 1\nname = \n");
    for (tables, rule) in [
        (
            "[tolerance]\nstrength = { file = \"bad.csv\", column = \"b\" }",
            "line 13: tolerance: strength: file \"bad.csv\": line 3: \"x\", must be a number",
        ),
        ("[tolerance]\nstrength = { file = \"bad.csv\", column = \"c\" }", "line 1: has no column \"c\""),
        (
            "[tolerance]\nposition_mm = { file = \"measured.csv\", column = \"turn_deg\" }",
            "column \"turn_deg\" is in degrees, must be in mm",
        ),
        ("[tolerance]\nstrength = { file = \".\" }", "file \".\": cannot be read: it is not a regular file"),
        (
            "[tolerance.neighbour]\nlayout = \"bad.toml\"\nposition_mm = [0, 0, -12]",
            "layout = \"bad.toml\": is refused: line 3: tile \"tile-1\": size_mm[1] = 0, must be greater than 0",
        ),
        (
            "[tolerance.neighbour]\nlayout = \"broken.toml\"\nposition_mm = [0, 0, -12]",
            "layout = \"broken.toml\": is refused: broken.toml: TOML parse error at line 2",
        ),
        ("[tolerance.neighbour]\nlayout = \"other.toml\"", "has no position_mm, the place of its origin"),
        (
            "[tolerance.neighbour]\nlayout = \"other.toml\"\nposition_mm = [0, inf, 0]",
            "position_mm = [0.0, inf, 0.0], must be three finite numbers",
        ),
        (
            "[tolerance.neighbour]\nlayout = \"other.toml\"\nposition_mm = [0, 0, 0]\nrotation = {}",
            "rotation gives nothing",
        ),
    ] {
        write("film.toml", &text(tables));
        let message = Layout::read(folder.path().join("film.toml")).expect_err(tables).to_string();
        assert!(message.contains(rule) && message.lines().count() == 1, "{tables:?}: {message}");
    }
    // A layout may be its own neighbour.
    write("film.toml", &text("[tolerance.neighbour]\nlayout = \"film.toml\"\nposition_mm = [0, 0, -12]"));
    let twice = Layout::read(folder.path().join("film.toml")).expect("valid").tolerance.expect("stated");
    assert_eq!(twice.common.neighbour.expect("stated").tiles.len(), 8);
}

#[test]
fn limits_bound_memory_and_time() {
    // 101 x 1000 tiles.
    let many = format!(
        "{HEAD}[tolerance]\nstrength = 0.01\n[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n\
         grid = {{ count = [101, 1000, 1], pitch_mm = [2, 2, 0] }}\n"
    );
    let message = Layout::parse(&many, "many").expect_err("too many").to_string();
    assert!(message.contains("the layout has 101000 tiles, must have at most 100000 with [tolerance]"), "{message}");
    assert_eq!(
        Layout::parse(&many.replace("101", "100"), "many").expect("valid").tolerance.expect("stated").tiles.len(),
        100_000
    );
    let grid = many.split_once("[[tile]]").expect("a tile").1.replace("101", "100");
    let with = |tables: &str| {
        Layout::parse(&format!("{HEAD}{tables}[[tile]]{grid}"), "many").expect_err("a limit").to_string()
    };
    let groups = |count: usize| {
        (0..count).fold(String::new(), |mut text, n| {
            let _ = write!(text, "[[tolerance.group]]\nname = \"{n}\"\ntiles = [\"*\"]\nstrength = 0.1\n");
            text
        })
    };
    assert!(with(&groups(5)).contains("makes 500000 tiles in all groups, must be at most 400000"));
    let names = vec!["\"*1\""; 200].join(", ");
    let message = with(&format!("[[tolerance.tile]]\ntiles = [{names}]\nstrength = 0.1\n"));
    assert!(message.contains("has one more name with *, must be at most 10000000"), "{message}");
    let values = vec!["0.1"; 60_000].join(",");
    let entries = (0..20).fold(String::new(), |mut text, _| {
        let _ = write!(text, "[[tolerance.tile]]\ntiles = [\"bar\"]\nstrength = {{ values = [{values}] }}\n");
        text
    });
    let message = parse(&entries).expect_err("too many values");
    assert!(
        message.contains("strength: has too many tabulated values") && message.contains("at most 1000000"),
        "{message}"
    );
    let message = parse(&format!("[tolerance]\nstrength = {{ values = [{values},{values}] }}")).expect_err("too many");
    assert!(message.contains("strength.values: has 120000 values, must have at most 100000"), "{message}");
    // A group for each row has the values once more.
    let rows = (0..9).fold(String::new(), |mut text, n| {
        let _ = write!(
            text,
            "[[tolerance.group]]\nname = \"{n}\"\nrows_along = \"x\"\nstrength = {{ values = [{values}] }}\n"
        );
        text
    });
    assert!(parse(&rows).expect_err("too many values").contains("this group: has too many tabulated values"));
}

#[test]
fn expectations_of_made_films_are_read_and_their_limits_are_rules() {
    let made = |keys: &str| parse(&format!("[tolerance]\npreset = \"workshop\"\n[expect.made]\n{keys}"));
    let all = made(
        "percentile = 90\nuniformity_rmse = { r_x = 0.07, s_z = 0.05 }\ndisplacement_rmse_mm = { x = 0.03 }\n\
         amplitude = { min = 0.8 }\nsamples = 400\nconfidence = 0.99",
    );
    let all = all.expect("valid");
    let wanted = MadeExpectations {
        percentile: 90.0,
        uniformity_rmse: [Some(0.07), None, Some(0.05)],
        displacement_rmse_mm: [Some(0.03), None, None],
        least_amplitude: Some(0.8),
        samples: Some(400),
        confidence: 0.99,
    };
    assert_eq!(all.expectations.made, Some(wanted));
    assert_is_written(&all, std::path::Path::new(""));
    let least = made("amplitude = { min = 0.8 }").expect("valid").expectations.made.expect("stated");
    assert_eq!(least, MadeExpectations { least_amplitude: Some(0.8), ..MadeExpectations::default() });
    assert_eq!((least.percentile, least.samples, least.confidence), (95.0, None, 0.95));
    for (keys, rule) in [
        ("", "has no bound, must give at least one of uniformity_rmse, displacement_rmse_mm, amplitude"),
        ("uniformity_rmse = {}", "uniformity_rmse is empty, must give at least one of r_x, r_y, s_z"),
        ("displacement_rmse_mm = {}", "displacement_rmse_mm is empty, must give at least one of x, y, z"),
        ("displacement_rmse_mm = { x = -1 }", "displacement_rmse_mm.x = -1, must be a finite number of at least 0"),
        ("amplitude = { min = nan }", "amplitude.min = NaN"),
        ("amplitude = { min = 0 }\npercentile = 0", "percentile = 0, must be greater than 0 and less than 100"),
        ("amplitude = { min = 0 }\npercentile = 100", "percentile = 100, must be greater than 0 and less than 100"),
        ("amplitude = { min = 0 }\npercentile = 0.95", "percentile = 0.95, must be greater than 1 (per cent: 95?)"),
        (
            "amplitude = { min = 0 }\nconfidence = 95",
            "confidence = 95, must be greater than 0 and less than 1 (a fraction, not per cent: 0.95?)",
        ),
        ("amplitude = { min = 0 }\nconfidence = nan", "confidence = NaN, must be greater than 0 and less than 1"),
        ("amplitude = { min = 0 }\nsamples = 1", "samples = 1, must be from 10"),
    ] {
        let message = made(keys).expect_err(keys);
        assert!(message.contains("line 15: expect.made: ") && message.contains(rule), "{keys:?}: {message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
    let alone = Layout::parse(&format!("{HEAD}[expect.made]\namplitude = {{ min = 1 }}\n{TILES}"), "test");
    let message = alone.expect_err("tables are missing").to_string();
    for table in ["[tolerance]", "[ideal]", "[volume]"] {
        assert!(message.contains(&format!("expect.made: needs the table {table}")), "{message}");
    }
}

#[test]
fn errors_of_tiles_that_are_left_out_are_left_out() {
    let mut found = tolerance(
        "[tolerance]\nstrength = 0.01\n[[tolerance.tile]]\ntiles = [\"bar\"]\nstrength = 0.02\n\
         [[tolerance.group]]\nname = \"a\"\ntiles = [\"corner\", \"bar\"]\nstrength = 0.1\n\
         [[tolerance.group]]\nname = \"b\"\ntiles = [\"corner\"]\nstrength = 0.1",
    );
    assert_eq!(found.groups[0].tiles, [0, 4]);
    found.retain_tiles(|index| index != 0 && index != 2);
    assert_eq!(found.tiles.len(), 6);
    assert_eq!(found.tiles[2].strength, Distribution::normal(0.02));
    assert_eq!(found.groups.len(), 1);
    assert_eq!((found.groups[0].name.as_str(), &found.groups[0].tiles[..]), ("a", &[2][..]));
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

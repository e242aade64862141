//! Messages about documents that do not fit the schema: unknown and missing keys, wrong types.

use magsplice_layout::{Layout, meant_polarization};

const HEAD: &str = "format = 1\nname = \"t\"\n";
const TILE: &str = "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";

fn message(text: &str) -> String {
    Layout::parse(text, "t.toml").expect_err("a misfit").to_string()
}

/// The line of the message that follows the excerpt of one line in a table.
fn sentence(table: &str, line: &str) -> String {
    let all = message(&format!("{HEAD}{TILE}{table}{line}\n"));
    let (_, excerpt) = all.split_once(&format!(" | {line}\n")).unwrap_or_else(|| panic!("{all}"));
    let (_, rest) = excerpt.split_once("^\n").expect("a mark");
    rest.lines().next().expect("a sentence").to_owned()
}

#[test]
fn misfits_have_place_excerpt_and_sentence() {
    let text = format!("{HEAD}{TILE}colour = \"red\"\nname = 3\n[volum]\n");
    let wanted = "t.toml: TOML parse error at line 7, column 1
  |
7 | colour = \"red\"
  | ^^^^^^
unknown field `colour`, expected one of `diameter_mm`, `direction`, `direction_deg`, `grid`, `height_mm`, \
                  `kind`, `mirror`, `name`, `polarization_t`, `position_mm`, `recoil_permeability`, `rotation`, `shape`, \
                  `shape_error`, `size_mm`, `strength_t`, `tilt_deg`
t.toml: TOML parse error at line 8, column 8
  |
8 | name = 3
  |        ^
name is a string in quotes: write `name = \"3\"`
Unique name. Default: tile-1, tile-2 and so on, numbered in the order of the file.
t.toml: TOML parse error at line 9, column 2
  |
9 | [volum]
  |  ^^^^^
unknown field `volum`, expected one of `description`, `design`, `elastomer`, `expect`, `format`, `history`, `ideal`, \
                  `kind`, `lattice`, `material`, `name`, `overlap_mm`, `plane`, `sensor`, `tile`, `tolerance`, `volume`
did you mean `volume`?";
    assert_eq!(message(&text), wanted);
}

#[test]
fn misfits_are_listed_up_to_a_limit() {
    let text = format!("{HEAD}{TILE}history = [{}]\n", "1, ".repeat(25)).replace("[[tile]]\n", "tile = []\n");
    let all = message(&text);
    assert_eq!(all.matches("TOML parse error").count(), 20);
    assert!(all.ends_with("t.toml: and 8 more"), "{all}");
}

#[test]
fn place_at_the_end_of_a_text_is_its_last_line() {
    assert!(message("format = 1\nname = \"\u{b5}").starts_with("t.toml: TOML parse error at line 2, column 10\n"));
    assert!(message("").starts_with("t.toml: TOML parse error at line 1, column 1\n  |\n1 | \n  | ^\nmissing field"));
}

#[test]
fn integers_beyond_those_of_toml_are_refused() {
    for (key, value) in
        [("seed", "9223372036854775808"), ("samples", "-9223372036854775809"), ("strength", "10000000000000000000")]
    {
        let range = "must be from -9223372036854775808 to 9223372036854775807, the integers of TOML";
        assert_eq!(sentence("[tolerance]\n", &format!("{key} = {value}")), format!("{key} {range}"));
    }
    assert!(Layout::parse(&format!("{HEAD}{TILE}[tolerance]\nseed = 0x7fff_ffff_ffff_ffff\n"), "t").is_ok());
}

#[test]
fn numbers_in_quotes_are_converted_to_the_unit_of_the_key() {
    for (table, key, text, end) in [
        ("", "strength_t", "200 mT", "strength_t is a number in tesla, without quotes and unit: write 0.2"),
        ("", "strength_t", "1.2", "write 1.2"),
        ("", "strength_t", "strong", "strength_t is a number in tesla, not a string"),
        ("[ideal]\n", "amplitude_t", "1200 G", "write 0.12"),
        ("[ideal]\n", "wavelength_mm", "1cm", "write 10"),
        ("[ideal]\n", "wavelength_mm", "0.008 m", "write 8"),
        ("[tile.rotation]\n", "angle_deg", "30 deg", "write 30"),
        ("[sensor]\n", "range_mt", "5 mT", "not a string: write `range_mt = 5`"),
        ("[expect.amplitude]\n", "min", "3", "min is a number, without quotes: write 3"),
    ] {
        let found = sentence(table, &format!("{key} = \"{text}\""));
        assert!(found.ends_with(end), "{found}");
    }
}

/// The table, the line, and the sentence.
#[test]
fn each_type_is_named_with_the_form_that_the_key_wants() {
    let lattice = "[[lattice]]\nstart_mm = [0, 0, 0]\nheight_mm = 1\n";
    for (table, line, wanted) in [
        ("[tolerance]\n", "samples = \"10\"", "samples is an integer, without quotes: write 10"),
        ("[tolerance]\n", "samples = 1.5", "samples is an integer, at least 0, not 1.5"),
        ("[tolerance]\n", "samples = -1", "samples is an integer, at least 0, not -1"),
        ("[tolerance]\n", "samples = [1]", "samples is an integer, at least 0, not a list"),
        ("[tolerance]\n", "samples = \"ten\"", "samples is an integer, at least 0, not a string"),
        ("", "name = 3", "name is a string in quotes: write `name = \"3\"`"),
        ("", "name = true", "name is a string in quotes: write `name = \"true\"`"),
        ("", "name = [3]", "name is a string in quotes, not a list"),
        ("", "name = 1979-05-27", "name is a string in quotes, not a date"),
        ("", "name = 77777777777777777.77777777777777777777777", "name is a string in quotes, not a number"),
        ("", "strength_t = [1, 2]", "strength_t is one number in tesla, not a list, as in `strength_t = 0.12`"),
        ("[tile.rotation]\n", "angle_deg = false", "angle_deg is one number in degrees, not true or false"),
        ("[expect.amplitude]\n", "min = {}", "min is one number, not a table"),
        (
            "[tile.rotation]\n",
            "axis = \"Y\"",
            "axis is a list of three numbers, not a string: write `axis = [0, 1, 0]`",
        ),
        ("", "direction = \"z\"", "direction is a list of three numbers, not a string: write `direction = [0, 0, 1]`"),
        ("[tile.rotation]\n", "axis = 3", "axis is a list of three numbers, not a number, as in `axis = [0, 0, 1]`"),
        ("", "mirror = \"z\"", "mirror is a table, not a string: write `mirror = { axes = [\"z\"] }`"),
        ("[tile.mirror]\n", "axes = \"y\"", "axes is a list, not a string: write `axes = [\"y\"]`"),
        (
            "",
            "rotation = 30",
            "rotation is a table, not a number, as in `rotation = { axis = [0, 0, 1], angle_deg = 30 }`",
        ),
        ("[expect]\n", "amplitude = 0.8", "amplitude is a table, not a number: write `amplitude = { min = 0.8 }`"),
        ("[design]\n", "vary = \"Size\"", "vary is a list, not a string: write `vary = [\"size\"]`"),
        ("[design]\nvary = []\n", "goal = 4", "goal is a word in quotes, not a number"),
        (
            "[design]\nvary = []\n",
            "goal = \"fields\"",
            "unknown variant `fields`, expected one of `uniformity`, `displacement`, `field`",
        ),
        (
            "[material]\n",
            "recoil_permeability = \"x\"",
            "recoil_permeability is one number, or a table such as { along = 1.05, across = 1.15 }, not a string",
        ),
        (
            "[tolerance]\n",
            "position_mm = [1, 2]",
            "position_mm is one number in mm, a table such as { uniform = 0.1 }, or a list of three of them, not a list of 2",
        ),
        (
            "[sensor]\n",
            "noise_ut = [1, 2]",
            "noise_ut is one number in microtesla, or a list of three, one along each axis, not a list of 2",
        ),
        (
            lattice,
            "x = 3",
            "x is a list of tables, not a number, as in `x = [{ widths_mm = [3.3, 1.7], pattern = [1, 0] }]`",
        ),
    ] {
        assert_eq!(sentence(table, line), wanted);
    }
}

#[test]
fn lists_of_wrong_lengths_and_elements_are_named() {
    let with = |size: &str| sentence("[[tile]]\nposition_mm = [5, 5, 5]\n", &format!("size_mm = {size}"));
    assert!(
        with("\"1\"").starts_with("size_mm is a list of three numbers in mm, not a string, as in `size_mm = [3.3, ")
    );
    for text in ["3.3, 1.7, 1", "3.3x1.7x1", "[3.3 1.7 1]"] {
        assert!(with(&format!("\"{text}\"")).ends_with(": write `size_mm = [3.3, 1.7, 1]`"), "{text}");
    }
    assert!(with("[1, 2]").starts_with("size_mm is a list of three numbers in mm, not a list of 2, as in"));
    assert!(with("[1, 2, 3, 4]").starts_with("size_mm is a list of three numbers in mm, not a list of 4, as in"));
    assert_eq!(with("[1, 2, \"x\"]"), "each value of size_mm is a number in mm, not a string");
    let matrix = |value: &str| sentence("[tile.rotation]\n", &format!("matrix = {value}"));
    let three = "a list of three numbers";
    assert!(matrix("[1, 2]").starts_with("matrix is a list of three rows, each of three numbers, not a list of 2"));
    assert!(matrix("[[1], [2], [3]]").starts_with(&format!("each value of matrix is {three}, not a list of 1")));
    assert!(sentence("[tile.grid]\n", "count = 4").starts_with("count is a list of three integers, not a number"));
}

#[test]
fn nearest_key_is_suggested_with_its_unit() {
    for (unknown, meant) in [
        ("size", "did you mean `size_mm`, in mm?"),
        ("Position_mm", "did you mean `position_mm`?"),
        ("strenght_t", "did you mean `strength_t`?"),
        ("strength_mT", "did you mean `strength_t`, in tesla?"),
        ("polarisation_t", "did you mean `polarization_t`?"),
        ("rotate", "did you mean `rotation`?"),
        ("remanence", "did you mean `strength_t`, the magnitude of J in tesla?"),
        (
            "magnetization",
            "give polarization_t, the polarization J = mu0 M in tesla: a magnetization M of 955 kA/m is 1.2 T",
        ),
    ] {
        let all = message(&format!("{HEAD}{TILE}{unknown} = 1\n"));
        assert!(all.ends_with(&format!("`tilt_deg`\n{meant}")), "{all}");
    }
    for unknown in ["colour", "x", "grade", "\"\""] {
        assert!(message(&format!("{HEAD}{TILE}{unknown} = 1\n")).ends_with("`tilt_deg`"), "{unknown}");
    }
}

#[test]
fn misspelt_key_is_not_missing_too() {
    let all = message(&format!("{HEAD}{}", TILE.replace("position_mm", "positon_mm")));
    assert_eq!(all.matches("TOML parse error").count(), 1, "{all}");
    let all = message(&format!("{HEAD}[[tile]]\nsize_mm = [1, 1, 1]\n"));
    assert!(
        all.ends_with("missing field `position_mm`, as in `position_mm = [0.0, 0.0, 0.5]`\nCentre, in mm."),
        "{all}"
    );
}

#[test]
fn tables_at_the_top_begin_with_a_line_of_their_own() {
    assert!(
        message(&format!("{HEAD}volume = 3\n"))
            .contains("volume is a table, not a number: begin it with the line [volume]")
    );
    assert!(
        message(&format!("{HEAD}[tile]\n"))
            .contains("tile is a list of tables, not a table: write [[tile]] with two brackets")
    );
}

#[test]
fn tables_that_need_a_key_must_have_one() {
    for (table, line, wanted) in [
        ("[expect]\n", "uniformity_rmse = {}", "uniformity_rmse is empty, must give at least one of r_x, r_y, s_z"),
        (
            "[expect.made]\n",
            "displacement_rmse_mm = {}",
            "displacement_rmse_mm is empty, must give at least one of x, y, z",
        ),
        (
            "",
            "[expect]",
            "expect is empty, must give at least one of amplitude, clearance_mm, displacement_rmse_mm, field, made, \
             uniformity_rmse",
        ),
    ] {
        assert_eq!(sentence(table, line), wanted);
    }
}

#[test]
fn unit_is_guessed_from_the_magnitude() {
    for (value, meant) in [
        (2.6, "did you mean 0.0026 T, which is 2.6 mT?"),
        (-1200.0, "did you mean 1.2 T, which is 1200 mT?"),
        (2501.0, "did you mean 0.25 T, which is 2501 G?"),
        (950_000.0, "did you mean J = mu0 M = 1.19 T, for M = 950000 A/m?"),
        (1e9, "give the polarization J = mu0 M in T"),
    ] {
        assert_eq!(meant_polarization(value), meant);
    }
}

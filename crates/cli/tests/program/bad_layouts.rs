//! Layouts that cannot be used: every verb states the reason, exits with 2, and writes nothing.

use crate::Sandbox;

const HEAD: &str = "format = 1\nname = \"bad\"\n";
const TILE: &str = "[[tile]]\nname = \"a\"\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
const IDEAL: &str = "[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.12\n";
const VOLUME: &str = "[volume]\nx_mm = [-2, 2]\ny_mm = [-2, 2]\nz_mm = [-5, -3]\nstep_mm = 0.5\n";

/// Runs every verb on a layout with this text and expects all `messages` on standard error.
#[track_caller]
fn refused(text: &str, messages: &[&str]) {
    let sandbox = Sandbox::new();
    sandbox.write("bad.toml", text);
    sandbox.write("out.csv", "was here before\n");
    let calls: [&[&str]; 5] = [
        &["tiles", "bad.toml"],
        &["field", "bad.toml", "-o", "out.csv"],
        &["compare", "bad.toml"],
        &["decouple", "bad.toml", "--format", "json"],
        &["check", "bad.toml"],
    ];
    for call in calls {
        let said = sandbox.run(call);
        for message in messages {
            said.refuses(message);
        }
    }
    assert_eq!(sandbox.files(), ["bad.toml", "out.csv"]);
    assert_eq!(sandbox.read("out.csv"), "was here before\n");
}

#[test]
fn missing_layout_file_is_refused() {
    let sandbox = Sandbox::new();
    for verb in ["field", "compare", "decouple", "check", "tiles"] {
        sandbox.run(&[verb, "nowhere.toml"]).refuses("cannot read nowhere.toml: No such file or directory");
    }
    sandbox.run(&["tiles", "."]).refuses("cannot read .: ");
    sandbox.run(&["check", "."]).refuses(".: no layout in this folder");
    sandbox.write("binary.toml", "x");
    std::fs::write(sandbox.path("binary.toml"), [0xff, 0xfe]).unwrap();
    sandbox.run(&["check", "binary.toml"]).refuses("binary.toml: not UTF-8 text");
}

#[test]
fn broken_toml_shows_the_line() {
    refused(&format!("{HEAD}[[tile]\n"), &["bad.toml: TOML parse error at line 3", "3 | [[tile]"]);
}

#[test]
fn unknown_key_shows_the_line() {
    refused(&format!("{HEAD}{TILE}colour = \"red\"\n"), &["line 8", "unknown field `colour`", "8 | colour = \"red\""]);
    refused(&format!("{HEAD}{TILE}size = [1, 1, 1]\n"), &["unknown field `size`", "size_mm"]);
    refused(&format!("{HEAD}{TILE}[volumes]\n"), &["unknown field `volumes`"]);
}

#[test]
fn missing_keys_and_wrong_types_are_refused() {
    refused("name = \"bad\"\n", &["missing field `format`"]);
    refused(&format!("{HEAD}[[tile]]\nsize_mm = [1, 1, 1]\n"), &["missing field `position_mm`"]);
    refused(
        &format!("{HEAD}[[tile]]\nposition_mm = [1, 2]\n"),
        &["line 4", "is a list of three numbers in mm, not a list of 2"],
    );
    refused(
        &format!("{HEAD}[[tile]]\nposition_mm = \"here\"\n"),
        &["line 4", "is a list of three numbers in mm, not a string"],
    );
    refused(
        &format!("{HEAD}{TILE}{}", VOLUME.replace("0.5", "\"fine\"")),
        &["step_mm is one number in mm, or a list of three"],
    );
    refused(&format!("format = 2\nname = \"later\"\n{TILE}"), &["line 1: layout: format = 2, must be 1"]);
    refused(HEAD, &["layout: has no tiles"]);
}

#[test]
fn sizes_that_are_zero_negative_or_not_finite_are_refused() {
    for (size, message) in [
        ("[1, 0, 1]", "size_mm[1] = 0, must be greater than 0"),
        ("[-1, 1, 1]", "size_mm[0] = -1, must be greater than 0"),
        ("[1, 1, nan]", "size_mm[2] = NaN, must be a finite number"),
        ("[1, 1, inf]", "size_mm[2] = inf, must be a finite number"),
        ("[1, 1, 1e-40]", "shortest side of size_mm = 0.0000000000000000000000000000000000000001, must be at least"),
    ] {
        refused(&format!("{HEAD}{}", TILE.replace("[1, 1, 1]", size)), &["line 3: tile \"a\": ", message]);
    }
}

#[test]
fn polarization_that_is_not_finite_and_zero_axis_are_refused() {
    let text = format!("{HEAD}{}", TILE.replace("[0, 0, 1]", "[nan, 0, -inf]"));
    refused(
        &text,
        &["polarization_t[0] = NaN, must be a finite number", "polarization_t[2] = -inf, must be a finite number"],
    );
    let text = format!("{HEAD}{TILE}rotation = {{ axis = [0, 0, 0], angle_deg = 30 }}\n");
    refused(&text, &["tile \"a\": rotation.axis = [0.0, 0.0, 0.0], must be finite and not zero"]);
}

#[test]
fn all_bad_tiles_are_listed() {
    let bad = |name: &str| TILE.replace("\"a\"", &format!("\"{name}\"")).replace("[1, 1, 1]", "[1, 1, -2]");
    let messages =
        ["tile \"one\": size_mm[2] = -2", "tile \"two\": size_mm[2] = -2", "tile \"three\": size_mm[2] = -2"];
    refused(&format!("{HEAD}{}{}{}", bad("one"), bad("two"), bad("three")), &messages);
}

#[test]
fn overlapping_tiles_are_refused_with_names_and_depth() {
    let other = TILE.replace("\"a\"", "\"b\"").replace("[0, 0, 0]", "[0.75, 0, 0]");
    let touching = TILE.replace("\"a\"", "\"c\"").replace("[0, 0, 0]", "[0, 1, 0]");
    let message = "line 8: tile \"b\": overlaps tile \"a\" before it by 0.25 mm, must not overlap without overlap_mm: move \"b\" that far along +x";
    refused(&format!("{HEAD}{TILE}{other}{touching}"), &[message]);
    // Three digits, rounded up, of a depth with round-off and many digits.
    let deep = other.replace("0.75", "0.66666");
    refused(&format!("{HEAD}{TILE}{deep}"), &["before it by 0.334 mm"]);
    let decimal = other.replace("0.75", "0.7");
    refused(&format!("{HEAD}{TILE}{decimal}"), &["before it by 0.3 mm"]);
}

#[test]
fn overlapping_images_are_told_of_the_tiles_in_the_file() {
    let mirrored = |name: &str, x: &str| {
        TILE.replace("\"a\"", name).replace("[0, 0, 0]", x) + "mirror = { axes = [\"x\", \"y\"] }\n"
    };
    let own = mirrored("\"a\"", "[0.2, 2, 0]");
    refused(
        &format!("{HEAD}{own}"),
        &[
            "line 3: tile \"a\": overlaps its own mirror image by 0.6 mm, must not overlap without overlap_mm: move \"a\" by 0.3 mm along +x",
        ],
    );
    let pair = format!("{HEAD}{}{}", mirrored("\"a\"", "[2, 2, 0]"), mirrored("\"b\"", "[2.75, 2, 0]"));
    let message = "tile \"b\": overlaps tile \"a\" before it by 0.25 mm, must not overlap without overlap_mm: move \"b\" that far along +x";
    refused(&pair, &[message]);
    let sandbox = Sandbox::new();
    sandbox.write("t.toml", &pair);
    assert_eq!(sandbox.run(&["check", "t.toml"]).stdout.matches("overlaps").count(), 1);
}

#[test]
fn inverted_and_enormous_volumes_are_refused() {
    for (from, to, message) in [
        ("x_mm = [-2, 2]", "x_mm = [2, -2]", "volume: x_mm = [2, -2] is inverted"),
        ("step_mm = 0.5", "step_mm = 0", "volume: step_mm = 0, must be a finite number greater than 0"),
        ("step_mm = 0.5", "step_mm = -0.5", "volume: step_mm = -0.5, must be a finite number greater than 0"),
        ("step_mm = 0.5", "step_mm = 1e-6", "volume: step_mm = 0.000001 makes 3.200e19 points"),
        ("step_mm = 0.5", "step_mm = 1e-6", "must make at most 1e8: use a step of at least 0.0071 mm along each axis"),
        ("step_mm = 0.5", "step_mm = [1, 1, 1e-300]", "must make at most 1e8"),
    ] {
        refused(&format!("{HEAD}{TILE}{IDEAL}{}", VOLUME.replace(from, to)), &[message]);
    }
}

#[test]
fn verbs_refuse_layouts_without_the_tables_they_need() {
    let sandbox = Sandbox::new();
    sandbox.write("bare.toml", &format!("{HEAD}{TILE}"));
    sandbox
        .run(&["field", "bare.toml"])
        .refuses("has no [volume] table to take points from: add one, or give --points");
    sandbox.run(&["compare", "bare.toml"]).refuses("bare.toml: the layout has no [ideal] table, which this needs");
    sandbox.run(&["decouple", "bare.toml"]).refuses("bare.toml: the layout has no [ideal] table, which this needs");
    sandbox.write("no-volume.toml", &format!("{HEAD}{TILE}{IDEAL}"));
    sandbox.run(&["decouple", "no-volume.toml"]).refuses("the layout has no [volume] table");
    assert_eq!(sandbox.run(&["check", "bare.toml"]).status, 0);
}

#[test]
fn volumes_outside_the_range_of_the_theory_are_refused() {
    let sandbox = Sandbox::new();
    let above = VOLUME.replace("[-5, -3]", "[-1, 0]").replace("x_mm = [-2, 2]", "x_mm = [2, 3]");
    sandbox.write("above.toml", &format!("{HEAD}{TILE}{IDEAL}{above}"));
    sandbox.run(&["compare", "above.toml"]).refuses("Eq. 2 of the ideal film holds only for z < 0");
    sandbox.write("reference.toml", &format!("{HEAD}{TILE}{IDEAL}{VOLUME}reference_mm = [0, 0, 3]\n"));
    sandbox
        .run(&["decouple", "reference.toml"])
        .refuses("the point (0, 0, 3) mm of the working volume is not below the film");
    let wide = VOLUME.replace("x_mm = [-2, 2]", "x_mm = [-6, 6]");
    sandbox.write("wide.toml", &format!("{HEAD}{TILE}{IDEAL}{wide}"));
    sandbox.run(&["decouple", "wide.toml"]).refuses("reaches |x| = 6, must stay below half a wavelength, 5");
    // A tile magnetized along x has B_z = 0 on the plane x = 0, which holds the reference point.
    let shear = TILE.replace("[0, 0, 1]", "[1, 0, 0]");
    sandbox.write("shear.toml", &format!("{HEAD}{shear}{IDEAL}{VOLUME}"));
    sandbox.run(&["decouple", "shear.toml"]).refuses("B_z vanishes at the reference point (0, 0, -5)");
}

#[test]
fn long_names_and_control_characters_are_refused() {
    let named = |name: &str| format!("{HEAD}{}", TILE.replace("\"a\"", &format!("\"{name}\"")));
    refused(&named(&"a".repeat(65_536)), &["aaa...\" has 65536 bytes, must have at most 200"]);
    let escape = named("\\u001b[2J");
    refused(&escape, &["name = \"\\u{1b}[2J\" has the character U+001B"]);
    // Paths and syntax errors may cite such characters; they are printed as escapes.
    let sandbox = Sandbox::new();
    sandbox.write("\u{1b}[2J.toml", &escape);
    sandbox.write("broken.toml", "# \u{1b}[2J\u{85}\u{202e}\n");
    for file in ["\u{1b}[2J.toml", "broken.toml"] {
        let said = sandbox.run(&["check", file]);
        said.refuses("\\u{1b}[2J");
        assert!(!said.stdout.contains(|c: char| c != '\n' && c.is_control() || c == '\u{202e}'), "{:?}", said.stdout);
    }
}

/// Each entry is small, and all of them together would take all memory.
#[test]
fn layouts_that_would_take_all_memory_are_refused() {
    let grid = "grid = { count = [2000, 2000, 1], pitch_mm = [2, 2, 2] }\n";
    let grids: String = (0..30).map(|i| format!("{}{grid}", TILE.replace("\"a\"", &format!("\"g{i}\"")))).collect();
    let lattice = "[[lattice]]\nstart_mm = [0, 0, 0]\nheight_mm = 1\nstrength_t = 1\nx = [";
    let stretch = "{ widths_mm = [1], pattern = [1], times = 4000000 },";
    let sandbox = Sandbox::new();
    for (body, message) in [
        (format!("{TILE}{grids}"), "must be at most 4000000 tiles in the whole layout, including the 1 before it"),
        (format!("{lattice}{}]\n", stretch.repeat(200)), "has 800000000 x 800000000 cells"),
        (
            format!("{lattice}{{ widths_mm = [], pattern = [], times = 9000000000000000000 }}]\n"),
            "x[0] has no widths_mm",
        ),
    ] {
        sandbox.write("bad.toml", &format!("{HEAD}{body}"));
        let said = sandbox.run(&["tiles", "bad.toml"]);
        said.refuses(message);
        assert!(said.stderr.lines().count() <= 21, "{}", said.stderr);
    }
}

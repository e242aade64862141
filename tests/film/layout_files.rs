//! Reading of layout files: every table, and the message for every broken rule.

use std::collections::BTreeMap;

use magsplice::layout::LayoutError;
use magsplice::prelude::*;

use crate::shipped::EVERY_KEY;

fn parse(body: &str) -> Result<Layout, LayoutError> {
    Layout::parse(&format!("format = 1\nname = \"test\"\n{body}"), "test.toml")
}

fn layout(body: &str) -> Layout {
    parse(body).unwrap_or_else(|e| panic!("{e}"))
}

fn message(body: &str) -> String {
    parse(body).expect_err("the layout is faulty").to_string()
}

/// The plain form as documented in docs/layout-format.md.
#[test]
fn single_tile_with_ideal_film_and_volume() {
    let layout = layout(
        r#"
        [ideal]
        wavelength_mm = 10.0
        thickness_mm = 1.0
        amplitude_t = 0.12
        [volume]
        x_mm = [-2.0, 2.0]
        y_mm = [-2.0, 2.0]
        z_mm = [-5.0, -3.0]
        step_mm = 0.5
        [[tile]]
        name = "left"
        position_mm = [-2.0, 0.0, 0.5]
        size_mm = [3.3, 1.7, 1.0]
        polarization_t = [0.12, 0.0, 0.0]
        rotation = { axis = [0.0, 0.0, 1.0], angle_deg = 30.0 }
        "#,
    );
    let tile = layout.tiles[0].tile;
    let j = tile.scene_polarization_t();
    assert!((j - 0.12 * DVec3::new(0.75_f64.sqrt(), 0.5, 0.0)).length() < 1e-16);
    let volume = layout.volume.unwrap();
    assert_eq!((volume.grid.counts(), volume.reference_mm), ([9, 9, 5], DVec3::new(0.0, 0.0, -5.0)));
}

#[test]
fn grid_and_mirrors_repeat_a_tile_of_a_kind() {
    let layout = layout(
        r#"
        [kind.square]
        size_mm = [3, 3, 1]
        strength_t = 2.0
        [[tile]]
        name = "a"
        kind = "square"
        direction = [1, 0, 0]
        position_mm = [2, 2, 0]
        grid = { count = [2, 1, 1], pitch_mm = [5, 0, 0], alternate = ["x"] }
        mirror = { axes = ["x", "y"] }
        "#,
    );
    let found: BTreeMap<&str, (DVec3, DVec3)> =
        layout.tiles.iter().map(|t| (t.name.as_str(), (t.tile.position(), t.tile.polarization_t()))).collect();
    assert_eq!(found.len(), 8);
    assert_eq!(found["a-x1"], (DVec3::new(2.0, 2.0, 0.0), 2.0 * DVec3::X));
    assert_eq!(found["a-x2"], (DVec3::new(7.0, 2.0, 0.0), -2.0 * DVec3::X));
    assert_eq!(found["a-x1-mx"], (DVec3::new(-2.0, 2.0, 0.0), -2.0 * DVec3::X));
    assert_eq!(found["a-x2-mx-my"], (DVec3::new(-7.0, -2.0, 0.0), 2.0 * DVec3::X));
}

/// Compares the field of a tile and its image on both sides of the mirror. B is a pseudovector, so
/// "axial" gives a mirror-symmetric magnet, and "reflect" a mirror-symmetric magnet up to the sign.
#[test]
fn field_of_mirrored_rotated_tiles_is_symmetric() {
    for (polarization, signs) in [("reflect", DVec3::new(-1.0, 1.0, 1.0)), ("axial", DVec3::new(1.0, -1.0, -1.0))] {
        let layout = layout(&format!(
            r#"
            [[tile]]
            position_mm = [3, 1, 0]
            size_mm = [2, 1, 0.5]
            polarization_t = [0.3, 0.2, -0.1]
            rotation = {{ axis = [1, 2, 3], angle_deg = 40 }}
            mirror = {{ axes = ["x"], at_mm = [0.5, 0, 0], polarization = "{polarization}" }}
            "#
        ));
        let scene = Scene::new(&layout.bare_tiles());
        let at = |x: f64| scene.field(Quantity::FluxDensity, DVec3::new(x, 0.7, -1.9)).unwrap();
        let (left, right) = (at(0.5 - 1.7), at(0.5 + 1.7));
        assert!((left - signs * right).length() < 1e-14 * left.length(), "{polarization}: {left} and {right}");
    }
    let kept = layout(
        r#"
        [[tile]]
        position_mm = [3, 1, 0]
        size_mm = [2, 1, 0.5]
        polarization_t = [0.3, 0.2, -0.1]
        rotation = { axis = [1, 2, 3], angle_deg = 40 }
        mirror = { axes = ["y"], at_mm = [0, -3, 0], polarization = "keep" }
        "#,
    );
    let [own, image] = [0, 1].map(|i: usize| kept.tiles[i].tile.scene_polarization_t());
    assert!((own - image).length() < 1e-15);
}

#[test]
fn lattice_cut_lines_are_exact_decimals() {
    let layout = layout(
        r#"
        [[lattice]]
        name = "f"
        start_mm = [-10.0, -10.0, 0.0]
        height_mm = 1.0
        strength_t = 0.12
        x = [{ widths_mm = [0.85, 3.3, 1.7, 3.3], pattern = [0, 1, 0, -1] }]
        y = [{ widths_mm = [3.3], pattern = [1], times = 2 }]
        "#,
    );
    let names: Vec<&str> = layout.tiles.iter().map(|t| t.name.as_str()).collect();
    assert_eq!(names, ["f-x1-y1", "f-x1-y2", "f-x2-y1", "f-x2-y2", "f-x3-y1", "f-x3-y2", "f-x4-y1", "f-x4-y2"]);
    assert_eq!(layout.tiles[2].tile.position(), DVec3::new(-7.5, -8.35, 0.5));
    assert_eq!(layout.tiles[2].tile.size(), DVec3::new(3.3, 3.3, 1.0));
    assert!((layout.tiles[6].tile.polarization_t() - 0.12 * DVec3::new(-1.0, 1.0, 0.0).normalize()).length() < 1e-17);
}

/// Every fault of a file is reported with its line, place, value and rule.
#[test]
fn all_faults_are_reported_at_once() {
    let text = message(
        r#"
        [ideal]
        wavelength_mm = -10.0
        thickness_mm = 0.0
        amplitude_t = inf
        [volume]
        x_mm = [2.0, -2.0]
        y_mm = [1.0, 1.0]
        z_mm = [-5.0, nan]
        step_mm = 0.0
        [kind.bad]
        size_mm = [1.0, 0.0, 1.0]
        strength_t = -1.0
        [[tile]]
        name = "rim-3"
        position_mm = [0.0, 0.0, 0.0]
        size_mm = [1.0, -1.0, inf]
        polarization_t = [nan, 0.0, 0.0]
        [[tile]]
        position_mm = [inf, 0.0, 0.0]
        size_mm = [1.0, 1.0, 1.0]
        polarization_t = [0.0, 0.0, 1.0]
        rotation = { axis = [0.0, 0.0, 0.0], angle_deg = inf }
        [[tile]]
        name = "c"
        kind = "goood"
        position_mm = [9.0, 0.0, 0.0]
        [[tile]]
        name = "d"
        position_mm = [9.0, 0.0, 0.0]
        direction = [0, 0, 0]
        strength_t = 1
        "#,
    );
    let expected = [
        "test.toml: line 4: ideal: wavelength_mm = -10, must be a finite number greater than 0",
        "test.toml: line 4: ideal: thickness_mm = 0, must be a finite number greater than 0",
        "test.toml: line 4: ideal: amplitude_t = inf, must be a finite number other than 0",
        "test.toml: line 8: volume: x_mm = [2, -2] is inverted, the first must not be greater than the second",
        "test.toml: line 8: volume: z_mm = [-5, NaN], must be two finite numbers",
        "test.toml: line 8: volume: step_mm = 0, must be a finite number greater than 0",
        "test.toml: line 13: kind \"bad\": strength_t = -1, must be a finite number of at least 0 (reverse the direction instead)",
        "test.toml: line 13: kind \"bad\": size_mm[1] = 0, must be greater than 0",
        "test.toml: line 16: tile \"rim-3\": size_mm[1] = -1, must be greater than 0",
        "test.toml: line 16: tile \"rim-3\": size_mm[2] = inf, must be a finite number",
        "test.toml: line 16: tile \"rim-3\": polarization_t[0] = NaN, must be a finite number",
        "test.toml: line 21: tile \"tile-2\": rotation.axis = [0.0, 0.0, 0.0], must be finite and not zero",
        "test.toml: line 21: tile \"tile-2\": rotation.angle_deg = inf, must be a finite number",
        "test.toml: line 21: tile \"tile-2\": position_mm[0] = inf, must be a finite number",
        "test.toml: line 26: tile \"c\": kind = \"goood\", must be declared as [kind.goood] (declared: bad)",
        "test.toml: line 30: tile \"d\": has no size_mm and no kind that gives it",
        "test.toml: line 30: tile \"d\": direction = [0.0, 0.0, 0.0], must be finite and not zero",
    ];
    let mut found: Vec<&str> = text.lines().collect();
    for line in expected {
        let at = found.iter().position(|f| *f == line).unwrap_or_else(|| panic!("missing: {line}\nreported:\n{text}"));
        found.remove(at);
    }
    assert_eq!(found, [""; 0], "reported without a fault");
}

#[test]
fn faulty_grids_mirrors_names_and_lattices_are_refused() {
    let tile = "position_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
    let cases = [
        ("grid = { count = [0, 1, 1], pitch_mm = [1, 1, 1] }", "grid.count = [0, 1, 1], must be at least 1"),
        ("grid = { count = [90000, 90000, 1], pitch_mm = [1, 1, 1] }", "at most 4000000 tiles"),
        ("grid = { count = [2, 1, 1], pitch_mm = [0.9, 0, 0] }", "before it by 0.1 mm"),
        ("mirror = { axes = [] }", "mirror.axes is empty"),
        ("mirror = { axes = [\"x\"] }", "overlaps its own mirror image by 1 mm"),
        (
            "grid = { count = [2, 1, 1], pitch_mm = [inf, 0, 0] }",
            "grid.pitch_mm = [inf, 0.0, 0.0], must be three finite",
        ),
        (
            "grid = { count = [2, 1, 1], pitch_mm = [2, 0, 0], alternate = [\"x\", \"x\"] }",
            "grid.alternate names \"x\" twice",
        ),
        ("mirror = { axes = [\"x\", \"x\"] }", "mirror.axes names \"x\" twice"),
        ("mirror = { axes = [\"x\"], at_mm = [3, nan, 0] }", "mirror.at_mm = [3.0, NaN, 0.0], must be three finite"),
    ];
    for (repetition, expected) in cases {
        let text = message(&format!("[[tile]]\n{tile}{repetition}\n"));
        assert!(text.contains(expected), "{repetition}: {text}");
    }
    let twice = message(&format!("[[tile]]\nname = \"a\"\n{tile}[[tile]]\nname = \"a\"\n{tile}"));
    assert!(twice.contains("2 tiles have this name"), "{twice}");
    let lattice = message(
        "[[lattice]]\nstart_mm = [0, 0, 0]\nheight_mm = 1\nstrength_t = 1\nx = [{ widths_mm = [1, -2], pattern = [1] }]\n",
    );
    let empty = message(
        "[[lattice]]\nstart_mm = [0, 0, 0]\nheight_mm = 1\nstrength_t = 1\nx = [{ widths_mm = [1], pattern = [0] }]\n",
    );
    let infinite = message(
        "[[lattice]]\nstart_mm = [0, inf, 0]\nheight_mm = 1\nstrength_t = 1\nx = [{ widths_mm = [1], pattern = [1] }]\n",
    );
    assert!(infinite.ends_with("start_mm[1] = inf, must be a finite number"), "{infinite}");
    assert!(empty.contains("has no tiles: pattern is zero everywhere"), "{empty}");
    assert!(lattice.contains("2 widths_mm and 1 pattern") && lattice.contains("widths_mm[1] = -2"), "{lattice}");
}

#[test]
fn polarization_must_be_given_exactly_once() {
    let size = "position_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\n";
    let cases = [
        ("", "has no polarization"),
        ("polarization_t = [0, 0, 1]\nstrength_t = 1\ndirection = [1, 0, 0]", "gives its polarization twice"),
        ("polarization_t = [0, 0, 1]\ndirection = [1, 0, 0]", "gives a direction"),
        ("strength_t = 1", "has a strength_t and no direction"),
    ];
    for (keys, expected) in cases {
        let text = message(&format!("[[tile]]\n{size}{keys}\n"));
        assert!(text.contains(expected), "{keys}: {text}");
    }
}

#[test]
fn findings_name_idle_kinds_idle_tiles_and_tiles_in_the_volume() {
    let layout = layout(
        r#"
        [volume]
        x_mm = [0.0, 1.0]
        y_mm = [0.0, 1.0]
        z_mm = [0.0, 1.0]
        step_mm = [0.3, 0.5, 0.1]
        [kind.idle]
        size_mm = [1, 1, 1]
        [[tile]]
        position_mm = [0, 0, 0]
        size_mm = [1, 1, 1]
        polarization_t = [0, 0, 0]
        "#,
    );
    let expected =
        ["does not divide x_mm", "kind \"idle\" is declared", "has no polarization", "reaches into the working volume"];
    assert_eq!(layout.findings.len(), expected.len(), "{:?}", layout.findings);
    for (finding, expected) in layout.findings.iter().zip(expected) {
        assert!(finding.message.contains(expected), "{finding}");
    }
    assert_eq!(layout.volume.unwrap().grid.counts(), [4, 3, 11]);
    assert!((layout.volume.unwrap().grid.upper().x - 0.9).abs() < 1e-15);
}

const TABLES: &str = "[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.12\n\
                      [volume]\nx_mm = [-2, 2]\ny_mm = [-2, 2]\nz_mm = [-5, -3]\nstep_mm = 1\n";
const TILE: &str = "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";

#[test]
fn expectations_survive_a_round_trip() {
    let expect = "[expect]\nuniformity_rmse = { r_x = 0.065, s_z = 0.042 }\namplitude = { min = 0.80 }\n\
                  field = { file = \"published.field.csv\", within = 1e-9 }\nclearance_mm = { min = 0.0 }\n";
    let found = layout(&format!("{TABLES}{expect}{TILE}"));
    let expected = found.expectations.clone();
    assert_eq!(expected.bounds.uniformity_rmse.to_array(), [Some(0.065), None, Some(0.042)]);
    assert_eq!((expected.bounds.least_amplitude, expected.least_clearance_mm), (Some(0.8), Some(0.0)));
    let field = expected.field.unwrap();
    assert_eq!((field.file.to_str(), field.within), (Some("published.field.csv"), 1e-9));
    // The plain form has the same expectations.
    assert_eq!(Layout::parse(&found.to_toml(), "plain").unwrap().expectations, found.expectations);
    assert!(layout(TILE).expectations.is_empty() && !layout(TILE).to_toml().contains("expect"));
}

#[test]
fn faulty_expectations_are_refused() {
    let cases = [
        (
            TABLES,
            "",
            &["expect is empty, must give at least one of amplitude, clearance_mm, displacement_rmse_mm, field, made"]
                [..],
        ),
        (TABLES, "uniformity_rmse = {}", &["uniformity_rmse is empty, must give at least one of r_x, r_y, s_z"]),
        (
            TABLES,
            "uniformity_rmse = { r_x = -1, r_y = nan, s_z = inf }\namplitude = { min = nan }\n\
             field = { file = \"\", within = 0 }\nclearance_mm = { min = -inf }",
            &[
                "test.toml: line 12: expect: uniformity_rmse.r_x = -1, must be a finite number of at least 0",
                "uniformity_rmse.r_y = NaN, must be",
                "uniformity_rmse.s_z = inf, must be",
                "amplitude.min = NaN, must be a finite number",
                "clearance_mm.min = -inf, must be a finite number",
                "field.file is empty, must name a CSV file",
                "field.within = 0, must be a finite number greater than 0",
            ],
        ),
        (
            "",
            "uniformity_rmse = { r_x = 1 }\namplitude = { min = 1 }\nclearance_mm = { min = 0 }",
            &[
                "expect: uniformity_rmse needs the table [ideal], which the layout does not have",
                "expect: uniformity_rmse needs the table [volume]",
                "expect: amplitude needs the table [ideal]",
                "expect: amplitude needs the table [volume]",
                "expect: clearance_mm needs the table [volume]",
            ],
        ),
        (TABLES, "uniformity_rmse = { r_z = 1 }", &["unknown field `r_z`"]),
        (TABLES, "clearance_mm = { max = 1 }", &["unknown field `max`"]),
        (TABLES, "amplitude = 0.8", &["amplitude is a table, not a number: write `amplitude = { min = 0.8 }`"]),
        (TABLES, "field = { file = \"a.csv\" }", &["missing field `within`"]),
    ];
    for (tables, expect, messages) in cases {
        let text = message(&format!("{tables}[expect]\n{expect}\n{TILE}"));
        for message in messages {
            assert!(text.contains(message), "{expect}: missing: {message}\nreported: {text}");
        }
        let problems = text.lines().filter(|l| l.contains("expect: ")).count();
        assert!(problems == 0 || problems == messages.len(), "{expect}: {text}");
    }
}

/// A surplus number is refused in every list of fixed length.
#[test]
fn lists_that_are_too_long_are_refused() {
    let any_length = ["widths_mm", "pattern", "values"];
    let extra = ["quaternion = [0, 0, 0, 1]", "euler_deg = [0, 0, 90], order = \"xyz\""]
        .map(|rotation| EVERY_KEY.replace("axis = [0, 0, 1], angle_deg = 30", rotation));
    let matrix = EVERY_KEY.replace("axis = [0, 0, 1], angle_deg = 30", "matrix = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]");
    let mut lists = 0;
    for text in [EVERY_KEY.to_owned(), matrix].iter().chain(&extra) {
        Layout::parse_beside(text, "every key", "tests/film").expect("a layout");
        for (open, _) in text.match_indices('[') {
            let Some(close) = text[open..].find(']').map(|length| open + length) else { continue };
            let inside = &text[open + 1..close];
            let is_numbers = inside.split(',').all(|number| number.trim().parse::<f64>().is_ok());
            let key = text[..open].trim_end().trim_end_matches('=').trim_end();
            let key = key.rsplit([' ', '\n', '{']).next().unwrap_or_default();
            if !is_numbers || any_length.contains(&key) {
                continue;
            }
            lists += 1;
            let longer = format!("{}, 7{}", &text[..close], &text[close..]);
            let found = Layout::parse_beside(&longer, "every key", "tests/film");
            assert!(found.is_err(), "{key} = [{inside}, 7]");
        }
    }
    assert!(lists > 100, "{lists}");
}

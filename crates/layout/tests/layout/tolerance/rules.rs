//! Rules of `[tolerance]` and `[expect.made]`.

use super::writing::assert_is_written;
use super::*;

#[test]
fn each_rule_states_value_and_place() {
    assert!(parse("[tolerance]\nstrength = { normal = 0.1, within = 0.001 }").is_ok());
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
        (with("[[tolerance.tile]]\ntiles = []\nstrength = 0"), "tiles is empty, must have at least one tile"),
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
        (with("[tolerance.iron]\ndistance_mm = 0"), "tolerance.iron: distance_mm = 0, must be above 0"),
        (
            with("[tolerance.iron]\ndistance_mm = 1\ndistance_error_mm = 0.1"),
            "tolerance.iron: distance_error_mm reaches the film in some samples, must be less than distance_mm = 1",
        ),
        (
            with("[tolerance.iron]\ndistance_mm = 1\ndistance_error_mm = { normal = 0.5, within = 1 }"),
            "distance_error_mm reaches the film in some samples",
        ),
        (
            with("[tolerance.iron]\ndistance_mm = 1\nrelative_permeability = 0.5"),
            "tolerance.iron: relative_permeability = 0.5, must be at least 1, or inf",
        ),
        (with("[tolerance.iron]\ndistance_mm = 1\nnormal = [0, 0, 1]"), "tolerance.iron: [volume] reaches "),
        (
            with("[tolerance.iron]\ndistance_mm = 1\nnormal = [0, 0, 0]"),
            "tolerance.iron: normal = [0, 0, 0] has no direction",
        ),
        (
            with("[tolerance.iron]\ndistance_mm = 1\n[[plane]]\npoint_mm = [0, 0, 90]\nnormal = [0, 0, -1]"),
            "tolerance.iron: stands beside [[plane]], must be alone",
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
    // The name of the table is short enough, those of its rows are not.
    let rows = with(&format!("[[tolerance.group]]\nname = \"{}\"\nrows_along = \"x\"\nstrength = 0.1", &long[1..]));
    cases.push((rows, "must have at most 200"));
    for (tables, rule) in cases {
        let message = parse(&tables).expect_err(&tables);
        assert!(message.starts_with("test.toml: line ") && message.contains(rule), "{tables:?}: {message}");
        assert_eq!(message.lines().count(), 1, "{tables:?}: {message}");
    }
    // A distribution of the wrong type or with an unknown key is a syntax error with its place.
    for (tables, rule) in [
        (strength_of("\"1 %\""), "strength is one number, or a table such as { uniform = 0.1 }, not a string"),
        (strength_of("{ sigma = 1 }"), "unknown field `sigma`"),
        (
            with("position_mm = [1, 2]"),
            "a table such as { uniform = 0.1 }, or a list of three of them, not a list of 2",
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
        ("[tolerance]", "tolerance: has no errors"),
        ("[tolerance]\nsamples = 10", "tolerance: has no errors"),
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
    // The least that is not in doubt.
    assert_eq!(findings("[tolerance.sensor]\nnoise_ut = 0.001"), Vec::<String>::new());
    let alone = Layout::parse(&format!("{HEAD}[tolerance]\npreset = \"jig\"\n{TILES}"), "test").expect("valid");
    let found: Vec<String> = alone.findings.iter().map(Finding::to_string).collect();
    assert!(found.len() == 1 && found[0].contains("only together with [ideal] and [volume]"), "{found:?}");
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
    assert!(message.contains("the number of tiles in the layout must be at most 10000000"), "{message}");
    let values = vec!["0.1"; 60_000].join(",");
    let entries = (0..20).fold(String::new(), |mut text, _| {
        let _ = write!(text, "[[tolerance.tile]]\ntiles = [\"bar\"]\nstrength = {{ values = [{values}] }}\n");
        text
    });
    let message = parse(&entries).expect_err("too many values");
    assert!(
        message.contains("strength: the layout has too many tabulated values") && message.contains("at most 1000000"),
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
    assert!(
        parse(&rows).expect_err("too many values").contains("this group: the layout has too many tabulated values")
    );
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
        bounds: FigureBounds {
            uniformity_rmse: [Some(0.07), None, Some(0.05)].into(),
            displacement_rmse_mm: [Some(0.03), None, None].into(),
            least_amplitude: Some(0.8),
        },
        samples: Some(400),
        confidence: 0.99,
    };
    assert_eq!(all.expectations.made, Some(wanted));
    assert_is_written(&all, std::path::Path::new(""));
    let least = made("amplitude = { min = 0.8 }").expect("valid").expectations.made.expect("stated");
    assert_eq!(
        least,
        MadeExpectations {
            bounds: FigureBounds { least_amplitude: Some(0.8), ..FigureBounds::default() },
            ..MadeExpectations::default()
        }
    );
    assert_eq!((least.percentile, least.samples, least.confidence), (95.0, None, 0.95));
    for (keys, rule) in [
        ("", "has no bound, must give at least one of uniformity_rmse, displacement_rmse_mm, amplitude"),
        ("displacement_rmse_mm = { x = -1 }", "displacement_rmse_mm.x = -1, must be a finite number of at least 0"),
        ("amplitude = { min = nan }", "amplitude.min = NaN"),
        ("amplitude = { min = 0 }\npercentile = 0", "percentile = 0, must be greater than 0 and less than 100"),
        ("amplitude = { min = 0 }\npercentile = 100", "percentile = 100, must be greater than 0 and less than 100"),
        ("amplitude = { min = 0 }\npercentile = 1", "percentile = 1, must be greater than 1 (per cent: 100?)"),
        (
            "amplitude = { min = 0 }\nconfidence = 1",
            "confidence = 1, must be greater than 0 and less than 1 (a fraction",
        ),
        ("amplitude = { min = 0 }\nconfidence = 100", "confidence = 100, must be greater than 0 and less than 1"),
        ("amplitude = { min = 0 }\npercentile = 0.95", "percentile = 0.95, must be greater than 1 (per cent: 95?)"),
        (
            "amplitude = { min = 0 }\nconfidence = 95",
            "confidence = 95, must be greater than 0 and less than 1 (a fraction, not per cent: 0.95?)",
        ),
        ("amplitude = { min = 0 }\nconfidence = 0", "confidence = 0, must be greater than 0 and less than 1"),
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

//! `diagnose`: films with known errors, and the layouts that are written of them.

use std::fmt::Write;

use serde_json::Value;

use crate::{Sandbox, rows};

/// Six tiles side by side: name, x, y, and J along x or y.
const TILES: [(&str, f64, f64, [f64; 2]); 6] = [
    ("left-low", -3.4, -1.0, [0.12, 0.0]),
    ("middle-low", 0.0, -1.0, [-0.12, 0.0]),
    ("right-low", 3.4, -1.0, [0.12, 0.0]),
    ("left-high", -3.4, 1.0, [0.0, 0.12]),
    ("middle-high", 0.0, 1.0, [0.0, -0.12]),
    ("right-high", 3.4, 1.0, [0.0, 0.12]),
];

const TABLES: &str = "format = 1\nname = \"six tiles\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\n\
                      amplitude_t = 0.12\n[volume]\nx_mm = [-1.0, 1.0]\ny_mm = [-1.0, 1.0]\nz_mm = [-5.0, -4.0]\n\
                      step_mm = 1.0\n[expect]\namplitude = { min = 0.9 }\n";

/// The layout with errors of tiles: index, shift along x, strength, angle about z.
fn layout(errors: &[(usize, f64, f64, f64)]) -> String {
    let mut text = TABLES.to_owned();
    for (index, (name, x, y, j_t)) in TILES.into_iter().enumerate() {
        let (shift, strength, angle) =
            errors.iter().find(|error| error.0 == index).map_or((0.0, 1.0, 0.0), |error| (error.1, error.2, error.3));
        let [jx, jy] = j_t.map(|component| component * strength);
        let _ = writeln!(
            text,
            "[[tile]]\nname = \"{name}\"\nposition_mm = [{:?}, {y:?}, 0.5]\nsize_mm = [3.4, 2.0, 1.0]\n\
             polarization_t = [{jx:?}, {jy:?}, 0.0]\nrotation = {{ axis = [0.0, 0.0, 1.0], angle_deg = {angle:?} }}",
            x + shift
        );
    }
    // What is made may overlap.
    text.replacen("name =", "overlap_mm = 1.0\nname =", 1)
}

/// Writes the nominal film and a scan of one with errors, 1 mm below it, in steps of 1 mm, with
/// noise of 10 uT.
fn scanned(errors: &[(usize, f64, f64, f64)]) -> Sandbox {
    scanned_of(errors, "")
}

/// The same, with these lines in both layouts.
fn scanned_of(errors: &[(usize, f64, f64, f64)], material: &str) -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", &(layout(&[]).replacen("overlap_mm = 1.0\n", "", 1) + material));
    sandbox.write("made.toml", &(layout(errors) + material));
    let mut points = "x_mm,y_mm,z_mm\n".to_owned();
    for (x, y) in (-6..=6).flat_map(|x| (-3..=3).map(move |y| (x, y))) {
        let _ = writeln!(points, "{x},{y},-1");
    }
    sandbox.write("points.csv", &points);
    let said = sandbox.run(&["field", "made.toml", "--points", "points.csv", "--quiet"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let mut state = 1_u64;
    // Twelve uniform numbers less 6 have mean 0 and deviation 1.
    let mut normal = || {
        (0..12)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1_u64 << 53) as f64
            })
            .sum::<f64>()
            - 6.0
    };
    let mut scan = "x_mm,y_mm,z_mm,bx_ut,by_ut,bz_ut\n".to_owned();
    for row in rows(&said.stdout) {
        let b: Vec<String> = row[3..6].iter().map(|b| format!("{:?}", 1e6 * b + 10.0 * normal())).collect();
        let _ = writeln!(scan, "{:?},{:?},{:?},{}", row[0], row[1], row[2], b.join(","));
    }
    sandbox.write("scan.csv", &scan);
    sandbox
}

const FAULTY: [(usize, f64, f64, f64); 3] = [(1, 0.1, 1.0, 0.0), (3, 0.0, 0.95, 0.0), (5, 0.0, 1.0, 3.0)];

fn run(sandbox: &Sandbox, options: &[&str]) -> crate::RunOutput {
    sandbox.run(&[&["diagnose", "film.toml", "--scan", "scan.csv", "--noise", "10uT"], options].concat())
}

/// Values are within five of their deviations.
#[test]
fn faulty_tiles_are_reported_with_their_errors() {
    let sandbox = scanned(&FAULTY);
    let said = run(&sandbox, &["--format", "json", "--quiet"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let found: Value = serde_json::from_str(&said.stdout).expect("JSON");
    let faulty = found["faulty"].as_array().expect("a list");
    let mut names: Vec<(&str, &str)> =
        faulty.iter().map(|of| (of["tile"].as_str().unwrap(), of["kind"].as_str().unwrap())).collect();
    names.sort_unstable();
    assert_eq!(names, [("left-high", "strength"), ("middle-low", "displacement"), ("right-high", "turn")]);
    for (tile, component, value) in [
        ("left-high", "strength_percent", -5.0),
        ("middle-low", "position_x_mm", 0.1),
        ("right-high", "rotation_z_deg", 3.0),
    ] {
        let of_tile = faulty.iter().find(|of| of["tile"] == tile).expect("a faulty tile");
        let [found, deviation] = [0, 1].map(|n| of_tile["components"][component][n].as_f64().expect("a number"));
        assert!((found - value).abs() < 5.0 * deviation && deviation < 0.1 * f64::abs(value), "{found} +- {deviation}");
    }
    assert_eq!(found["is_residual_too_large"], false);
    let text = run(&sandbox, &[]).stdout;
    assert!(text.contains("3 errors:") && text.contains("  left-high: ") && text.contains("% too weak"), "{text}");
    let csv = run(&sandbox, &["--format", "csv"]).stdout;
    assert_eq!(csv.lines().count(), 1 + 1 + 3 + 3, "{csv}");
    assert!(csv.contains("\"left-high\",strength,strength_percent,"), "{csv}");
}

/// What recoil adds to the field is that of the film as ordered, and is no error of a tile.
#[test]
fn weak_tile_among_tiles_with_recoil_is_found_alone() {
    let sandbox = scanned_of(&[(3, 0.0, 0.95, 0.0)], "[material]\nrecoil_permeability = 1.05\n");
    let said = run(&sandbox, &["--format", "json", "--quiet"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let found: Value = serde_json::from_str(&said.stdout).expect("JSON");
    let faulty = found["faulty"].as_array().expect("a list");
    assert!(faulty.len() == 1 && faulty[0]["tile"] == "left-high" && faulty[0]["kind"] == "strength", "{found}");
    let strength = faulty[0]["components"]["strength_percent"][0].as_f64().expect("a number");
    // What the weak tile changes in itself and in others is neglected: 2 % of its change.
    assert!((strength + 5.0).abs() < 0.2, "{strength}");
    assert!(found["recoil"]["cells"].as_u64().is_some_and(|cells| cells > 6), "{found}");
    // The same scan of rigid tiles is of another film.
    sandbox.write("film.toml", &layout(&[]).replacen("overlap_mm = 1.0\n", "", 1));
    let rigid: Value = serde_json::from_str(&run(&sandbox, &["--format", "json", "-q"]).stdout).expect("JSON");
    let is_list = rigid["faulty"].as_array().is_some_and(|faulty| faulty.len() > 1);
    assert!(is_list || rigid["is_rejected"] == true, "{rigid}");
}

/// Readings 2 mT off, saturated ones and missing ones are named. No tile is blamed for them, and
/// faulty tiles are found beside them.
#[test]
fn excluded_readings_are_no_errors_of_tiles() {
    for (errors, named) in [(&[][..], "no faulty tile"), (&FAULTY[1..], "2 errors, by 88 of 91 readings:")] {
        let sandbox = scanned(errors);
        let mut lines: Vec<String> = sandbox.read("scan.csv").lines().map(str::to_owned).collect();
        let with = |line: &str, column: usize, change: &dyn Fn(f64) -> f64| -> String {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            cells[column] = format!("{:?}", change(cells[column].parse().expect("a number")));
            cells.join(",")
        };
        for (line, off_ut) in [(20, 2000.0), (60, -400.0)] {
            lines[line] = with(&lines[line], 4, &|by_ut| by_ut + off_ut);
        }
        lines[33] = with(&lines[33], 3, &|_| f64::NAN);
        sandbox.write("scan.csv", &(lines.join("\n") + "\n"));
        let said = run(&sandbox, &[]);
        assert!(said.stdout.contains(named), "{}", said.stdout);
        let counted = |reason: &str, count: usize| {
            let row = said.stdout.lines().find(|line| line.starts_with(reason));
            assert!(row.is_some_and(|row| row.ends_with(&format!(" {count}"))), "{reason}: {}", said.stdout);
        };
        counted("incomplete, excluded", 1);
        counted("outliers, excluded", 2);
        for line in ["line 21: excluded as an outlier", "line 34: excluded as incomplete", "line 61: excluded as"] {
            assert!(said.stderr.contains(line), "{line}: {}", said.stderr);
        }
    }
}

/// A scan with exchanged axes, or of a sensor 1 mm beside, is refused with the explanation. No
/// error of a tile is listed, and no layout is written.
#[test]
fn placements_that_explain_a_scan_come_before_errors_of_tiles() {
    let sandbox = scanned(&[]);
    let scan = sandbox.read("scan.csv");
    sandbox.write("scan.csv", &scan.replacen("bx_ut,by_ut", "by_ut,bx_ut", 1));
    let said = run(&sandbox, &["-o", "found.toml"]);
    said.refuses("scan.csv: the film as ordered explains the scan to 9.3 uT");
    said.refuses("axes of the sensor: x and y are exchanged: name the columns of the field by, bx, bz");
    assert!(!sandbox.path("found.toml").exists());
    let beside = scan.lines().skip(1).map(|line| {
        let (x, rest) = line.split_once(',').expect("columns");
        format!("{:?},{rest}", x.parse::<f64>().expect("a number") + 1.0)
    });
    sandbox.write("scan.csv", &(scan.lines().take(1).map(str::to_owned).chain(beside).collect::<Vec<_>>().join("\n")));
    run(&sandbox, &[]).refuses("start (-1.00");
    let said = run(&sandbox, &["--fit"]);
    assert!(said.status == 0 && said.stdout.contains("no faulty tile"), "{}{}", said.stdout, said.stderr);
}

/// The film that was found has no requirements, allows the overlap of its tiles, and is taken by
/// the verbs that evaluate films.
#[test]
fn found_film_is_a_layout() {
    let sandbox = scanned(&FAULTY);
    let said = run(&sandbox, &["-o", "found.toml", "--quiet"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let found = sandbox.read("found.toml");
    assert!(found.contains("overlap_mm = 0.1") && !found.contains("[expect]"), "{found}");
    assert!(found.contains("diagnose: from \"six tiles\""), "{found}");
    for verb in [
        &["decouple", "found.toml"][..],
        &["tolerance", "found.toml", "--samples", "2", "--preset", "workshop"],
        &["tiles", "found.toml"],
        &["diagnose", "found.toml", "--scan", "scan.csv", "--noise", "10uT"],
    ] {
        let said = sandbox.run(verb);
        assert_eq!(said.status, 0, "{verb:?}: {}", said.stderr);
    }
    // The film that was found explains its scan.
    let again = sandbox.run(&["diagnose", "found.toml", "--scan", "scan.csv", "--noise", "10uT"]).stdout;
    assert!(again.contains("no faulty tile"), "{again}");
}

/// A tile laid the wrong way round is called reversed, without J missing. Three readings show
/// hardly a faulty tile.
#[test]
fn reversed_tiles_and_scans_of_few_readings_are_named() {
    let sandbox = scanned(&[(1, 0.0, -1.0, 0.0)]);
    for preset in [&[][..], &["--preset", "workshop"]] {
        let said = run(&sandbox, preset);
        assert!(said.stdout.contains("  middle-low: reversed, with "), "{}{}", said.stdout, said.stderr);
    }
    for (strength, words) in
        [(-1.05, "middle-low: reversed, with 105"), (0.0, "middle-low: missing, or not magnetized")]
    {
        let said = run(&scanned(&[(1, 0.0, strength, 0.0)]), &["--preset", "workshop"]);
        assert!(said.stdout.contains(words), "{}{}", said.stdout, said.stderr);
    }
    let few: Vec<String> = sandbox.read("scan.csv").lines().take(4).map(str::to_owned).collect();
    sandbox.write("scan.csv", &(few.join("\n") + "\n"));
    let said = run(&sandbox, &["--preset", "workshop"]);
    assert!(
        said.stderr.contains("3 readings are fewer than 6 tiles: most faulty tiles do not show"),
        "{}",
        said.stderr
    );
}

/// A stray field that is not fitted is named with its value, beside errors of a workshop.
#[test]
fn offsets_that_explain_a_rejected_scan_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("[sensor]\nnoise_ut = 5");
    let points: Vec<String> = (0..441).map(|n| format!("{},{},-1", n % 21 - 10, n / 21 - 10)).collect();
    sandbox.write("points.csv", &format!("x_mm,y_mm,z_mm\n{}\n", points.join("\n")));
    let sample = ["--preset", "workshop", "--index", "3", "--points", "points.csv", "--scan", "scan.csv"];
    assert_eq!(sandbox.run(&[&["tolerance", "sample", &film][..], &sample].concat()).status, 0);
    let stray = |row: &[f64]| [row[0], row[1], row[2], row[3] + 3e-4, row[4], row[5]];
    let lines: Vec<String> = rows(&sandbox.read("scan.csv"))
        .iter()
        .map(|row| stray(row).map(|value| format!("{value:?}")).join(","))
        .collect();
    sandbox.write("scan.csv", &format!("x_mm,y_mm,z_mm,bx_t,by_t,bz_t\n{}\n", lines.join("\n")));
    let diagnose = ["diagnose", &film, "--scan", "scan.csv", "--preset", "workshop"];
    let said = sandbox.run(&diagnose);
    let explained = "errors of tiles explain the scan with strength ";
    let offset =
        said.stderr.split(explained).nth(1).and_then(|rest| rest.split("offset (").nth(1)).expect(&said.stderr);
    let x_ut: f64 = offset.split(',').next().and_then(|x| x.parse().ok()).expect(offset);
    // The program states a standard deviation of 0.33 uT.
    assert!((x_ut - 300.0).abs() < 2.5, "{}", said.stderr);
    assert!(!said.stderr.contains("chi squared"), "{}", said.stderr);
    let fitted = sandbox.run(&[&diagnose[..], &["--fit"]].concat());
    assert!(fitted.stdout.contains("no faulty tile"), "{}", fitted.stderr);
    let coarse = sandbox.run(&["diagnose", &film, "--scan", "scan.csv", "--preset", "by-hand", "--fit"]);
    assert!(coarse.stderr.contains("the expected errors are larger than those of the film"), "{}", coarse.stderr);
}

/// A sensor whose gain is 0.93 makes every tile 7 % weaker: one strength of all tiles explains it,
/// and no tile is named.
#[test]
fn one_strength_is_likelier_than_errors_of_every_tile() {
    let weaker: Vec<(usize, f64, f64, f64)> = (0..TILES.len()).map(|tile| (tile, 0.0, 0.93, 0.0)).collect();
    let sandbox = scanned(&weaker);
    let said = run(&sandbox, &[]);
    assert!(said.stdout.contains("taken otherwise than stated, so no tile is reported"), "{}", said.stdout);
    let strength = said.stderr.split("explain the scan with strength ").nth(1).expect(&said.stderr);
    let strength: f64 = strength.split(',').next().and_then(|value| value.parse().ok()).expect(strength);
    assert!((strength - 0.93).abs() < 0.005, "{}", said.stderr);
    assert!(run(&sandbox, &["--fit"]).stdout.contains("no faulty tile"));
}

/// The origin of a stage changes the start of a scan and nothing else. Columns exchanged in a
/// circle, and z counted downwards on one plane, are refused, by hand too.
#[test]
fn stages_and_axes_of_scans_of_films_as_made() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("[sensor]\nnoise_ut = 5");
    type Change = fn(&[f64]) -> [f64; 6];
    let changed = |change: Change| {
        let lines: Vec<String> = rows(&sandbox.read("scan.csv"))
            .iter()
            .map(|row| change(row).map(|value| format!("{value:?}")).join(","))
            .collect();
        sandbox.write("changed.csv", &format!("x_mm,y_mm,z_mm,bx_t,by_t,bz_t\n{}\n", lines.join("\n")));
        "changed.csv"
    };
    let sample = |preset: &str, points: &[&str]| {
        let sample = ["tolerance", "sample", &film, "--preset", preset, "--index", "3", "--scan", "scan.csv"];
        assert_eq!(sandbox.run(&[&sample[..], points].concat()).status, 0);
    };
    sample("workshop", &[]);
    let fitted = |scan: &str, shift_mm: f64| -> Vec<f64> {
        let said =
            sandbox.run(&["diagnose", &film, "--scan", scan, "--preset", "workshop", "--fit", "--format", "json"]);
        assert_eq!(said.status, 0, "{}", said.stderr);
        assert!(!said.stderr.contains("bias"), "{}", said.stderr);
        let found: Value = serde_json::from_str(&said.stdout).expect("JSON");
        let z_mm = found["scan"]["start_mm"][2].as_f64().expect("a number");
        vec![found["scan"]["strength"].as_f64().expect("a number"), z_mm + shift_mm]
    };
    let near = fitted("scan.csv", 0.0);
    let far = fitted(changed(|row| [row[0], row[1], row[2] + 200.0, row[3], row[4], row[5]]), 200.0);
    // Steps end at a thirtieth of a standard deviation, 0.02 and 0.04 mm.
    assert!(near.iter().zip(&far).all(|(near, far)| (near - far).abs() < 0.002), "{near:?} {far:?}");
    let refused = |scan: &str, preset: &str, named: &str| {
        sandbox.run(&["diagnose", &film, "--scan", scan, "--preset", preset, "--fit"]).refuses(named);
    };
    let circle = changed(|row| [row[0], row[1], row[2], row[4], row[5], row[3]]);
    refused(circle, "workshop", "its rotation is that of exchanged axes: x, y, z are y, z, x");
    let points: Vec<String> = (0..529).map(|n| format!("{},{},-1", n % 23 - 11, n / 23 - 11)).collect();
    sandbox.write("points.csv", &format!("x_mm,y_mm,z_mm\n{}\n", points.join("\n")));
    sample("by-hand", &["--points", "points.csv"]);
    let down = changed(|row| [row[0], row[1], -row[2], row[3], row[4], row[5]]);
    refused(down, "by-hand", "axes of the positions: z is reversed: change their columns");
    let centimetres = changed(|row| [row[0] / 10.0, row[1] / 10.0, row[2] / 10.0, row[3], row[4], row[5]]);
    refused(centimetres, "by-hand", "the positions are in centimetres, must be in mm");
}

/// Small errors of every tile are likelier than large errors of many.
#[test]
fn films_with_small_errors_of_every_tile_have_no_list_of_faulty_tiles() {
    let errors = [(0, 0.05, 1.01, 0.5), (1, -0.06, 0.99, -0.4), (2, 0.04, 1.01, 0.6), (3, -0.05, 0.98, 0.3)];
    let more = [(4, 0.06, 1.01, -0.5), (5, -0.04, 0.99, 0.5)];
    let sandbox = scanned(&[&errors[..], &more].concat());
    let said = run(&sandbox, &[]);
    let named = "errors of every tile explain the scan as well as errors of single tiles: no tile is reported";
    assert!(said.stdout.contains(named), "{}{}", said.stdout, said.stderr);
    assert!(said.stderr.contains("; --preset workshop expects them"), "{}", said.stderr);
    // Nor are they drawn.
    #[cfg(feature = "report")]
    {
        run(&sandbox, &["--figure", "tiles.svg", "-q"]);
        let drawn = sandbox.read("tiles.svg");
        assert!(drawn.contains("Rejected: no tile is reported.") && !drawn.contains("displaced"), "{drawn}");
    }
    let expected = run(&sandbox, &["--preset", "workshop"]);
    assert!(expected.stdout.contains("no faulty tile"), "{}", expected.stdout);
}

#[test]
fn fault_free_films_have_no_faulty_tile_and_large_noise_is_reported() {
    let sandbox = scanned(&[]);
    assert!(run(&sandbox, &[]).stdout.contains("no faulty tile"));
    let said = run(&sandbox, &["--fit", "--preset", "jig"]);
    assert!(said.stdout.contains("no faulty tile") && said.stdout.contains("start of the scan"), "{}", said.stdout);
    // A twentieth of the noise that there is.
    let said = sandbox.run(&["diagnose", "film.toml", "--scan", "scan.csv", "--noise", "2uT"]);
    assert!(said.stderr.contains("chi squared of the residual is"), "{}", said.stderr);
}

#[test]
fn bad_input_is_refused() {
    let sandbox = scanned(&[]);
    let refused = |arguments: &[&str]| {
        let said = sandbox.run(arguments);
        assert_eq!(said.status, 2, "{arguments:?}: {}", said.stdout);
        said.stderr
    };
    let message = refused(&["diagnose", "film.toml", "--scan", "scan.csv"]);
    assert!(message.contains("the layout has no noise: give --noise, such as 10uT"), "{message}");
    for value in ["0", "1", "nan", "-1e-3"] {
        let option = format!("--false-alarm={value}");
        let message = refused(&["diagnose", "film.toml", "--scan", "scan.csv", "--noise", "10uT", &option]);
        assert!(message.contains("must be a number greater than 0 and less than 1"), "{message}");
    }
    // A point on a corner of a tile, where B has no limit.
    sandbox.write("scan.csv", "x_mm,y_mm,z_mm,bx_t,by_t,bz_t\n0,0,-1,0,0,0\n1.7,2,0,0,0,0\n");
    let message = refused(&["diagnose", "film.toml", "--scan", "scan.csv", "--noise", "10uT"]);
    assert!(message.contains("scan.csv") && message.contains("edge"), "{message}");
}

/// The depth of 0.1 mm is allowed by 0.11, and not by 0.09.
#[test]
fn layouts_state_how_much_tiles_may_overlap() {
    let sandbox = Sandbox::new();
    let overlapping = layout(&[(1, 0.1, 1.0, 0.0)]);
    let status = |allowed: &str| {
        sandbox.write("film.toml", &overlapping.replacen("overlap_mm = 1.0", &format!("overlap_mm = {allowed}"), 1));
        let said = sandbox.run(&["tiles", "film.toml"]);
        (said.status, said.stderr)
    };
    assert_eq!(status("0.11").0, 0);
    let (code, message) = status("0.09");
    assert_eq!(code, 2);
    assert!(message.contains("by 0.1 mm, must be at most overlap_mm = 0.09"), "{message}");
    let (code, message) = status("-1.0");
    assert_eq!(code, 2);
    assert!(message.contains("overlap_mm = -1, must be a finite number of at least 0"), "{message}");
}

/// The example of docs/making.md.
#[test]
fn scan_of_the_docs_shows_its_three_faulty_tiles() {
    let sandbox = Sandbox::new();
    let published = std::fs::read_to_string(crate::shipped("published-film")).expect("readable");
    sandbox.write("film.toml", &published.replace("[sensor]\npart = \"MLX90393\"\n", ""));
    let docs = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let scan = docs.join("scan-of-faulty-tiles.csv").display().to_string();
    let said = sandbox.run(&["diagnose", "film.toml", "--scan", &scan, "--noise", "10uT"]);
    let page = std::fs::read_to_string(docs.join("making.md")).expect("readable");
    let start = page.find("    3 errors:\n").expect("the result");
    let printed = page[start..].split("\n\n").next().expect("its lines").replace("\n    ", "\n");
    assert!(said.stdout.contains(printed.trim_start()), "{}{}", said.stdout, said.stderr);
}

//! `tolerance sample`: films as made with their scans, for `scan` and `diagnose`.

use serde_json::Value;

use crate::{Sandbox, rows, shipped};

/// Errors of a film whose scan is not of the film as ordered.
const ERRORS: &str = "
[tolerance]
strength = 0.01
position_mm = 0.02
seed = 5
[tolerance.film]
position_mm = { fixed = 0.2 }
[tolerance.stray_field]
field_ut = [{ fixed = 10 }, { fixed = -20 }, { fixed = 30 }]
when = \"after\"
[tolerance.sensor]
offset_ut = 20
rotation_deg = 1
";

/// The published film with `tables`.
fn film(sandbox: &Sandbox, tables: &str) {
    sandbox.published_with(&format!("[sensor]\npart = \"MLX90393\"\n{tables}"));
}

fn json(sandbox: &Sandbox, arguments: &[&str]) -> Value {
    let said = sandbox.run(&[arguments, &["--format", "json"]].concat());
    assert_eq!(said.status, 0, "{}", said.stderr);
    serde_json::from_str(&said.stdout).expect("JSON")
}

fn numbers(of: &Value) -> Vec<f64> {
    let list = of.as_array().map_or_else(|| vec![of.clone()], Clone::clone);
    list.iter().map(|number| number.as_f64().expect("a number")).collect()
}

/// Deviations by which a scan may differ, of ten parameters: one in a million scans has more.
const DEVIATIONS: f64 = 5.5;

#[test]
fn scan_finds_the_parameters_of_a_sample() {
    let sandbox = Sandbox::new();
    film(&sandbox, ERRORS);
    let sample = ["tolerance", "sample", "film.toml", "--index", "7", "--scan", "scan.csv", "-o", "made.toml"];
    let said = sandbox.run(&sample);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    assert!(said.stdout.contains("sample 7, seed 5: 405 readings at points of the working volume"), "{}", said.stdout);
    let known = json(&sandbox, &sample);
    let found = json(&sandbox, &["scan", "scan.csv", "--layout", "made.toml"]);
    assert!(numbers(&known["scan"]["start_mm"]).iter().all(|start| (start + 0.2).abs() < 1e-12), "{known}");
    for key in ["strength", "offset_t", "rotation_deg", "start_mm"] {
        let [known, found, deviation] =
            [&known["scan"], &found["fitted"], &found["deviation"]].map(|of| numbers(&of[key]));
        for ((known, found), deviation) in known.iter().zip(&found).zip(&deviation) {
            assert!((known - found).abs() < DEVIATIONS * deviation, "{key}: {known} {found} +- {deviation}");
            assert!(*deviation > 0.0);
        }
    }
    // The residual is the noise of the sensor, 1.5, 1.5 and 2.4 uT.
    let residual = found["residual_t"].as_f64().expect("a residual");
    assert!((residual - 1.84e-6).abs() < 0.15e-6, "{residual}");
    // The film as ordered leaves the errors of the tiles.
    let ordered = json(&sandbox, &["scan", "scan.csv", "--layout", "film.toml"]);
    assert!(ordered["residual_t"].as_f64() > Some(2.0 * residual), "{ordered}");
}

/// Readings are whole counts within the range, and the same for the same seed and number only.
#[test]
fn readings_of_a_sample_are_those_of_its_sensor() {
    let sandbox = Sandbox::new();
    film(&sandbox, ERRORS);
    sandbox.write("points.csv", "x_mm,y_mm,z_mm\n0,0,-3\n2.5,2.5,-1\n");
    let read = |more: &[&str]| {
        let fixed = ["tolerance", "sample", "film.toml", "--points", "points.csv", "--scan", "-", "--quiet"];
        let said = sandbox.run(&[&fixed, more].concat());
        assert_eq!((said.status, said.stderr.as_str()), (0, ""));
        rows(&said.stdout)
    };
    let first = read(&[]);
    assert_eq!(first, read(&["--index", "0", "--seed", "5"]));
    assert!(first != read(&["--index", "1"]) && first != read(&["--seed", "6"]));
    for (axis, (count, range)) in
        [(0.15e-6, 4.9152e-3), (0.15e-6, 4.9152e-3), (0.242e-6, 7.929856e-3)].iter().enumerate()
    {
        for row in &first {
            let counts = row[3 + axis] / count;
            assert!((counts - counts.round()).abs() < 1e-6, "{counts}");
            assert!(row[3 + axis].abs() <= range * (1.0 + 1e-12), "{row:?}");
        }
    }
    let known = json(&sandbox, &["tolerance", "sample", "film.toml", "--points", "points.csv"]);
    assert_eq!(known["saturated"], 1, "{known}");
}

/// A film without errors of tiles is the film as ordered, and keeps its tables.
#[test]
fn made_film_has_the_tiles_of_the_sample() {
    let sandbox = Sandbox::new();
    film(&sandbox, "[tolerance.sensor]\noffset_ut = 20\n");
    let sample = ["tolerance", "sample", "film.toml", "-o", "made.toml", "--index", "3"];
    assert_eq!(sandbox.run(&sample).status, 0);
    let field = |layout: &str| sandbox.run(&["field", layout]).stdout;
    assert!(field("made.toml") == field("film.toml"));
    let made = sandbox.read("made.toml");
    assert!(made.contains("sample 3 with seed 1") && made.contains("[tolerance.sensor]"), "{made}");
    assert!(!made.contains("[expect]"), "{made}");
    // With errors of tiles the field differs, and diagnose finds the weak tile that was made.
    let weak = "[[tolerance.tile]]\ntiles = [\"film-x2-y7\"]\nstrength = { fixed = -0.1 }\n";
    let noisy = "[sensor]\nnoise_ut = 5\n";
    sandbox.published_with(&format!("{noisy}[tolerance]\n{weak}"));
    sandbox.write("points.csv", &grid(-1.0));
    let sample = [&sample[..], &["--points", "points.csv", "--scan", "scan.csv"]].concat();
    assert_eq!(sandbox.run(&sample).status, 0);
    sandbox.published_with(noisy);
    let found = json(&sandbox, &["diagnose", "film.toml", "--scan", "scan.csv"]);
    assert_eq!(found["faulty"].as_array().map(Vec::len), Some(1), "{found}");
    assert_eq!((&found["faulty"][0]["tile"], &found["faulty"][0]["kind"]), (&"film-x2-y7".into(), &"strength".into()));
}

/// Points in steps of 1 mm in a plane.
fn grid(z: f64) -> String {
    let points: Vec<String> = (0..441).map(|n| format!("{},{},{z}", n % 21 - 10, n / 21 - 10)).collect();
    format!("x_mm,y_mm,z_mm\n{}\n", points.join("\n"))
}

#[test]
fn samples_that_cannot_be_written_are_refused() {
    let sandbox = Sandbox::new();
    let published = shipped("published-film");
    let said = sandbox.run(&["tolerance", "sample", &published]);
    assert!(said.status == 2 && said.stderr.contains("has no [tolerance] table"), "{}", said.stderr);
    let workshop = ["tolerance", "sample", &published, "--preset", "workshop"];
    let said = sandbox.run(&[&workshop[..], &["--scan", "-", "-o", "-"]].concat());
    assert!(said.status == 2 && said.stderr.contains("-o and --scan are both standard output"), "{}", said.stderr);
    let said = sandbox.run(&[&workshop[..], &["-o", &published]].concat());
    assert!(said.status == 2 && said.stderr.contains("it is an input, which would be lost"), "{}", said.stderr);
    sandbox.write("points.csv", "x_mm,y_mm,z_mm\n0,0,-3\n");
    let said = sandbox.run(&[&workshop[..], &["--points", "points.csv", "--scan", "points.csv"]].concat());
    assert!(said.status == 2 && said.stderr.contains("it is an input, which would be lost"), "{}", said.stderr);
}

/// Every command that docs/sensor.md shows, one after the other.
#[cfg(feature = "report")]
#[test]
fn commands_of_the_page_about_sensors_work_as_printed() {
    let sandbox = Sandbox::new();
    std::fs::create_dir(sandbox.path("layouts")).expect("a writable folder");
    for name in ["published-film.toml", "published.field.csv"] {
        let from = std::path::Path::new(&shipped("published-film")).with_file_name(name);
        std::fs::copy(from, sandbox.path("layouts").join(name)).expect("a layout");
    }
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/sensor.md");
    let page = std::fs::read_to_string(page).expect("readable").replace("\\\n", " ");
    let commands: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("    magsplice ")).collect();
    assert!(commands.len() >= 9, "{commands:?}");
    for command in commands {
        let arguments: Vec<&str> = command.split_whitespace().collect();
        let said = sandbox.run(&arguments);
        // A film as made is not the film as ordered: outliers are named.
        let remarks = if command.starts_with("scan") { "" } else { said.stderr.as_str() };
        assert_eq!((said.status, remarks), (0, ""), "{command}: {}", said.stderr);
    }
    for written in ["moved.png", "moved.csv", "positions.csv", "resolution.vti", "scan.csv", "made.toml", "film.h"] {
        assert!(sandbox.path(written).exists(), "{written}");
    }
}

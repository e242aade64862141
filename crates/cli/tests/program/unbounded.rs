//! `field --unbounded nan`: points on exposed edges, and results that are held back.

use std::fmt::Write;
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::{Sandbox, shipped};

/// The second and third point are on an edge of the shipped single tile.
const POINTS: &str = "x_mm,y_mm,z_mm\n9,9,9\n1.65,0.25,0.5\n1.65,0.85,0.5\n0,0,-4\n";

#[test]
fn unbounded_points_are_nan_and_listed() {
    let sandbox = Sandbox::new();
    sandbox.write("points.csv", POINTS);
    let layout = shipped("single-tile");
    for quantity in ["b", "h", "gradient"] {
        let options = ["field", &layout, "--points", "points.csv", "--quantity", quantity];
        let said = sandbox.run(&[&options[..], &["--unbounded", "nan"]].concat());
        assert_eq!(said.status, 0, "{}", said.stderr);
        let lines: Vec<&str> = said.stdout.lines().collect();
        let values = lines[0].split(',').count() - 3;
        assert_eq!(lines[2], format!("1.65,0.25,0.5{}", ",NaN".repeat(values)));
        assert_eq!(lines[3], format!("1.65,0.85,0.5{}", ",NaN".repeat(values)));
        assert!(!lines[1].contains("NaN") && !lines[4].contains("NaN") && lines.len() == 5, "{}", said.stdout);
        let listed = "magsplice: points.csv: line 3: (1.65, 0.25, 0.5) mm: the field is unbounded there, on an exposed \
                      edge of tile \"tile\"; written as NaN\npoints.csv: line 4: (1.65, 0.85, 0.5) mm";
        assert!(said.stderr.starts_with(listed), "{}", said.stderr);
        sandbox.run(&options).refuses("points.csv: line 3: (1.65, 0.25, 0.5) mm: the field is unbounded there");
        let quiet = sandbox.run(&[&options[..], &["--unbounded", "nan", "--quiet"]].concat());
        assert_eq!((quiet.stdout, quiet.stderr.as_str()), (said.stdout, ""));
    }
}

#[test]
fn names_of_choices_are_read_in_either_case() {
    let sandbox = Sandbox::new();
    sandbox.write("points.csv", POINTS);
    let run = |quantity, unbounded| {
        let options = ["--quantity", quantity, "--unbounded", unbounded];
        sandbox.run(&[&["field", &shipped("single-tile"), "--points", "points.csv"][..], &options].concat())
    };
    for (upper, lower) in [("B", "b"), ("H", "h"), ("Gradient", "gradient")] {
        let said = run(upper, "NaN");
        assert_eq!((said.status, &said.stdout), (0, &run(lower, "nan").stdout), "{}", said.stderr);
    }
    assert_ne!(run("B", "NaN").stdout, run("H", "NaN").stdout);
}

/// As docs/file-formats.md says: lower faces belong to the tile, and edges parallel to J are
/// bounded.
#[test]
fn faces_and_edges_are_as_documented() {
    let sandbox = Sandbox::new();
    let layout = "format = 1\nname = \"t\"\n[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [2, 2, 2]\npolarization_t = [1, 0, 0]\n";
    sandbox.write("t.toml", layout);
    sandbox.write("faces.csv", "x_mm,y_mm,z_mm\n-1,0,0\n1,0,0\n0,-1,0\n0,1,0\n0,1,1\n");
    let j = sandbox.run(&["field", "t.toml", "--points", "faces.csv", "--quantity", "j"]);
    let x: Vec<f64> = crate::rows(&j.stdout).iter().map(|row| row[3]).collect();
    assert_eq!(x, [1.0, 0.0, 1.0, 0.0, 0.0]);
    // The last point is on an edge along x.
    assert_eq!(sandbox.run(&["field", "t.toml", "--points", "faces.csv"]).status, 0);
    sandbox.write("edge.csv", "x_mm,y_mm,z_mm\n1,1,0\n");
    sandbox.run(&["field", "t.toml", "--points", "edge.csv"]).refuses("on an exposed edge of tile");
}

#[test]
fn other_points_keep_their_field() {
    let sandbox = Sandbox::new();
    sandbox.write("points.csv", POINTS);
    sandbox.write("good.csv", "x_mm,y_mm,z_mm\n9,9,9\n0,0,-4\n");
    let layout = shipped("single-tile");
    let all = sandbox.run(&["field", &layout, "--points", "points.csv", "--unbounded", "nan"]).stdout;
    let good = sandbox.run(&["field", &layout, "--points", "good.csv"]).stdout;
    let kept: Vec<&str> = all.lines().filter(|line| !line.contains("NaN")).collect();
    assert_eq!(kept, good.lines().collect::<Vec<_>>());
}

#[test]
fn unbounded_points_are_null_in_json_and_capped_on_a_grid() {
    let sandbox = Sandbox::new();
    sandbox.write(
        "cube.toml",
        "format = 1\nname = \"cube\"\n[volume]\nx_mm = [-1, 1]\ny_mm = [-1, 1]\nz_mm = [-1, 1]\nstep_mm = 0.25\n\
         [[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n",
    );
    for accuracy in [&[][..], &["--within", "1e-6"]] {
        let verb = ["field", "cube.toml", "--unbounded", "nan", "-o", "cube.json"];
        let said = sandbox.run(&[&verb, accuracy].concat());
        assert_eq!(said.status, 0, "{}", said.stderr);
        let json: Value = serde_json::from_str(&sandbox.read("cube.json")).expect("JSON");
        let b = json["columns"]["bx_t"].as_array().expect("a column");
        // The vertical edges are exposed with J along z: top and bottom, 4 edges of 5 points each,
        // which share the corners.
        let unbounded = b.iter().filter(|value| value.is_null()).count();
        assert_eq!((b.len(), unbounded), (729, 32));
        assert!(said.stderr.contains("point (-0.5, -0.5, -0.5) mm of the working volume: the field is unbounded"));
        assert_eq!(said.stderr.matches("written as NaN").count(), 20);
        assert!(said.stderr.ends_with("cube.toml: and 12 more\n"), "{}", said.stderr);
    }
    for ending in ["npy", "npz", "vti", "csv"] {
        let name = format!("cube.{ending}");
        assert_eq!(sandbox.run(&["field", "cube.toml", "--unbounded", "nan", "-o", &name]).status, 0, "{ending}");
    }
}

/// A point that is out of range has no field for another reason, and remains an error.
#[test]
fn other_reasons_remain_errors() {
    let sandbox = Sandbox::new();
    sandbox.write("points.csv", "x_mm,y_mm,z_mm\n1.65,0.25,0.5\n1e305,0,0\n");
    sandbox
        .run(&["field", &shipped("single-tile"), "--points", "points.csv", "--unbounded", "nan"])
        .refuses("points.csv: line 3: (1");
}

/// The fault is in the second batch of points; the rows of the first must not have been printed.
#[test]
fn nothing_is_printed_before_the_last_point() {
    let mut points = "x_mm,y_mm,z_mm\n".to_owned();
    for i in 0..70_000 {
        let _ = writeln!(points, "{i},3,3");
    }
    points.push_str("1.65,0.25,0.5\n");
    let sandbox = Sandbox::new();
    sandbox.write("points.csv", &points);
    let film = shipped("single-tile");
    sandbox.run(&["field", &film, "--points", "points.csv"]).refuses("line 70002: (1.65, 0.25, 0.5) mm");
    let mut program = Command::new(env!("CARGO_BIN_EXE_magsplice"))
        .args(["field", &film, "--points", "-", "-o", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    std::io::Write::write_all(&mut program.stdin.take().expect("a pipe"), points.as_bytes()).expect("it reads");
    assert_eq!(program.wait_with_output().expect("it ends").stdout, b"");
}

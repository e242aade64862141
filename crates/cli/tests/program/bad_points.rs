//! Point files that cannot be used, and outputs that cannot be written.

use std::fmt::Write;

use crate::{Sandbox, shipped};

#[track_caller]
fn refused(points: &str, messages: &[&str]) {
    let sandbox = Sandbox::new();
    sandbox.write("points.csv", points);
    let said = sandbox.run(&["field", &shipped("single-tile"), "--points", "points.csv", "-o", "out.csv"]);
    for message in messages {
        said.refuses(message);
    }
    assert_eq!(sandbox.files(), ["points.csv"], "no file may be left behind");
}

#[test]
fn missing_columns_are_named() {
    refused("x_mm,z_mm\n1,2\n", &["points.csv: line 1: no column y_mm of the position (found: x_mm,z_mm)"]);
    refused("a,b,c\n1,2,3\n", &["no columns x_mm, y_mm, z_mm of the position (found: a,b,c)"]);
    refused("x_mm,x_mm,y_mm,z_mm\n1,2,3,4\n", &["more than one column x of the position: x_mm, x_mm"]);
    refused("", &["points.csv: is empty"]);
}

#[test]
fn every_faulty_line_is_named() {
    let points = "x_mm,y_mm,z_mm\n9,9,9\n1,two,3\n1,2\n1,2,inf\n,2,3\n1,2,3\n";
    refused(
        points,
        &[
            "points.csv: line 3: y_mm = \"two\", must be a finite number",
            "points.csv: line 4: has 2 fields, must have 3 like line 1",
            "points.csv: line 5: z_mm = \"inf\", must be a finite number",
            "points.csv: line 6: x_mm = \"\", must be a finite number",
        ],
    );
}

#[test]
fn many_faulty_lines_are_counted() {
    let mut points = "x_mm,y_mm,z_mm\n".to_owned();
    for _ in 0..100_000 {
        points.push_str("1,2,x\n");
    }
    refused(&points, &["line 21: z_mm", "points.csv: and 99980 more"]);
}

#[test]
fn blank_lines_are_skipped() {
    let sandbox = Sandbox::new();
    sandbox.write("points.csv", "x_mm,y_mm,z_mm\r\n\r\n   \r\n9,9,9\r\n");
    let said = sandbox.run(&["field", &shipped("single-tile"), "--points", "points.csv"]);
    assert_eq!((said.status, said.stdout.lines().count()), (0, 2), "{}", said.stderr);
}

#[test]
fn empty_and_missing_point_files_are_refused() {
    refused("x_mm,y_mm,z_mm\n", &["points.csv: has no points"]);
    let sandbox = Sandbox::new();
    sandbox
        .run(&["field", &shipped("single-tile"), "--points", "none.csv"])
        .refuses("none.csv: cannot read: No such file");
}

#[test]
fn point_on_an_exposed_edge_is_refused_with_its_tile() {
    // The fault is in the second batch, after the rows of the first one.
    let mut points = "x_mm,y_mm,z_mm\n".to_owned();
    for i in 0..70_000 {
        let _ = writeln!(points, "{i},3,3");
    }
    points.push_str("1.65,0.25,0.5\n1.65,0.85,0.5\n");
    refused(
        &points,
        &[
            "points.csv: line 70002: (1.65, 0.25, 0.5) mm: the field is unbounded there, on an exposed edge of tile \"tile\"",
            "points.csv: line 70003: (1.65, 0.85, 0.5) mm",
        ],
    );
}

#[test]
fn outputs_that_cannot_be_written_are_refused() {
    let sandbox = Sandbox::new();
    let layout = shipped("single-tile");
    sandbox.run(&["field", &layout, "-o", "no/such/folder/out.csv"]).refuses("cannot write no/such/folder/out.csv");
    sandbox.run(&["field", &layout, "-o", "."]).refuses("cannot write .: ");
    assert_eq!(sandbox.files(), [""; 0]);
    let points = sandbox.write("points.csv", "x_mm,y_mm,z_mm\n9,9,9\n");
    let onto_input = ["field", &layout, "--points", "points.csv", "-o", "./points.csv"];
    sandbox.run(&onto_input).refuses("cannot write ./points.csv: it is an input, which would be lost");
    let mut permissions = std::fs::metadata(&points).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&points, permissions).unwrap();
    sandbox.run(&["field", &layout, "-o", "points.csv"]).refuses("cannot write points.csv: it is read-only");
}

/// Devices without an end are refused after a part, and messages cite a part only.
#[cfg(unix)]
#[test]
fn endless_files_and_lines_are_refused() {
    let sandbox = Sandbox::new();
    let film = shipped("single-tile");
    for verb in [&["field", "-o", "out.csv"][..], &["plan"]] {
        let at = |points: &str| sandbox.run(&[verb, &[&film, "--points", points]].concat());
        at("/dev/zero").refuses("/dev/zero: cannot read: a line has more than 65536 bytes");
        sandbox.write("long.csv", &format!("x_mm,y_mm,z_mm\n0,0,{}\n", "1".repeat(1 << 20)));
        at("long.csv").refuses("a line has more than 65536 bytes");
        sandbox.write("wide.csv", &format!("x_mm,y_mm,z_mm\n0,0,{}\n", "x".repeat(60_000)));
        let said = at("wide.csv");
        said.refuses("line 2: z_mm = \"xxxx");
        assert!(said.stderr.len() < 400, "{}", said.stderr.len());
    }
    sandbox
        .run(&["check", "/dev/zero"])
        .refuses("cannot read /dev/zero: it has more than 67108864 bytes, too many for a layout");
}

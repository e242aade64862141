//! Forms of point files: separators, decimal marks, comments, names and units of columns.

use crate::{Sandbox, shipped};

/// Points in millimetres that the file must give; those of all files here.
const POINTS: &str = "x_mm,y_mm,z_mm\n1.5,-2,-3.25\n0.1,0,-4\n";

/// What `field` prints for this file.
fn field(points: &str, options: &[&str]) -> crate::RunOutput {
    let sandbox = Sandbox::new();
    sandbox.write("points.csv", points);
    let layout = shipped("single-tile");
    sandbox.run(&[&["field", &layout, "--points", "points.csv"], options].concat())
}

#[track_caller]
fn same(points: &str, options: &[&str]) {
    let (wanted, found) = (field(POINTS, &[]), field(points, options));
    assert_eq!((found.status, found.stderr.as_str()), (0, ""), "{points}");
    assert_eq!(found.stdout, wanted.stdout, "{points}");
    assert_eq!(wanted.stdout.lines().count(), 3);
}

#[track_caller]
fn refused(points: &str, options: &[&str], message: &str) {
    field(points, options).refuses(message);
}

#[test]
fn separators_are_found_in_the_line_of_names() {
    same("x_mm;y_mm;z_mm\n1.5;-2;-3.25\n0.1;0;-4\n", &[]);
    same("x_mm;y_mm;z_mm\r\n1,5;-2;-3,25\r\n0,1;0;-4\r\n", &[]);
    same("note\tx_mm\ty_mm\tz_mm\na b\t1,5\t-2\t-3,25\n\t0,1\t0\t-4\n", &[]);
    same("  x_mm   y_mm z_mm\n  1.5e0 -2.0  -3.25 \n\n 0.1\t0 -4\n", &[]);
    same("\u{feff}\"x_mm\",\"y_mm\",\"z_mm\",\"a, b\"\n1.5,-2,-3.25,\"1;2\"\n0.1,0,-4,\n", &[]);
}

#[test]
fn comments_are_skipped_and_may_hold_the_names() {
    same("# measured today\n#\nx_mm,y_mm,z_mm\n1.5,-2,-3.25\n# the last\n0.1,0,-4\n", &[]);
    // As numpy.savetxt writes it, with its own separator and with that of the header.
    same("# x,y,z\n1.5 -2 -3.25\n0.1 0 -4\n", &["--unit", "mm"]);
    same("# x,y,z\n1.500e+00,-2.000e+00,-3.250e+00\n1.000e-01,0,-4\n", &["--unit", "mm"]);
    same("# Points of the probe.\n# x_mm y_mm z_mm\n1.5 -2 -3.25\n0.1 0 -4\n", &[]);
}

#[test]
fn columns_name_their_unit_in_any_form() {
    for names in ["x (mm),y (mm),z (mm)", "x[mm],y[mm],z[mm]", "X_mm,Y_mm,Z_mm", "x/mm,y [mm],z_mm", "z,x_mm,y_mm,z_mm"]
    {
        let (first, rest) = if names.starts_with("z,") { ("7,", ",") } else { ("", ",") };
        same(&format!("{names}\n{first}1.5{rest}-2,-3.25\n{first}0.1,0,-4\n"), &[]);
    }
    // Metres are converted without an error: 0.0001 m is 0.1 mm to the last digit.
    same("x_m,y_m,z_m\n0.0015,-2e-3,-3.25E-3\n0.0001,0,-0.004\n", &[]);
    same("x (m) y (m) z (m)\n0.0015 -2e-3 -3.25E-3\n0.0001 0 -0.004\n", &[]);
    same("x_um;y_um;z_um\n1500;-2e3;-3,25e3\n100;0;-4e3\n", &[]);
    same("x,y,z\n1.5,-2,-3.25\n0.1,0,-4\n", &["--unit", "mm"]);
    same("x,y,z\n0.0015,-0.002,-0.00325\n0.0001,0,-0.004\n", &["--unit", "m"]);
}

#[test]
fn units_that_are_missing_or_contradict_are_named() {
    let bare = "points.csv: line 1: the columns x, y, z of the position have no unit: rename, as in x_mm, or give \
                --unit, with one of: mm, cm, m, um, nm, in, mil";
    refused("x,y,z\n1,2,3\n", &[], bare);
    refused("# x y z\n1 2 3\n", &[], "line 1: the columns x, y, z of the position have no unit");
    refused(
        "x_mm,y_mm,z_mm\n1,2,3\n",
        &["--unit", "m"],
        "--unit m contradicts the columns x_mm, y_mm, z_mm of the position: leave it out or rename",
    );
    refused(
        "x_feet,y_mm,z_mm\n1,2,3\n",
        &[],
        "line 1: the column x_feet of the position has the unit feet, must be one of: mm, cm, m, um, nm, in, mil",
    );
    refused("x_mm,x_m,y_mm,z_mm\n1,2,3,4\n", &[], "more than one column x of the position: x_mm, x_m");
    refused("1,2,3\n4,5,6\n", &[], "line 1: has no names of columns, must begin with the line x_mm,y_mm,z_mm");
    Sandbox::new()
        .run(&["field", &shipped("single-tile"), "--unit", "mm"])
        .refuses_arguments("required arguments were not provided");
}

/// Comments and blank lines count, with either end of a line.
#[test]
fn faults_have_the_line_of_the_file() {
    for end in ["\n", "\r\n", "\r"] {
        let text = "# a\n\nx_mm y_mm z_mm\n# b\n\n1 2 3\n  # c\n1 2 x\n\n\n1 2\n";
        refused(&text.replace('\n', end), &[], "line 8: z_mm = \"x\", must be a finite number");
        refused(&text.replace('\n', end), &[], "line 11: has 2 fields, must have 3 like line 3");
    }
}

#[test]
fn wrong_and_mixed_separators_are_named() {
    let line_2 = |other: &str, own: &str| {
        format!("points.csv: line 2: is separated by {other}, must be separated by {own} like line 1")
    };
    refused("x_mm,y_mm,z_mm\n1;2;3\n", &[], &line_2("semicolons", "commas"));
    refused("x_mm,y_mm,z_mm\n1,5;2,5;3,5\n", &[], &line_2("semicolons", "commas"));
    refused("x_mm,y_mm,z_mm\n1 2 3\n", &[], &line_2("spaces", "commas"));
    refused("x_mm;y_mm;z_mm\n1.5,2,3\n", &[], &line_2("commas", "semicolons"));
    refused("x_mm y_mm z_mm\n1,2,3\n", &[], &line_2("commas", "spaces"));
    refused("x_mm y_mm z_mm\n1, 2, 3\n", &[], &line_2("commas", "spaces"));
    refused("x_mm;y_mm,z_mm\n1;2,3\n", &[], "line 1: mixes commas and semicolons between its names, must have one");
    refused("x_mm|y_mm|z_mm\n1|2|3\n", &[], "line 1: is separated by bars, must be separated by commas, semicolons");
    refused("x_mm,y_mm,z_mm\n1,5,2,5,3,5\n", &[], "line 2: has 6 fields, must have 3 like line 1 (with decimal commas");
    refused(
        "x_mm;y_mm;z_mm\n1,5;2;3\n1.5;2;3\n",
        &[],
        "line 3: x_mm = \"1.5\", has a decimal point, must have a decimal comma like line 2",
    );
    refused("x_mm;y_mm;z_mm\n1,234.5;2;3\n", &[], "line 2: x_mm = \"1,234.5\", must be a finite number");
}

/// Each column is converted by its own unit, which is usually a slip in the names.
#[test]
fn coordinates_in_different_units_are_remarked_on() {
    let remark = "magsplice: warning: points.csv: line 2: the coordinates have different units: x_um, y_cm, z_m\n";
    let points = "# three\nx_um;y_cm;z_m\n1500;-0,2;-3,25e-3\n100;0;-0,004\n";
    let said = field(points, &[]);
    assert_eq!((said.status, said.stderr.as_str()), (0, remark));
    assert_eq!(said.stdout, field(POINTS, &[]).stdout);
    assert_eq!(field(points, &["-q"]).stderr, "");
    let sandbox = Sandbox::new();
    sandbox.write("points.csv", points);
    for verb in ["compare", "decouple", "plan"] {
        let said = sandbox.run(&[verb, &shipped("published-film"), "--points", "points.csv"]);
        assert_eq!((said.status, said.stderr.as_str()), (0, remark), "{verb}");
    }
}

/// A fault of the whole file is told once, not for each of its lines.
#[test]
fn wrong_form_of_all_lines_is_one_message() {
    for (names, row, message) in [
        ("x_mm,y_mm,z_mm", "1;2;3", "line 2: is separated by semicolons, must be separated by commas like line 1"),
        ("x_mm;y_mm;z_mm", "1,2,3", "line 2: is separated by commas, must be separated by semicolons like line 1"),
        ("x_mm y_mm z_mm", "1, 2, 3", "line 2: is separated by commas, must be separated by spaces like line 1"),
        (
            "x_mm,y_mm,z_mm",
            "1,5,2,5,3,5",
            "line 2: has 6 fields, must have 3 like line 1 (with decimal commas, separate by",
        ),
        (
            "x_mm,y_mm,z_mm",
            "1,5,2,3,5",
            "line 2: has 5 fields, must have 3 like line 1 (with decimal commas, separate by",
        ),
        ("x_mm y_mm z_mm", "1,5 2 3,5", "line 2: 1,5 has a decimal comma: separate the columns by semicolons or tabs"),
    ] {
        let said = field(&format!("{names}\n{}", format!("{row}\n").repeat(50)), &[]);
        said.refuses(message);
        assert_eq!(said.stderr.lines().count(), 1, "{}", said.stderr);
    }
    // One faulty line among good ones is still named beside others.
    let said = field("x_mm,y_mm,z_mm\n1,2,3\n1;2;3\n1,2,x\n", &[]);
    said.refuses("line 3: is separated by semicolons");
    said.refuses("line 4: z_mm = \"x\"");
}

#[test]
fn leftovers_of_spreadsheets_are_understood() {
    same("sep=;\nx_mm;y_mm;z_mm\n1,5;-2;-3,25\n0,1;0;-4\n;;\n;;;;\n", &[]);
    same("\u{feff}SEP=,\r\nx_mm,y_mm,z_mm,note\r\n1.5,-2,-3.25,a\r\n,,,\r\n0.1,0,-4,\r\n,,,\r\n", &[]);
    refused("x_mm,y_mm,z_mm\n,,\n", &[], "has no points below its names of columns");
    let sandbox = Sandbox::new();
    let utf16 =
        |mark: &[u8]| [mark, &"x_mm;y_mm\r\n1;2\r\n".bytes().flat_map(|byte| [byte, 0]).collect::<Vec<_>>()].concat();
    let is_utf16 = "is UTF-16 text, must be UTF-8: save it as CSV UTF-8";
    for (bytes, message) in [
        (
            b"PK\x03\x04\x14\0\x06\0".to_vec(),
            "points.csv: is a workbook (.xlsx, .ods or .xls), must be text: save it as CSV",
        ),
        (b"\xd0\xcf\x11\xe0\xa1\xb1".to_vec(), "save it as CSV"),
        (utf16(b"\xff\xfe"), is_utf16),
        (utf16(b""), is_utf16),
        (b"x_mm,y_mm,z_mm,\xb5\n".to_vec(), "line 1: is not UTF-8 text: save it as CSV UTF-8"),
        (b"x_mm,y_mm,z_mm,a\n1,2,3,\xb5\n".to_vec(), "line 2: is not UTF-8 text: save it as CSV UTF-8"),
    ] {
        std::fs::write(sandbox.path("points.csv"), bytes).expect("a writable folder");
        sandbox.run(&["field", &shipped("single-tile"), "--points", "points.csv"]).refuses(message);
        if !message.starts_with("line 2") {
            sandbox.run(&["import", "points.csv"]).refuses(message);
        }
    }
}

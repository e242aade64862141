//! `field`: values, points and quantities.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::{Sandbox, rows, shipped};

#[test]
fn field_keeps_the_order_of_points() {
    let sandbox = Sandbox::new();
    sandbox.write("points.csv", "note, z_mm ,x_mm,y_mm\nfirst,-5.0, 2.0 ,-1.0\nsecond,-3,0,0\nthird,-5,-1,2\n");
    let said = sandbox.run(&["field", &shipped("published-film"), "--points", "points.csv"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    assert_eq!(said.stdout.lines().next(), Some("x_mm,y_mm,z_mm,bx_t,by_t,bz_t"));
    let rows = rows(&said.stdout);
    assert_eq!(rows.len(), 3);
    assert_eq!((&rows[0][..3], &rows[1][..3]), (&[2.0, -1.0, -5.0][..], &[0.0, 0.0, -3.0][..]));
    let known = [-1.0284893492777e-3, 6.272861417527e-4, 6.766460587771e-4];
    for (found, known) in rows[0][3..].iter().zip(known) {
        assert!((found - known).abs() <= 1e-12 * f64::abs(known), "{found}, not {known}");
    }
    // The film is symmetric under the exchange of x and y.
    assert!((rows[2][3] - rows[0][4]).abs() <= 1e-13 * known[0].abs());
}

/// The shipped single tile is a tile of the reference table.
#[test]
fn field_matches_the_reference_table() {
    let sandbox = Sandbox::new();
    let table = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference/generic.csv");
    let table = std::fs::read_to_string(table).unwrap();
    // Columns 3 to 11 are size, polarization and centre; 12 to 14 the point; 16 to 18 B.
    let rows_of_tile: Vec<Vec<&str>> = table.lines().map(|l| l.split(',').collect()).collect();
    let tile = ["3.3", "1.7", "1.0", "0.3", "-0.5", "0.7", "0.0", "0.0", "0.0"];
    let rows_of_tile: Vec<_> = rows_of_tile.into_iter().filter(|row| row[3..12] == tile).collect();
    assert_eq!(rows_of_tile.len(), 1379);
    let points: String = rows_of_tile.iter().map(|row| row[12..15].join(",") + "\n").collect();
    sandbox.write("points.csv", &format!("x_mm,y_mm,z_mm\n{points}"));
    let said = sandbox.run(&["field", &shipped("single-tile"), "--points", "points.csv"]);
    for (found, row) in rows(&said.stdout).iter().zip(&rows_of_tile) {
        let known: Vec<f64> = row[16..19].iter().map(|b| b.parse().unwrap()).collect();
        let norm = |v: &[f64]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
        let off: Vec<f64> = (0..3).map(|i| found[3 + i] - known[i]).collect();
        assert!(norm(&off) <= 1e-12 * norm(&known), "{found:?}, not {known:?}");
    }
    assert_eq!(rows(&said.stdout).len(), 1379);
}

#[test]
fn digits_read_back_to_the_same_numbers() {
    let sandbox = Sandbox::new();
    let first = sandbox.run(&["field", &shipped("single-tile")]).stdout;
    sandbox.write("points.csv", &first);
    // The output is a point file too. Its points read back to the same numbers, so the field is the
    // same text.
    let second = sandbox.run(&["field", &shipped("single-tile"), "--points", "points.csv", "-o", "again.csv"]);
    assert_eq!(second.stdout, "");
    assert_eq!(sandbox.read("again.csv"), first);
    assert_eq!(rows(&first).len(), 17 * 17 * 9);
    assert!(first.lines().all(|l| l.split(',').count() == 6));
}

#[test]
fn quantities_carry_their_units() {
    let sandbox = Sandbox::new();
    sandbox.write("points.csv", "x_mm,y_mm,z_mm\n0.1,0.2,0.1\n0,0,2\n");
    let of = |quantity: &str| {
        let said = sandbox.run(&["field", &shipped("single-tile"), "--points", "points.csv", "--quantity", quantity]);
        assert_eq!(said.status, 0, "{}", said.stderr);
        (said.stdout.lines().next().unwrap().to_owned(), rows(&said.stdout))
    };
    let ((_, b), (h_header, h), (j_header, j)) = (of("b"), of("h"), of("j"));
    assert_eq!(h_header, "x_mm,y_mm,z_mm,hx_a_per_m,hy_a_per_m,hz_a_per_m");
    assert_eq!(j_header, "x_mm,y_mm,z_mm,jx_t,jy_t,jz_t");
    assert_eq!((&j[0][3..], &j[1][3..]), (&[0.3, -0.5, 0.7][..], &[0.0, 0.0, 0.0][..]));
    for (i, row) in b.iter().enumerate() {
        for axis in 3..6 {
            assert!((row[axis] - 1.25663706127e-6 * h[i][axis] - j[i][axis]).abs() < 1e-14);
        }
    }
}

/// The gradient is the difference quotient of the field, symmetric and traceless, in T/mm.
#[test]
fn gradient_columns() {
    let sandbox = Sandbox::new();
    let h = 1e-4;
    sandbox.write("at.csv", "x_mm,y_mm,z_mm\n2,-1,-4\n");
    sandbox.write("around.csv", &format!("x_mm,y_mm,z_mm\n{},-1,-4\n{},-1,-4\n", 2.0 - h, 2.0 + h));
    let layout = shipped("published-film");
    let said = sandbox.run(&["field", &layout, "--points", "at.csv", "--quantity", "gradient"]);
    assert!(said.stdout.starts_with("x_mm,y_mm,z_mm,dbx_dx_t_per_mm,dbx_dy_t_per_mm,dbx_dz_t_per_mm,dby_dx_t_per_mm,"));
    let row = &rows(&said.stdout)[0][3..];
    assert_eq!(row.len(), 9);
    let around = rows(&sandbox.run(&["field", &layout, "--points", "around.csv"]).stdout);
    for component in 0..3 {
        let slope = (around[1][3 + component] - around[0][3 + component]) / (2.0 * h);
        // Truncation error: h^2 / 6 times a third derivative of about B / mm^3. Round-off: 1e-18 /
        // h.
        assert!((row[3 * component] - slope).abs() < 1e-11, "dB_{component}/dx is {}, not {slope}", row[3 * component]);
    }
    assert!(
        (row[0] + row[4] + row[8]).abs() < 1e-17 && (row[1] - row[3]).abs() < 1e-17 && (row[5] - row[7]).abs() < 1e-17
    );
}

#[test]
fn dash_is_standard_input_and_output() {
    let layout = shipped("single-tile");
    let expected = Sandbox::new().run(&["field", &layout]).stdout;
    for name in ["-", "/dev/stdout"] {
        let sandbox = Sandbox::new();
        assert_eq!(sandbox.run(&["field", &layout, "-o", name]).stdout, expected);
        assert_eq!(sandbox.files(), [""; 0]);
    }
    let mut program = Command::new(env!("CARGO_BIN_EXE_magsplice"))
        .args(["field", &layout, "--points", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    std::io::Write::write_all(&mut program.stdin.take().unwrap(), expected.as_bytes()).unwrap();
    assert_eq!(String::from_utf8(program.wait_with_output().unwrap().stdout).unwrap(), expected);
}

/// A point without a file: mm, or a unit for each length.
#[test]
fn points_on_the_command_line() {
    let sandbox = Sandbox::new();
    let film = shipped("published-film");
    sandbox.write("points.csv", "x_mm,y_mm,z_mm\n0,0,-4\n-1.5,2,-3\n");
    let of_file = sandbox.run(&["field", &film, "--points", "points.csv"]).stdout;
    for at in [["0,0,-4", "-1.5,2,-3"], ["0, 0, -4mm", "-1500um,0.2cm,-3"]] {
        let said = sandbox.run(&["field", &film, "--at", at[0], "--at", at[1]]);
        assert_eq!((said.status, said.stderr.as_str(), &said.stdout), (0, "", &of_file));
    }
    let json = sandbox.run(&["field", &film, "--at=0,0,-4", "--format", "json", "--quantity", "gradient"]);
    assert!(json.status == 0 && json.stdout.contains("\"points\": 1,"), "{}", json.stdout);
    let tile = "[[tile]]\nname = \"a\"\nposition_mm = [0, 0, 1]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
    sandbox.write("film.toml", &format!("format = 1\nname = \"a tile\"\n{tile}"));
    assert_eq!(sandbox.run(&["field", "film.toml", "--at", "0,0,-4"]).status, 0);
    sandbox.run(&["field", "film.toml", "--at", "0.5,0,1.5"]).refuses("film.toml: point --at 0.5,0,1.5 (mm): ");
    sandbox.run(&["field", "film.toml"]).refuses("give --points or --at");
    for (at, message) in [
        ("0,0", "must be three lengths with commas between them, such as 0,0,-4"),
        ("0,0,-4kg", "has the unit kg, must be a length"),
        ("0,0,x", "must be a number with or without a unit"),
    ] {
        sandbox.run(&["field", &film, "--at", at]).refuses_arguments(message);
    }
    sandbox.run(&["field", &film, "--at", "0,0,-4", "--points", "points.csv"]).refuses_arguments("cannot be used with");
}

/// A point on the edge of a tile whose face has round-off: 2.5 - 1.65 is not 0.85.
#[test]
fn points_that_are_nearly_on_faces_are_remarked_on() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    let remarked = |at: &str| sandbox.run(&["field", &film, &format!("--at={at}")]).stderr;
    let named = "1 point is on a face or an edge of a tile but for round-off, such as (0.85, 1, 0.2) mm of \"film-x";
    assert!(remarked("0.85,1,0.2").contains(named), "{}", remarked("0.85,1,0.2"));
    assert_eq!(remarked("0.8500001,1,0.2"), "");
    assert_eq!(remarked("0,0,-4"), "");
}

//! What the program prints and writes.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

use crate::{Bench, shipped};

fn rows(csv: &str) -> Vec<Vec<f64>> {
    csv.lines().skip(1).map(|l| l.split(',').map(|c| c.parse().expect("a number")).collect()).collect()
}

#[test]
fn field_of_the_published_film_at_points_in_the_order_given() {
    let bench = Bench::new();
    bench.write("points.csv", "note, z_mm ,x_mm,y_mm\nfirst,-5.0, 2.0 ,-1.0\nsecond,-3,0,0\nthird,-5,-1,2\n");
    let said = bench.run(&["field", &shipped("published-film"), "--points", "points.csv"]);
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

/// The shipped single tile is the one of the reference tables.
#[test]
fn field_of_the_reference_tile() {
    let bench = Bench::new();
    let table = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference/generic.csv");
    let table = std::fs::read_to_string(table).unwrap();
    // Columns 3 .. 11 hold size, polarization and centre, 12 .. 14 the point, 16 .. 18 B.
    let rows_of_tile: Vec<Vec<&str>> = table.lines().map(|l| l.split(',').collect()).collect();
    let tile = ["3.3", "1.7", "1.0", "0.3", "-0.5", "0.7", "0.0", "0.0", "0.0"];
    let rows_of_tile: Vec<_> = rows_of_tile.into_iter().filter(|row| row[3..12] == tile).collect();
    assert_eq!(rows_of_tile.len(), 1379);
    let points: String = rows_of_tile.iter().map(|row| row[12..15].join(",") + "\n").collect();
    bench.write("points.csv", &format!("x_mm,y_mm,z_mm\n{points}"));
    let said = bench.run(&["field", &shipped("single-tile"), "--points", "points.csv"]);
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
    let bench = Bench::new();
    let first = bench.run(&["field", &shipped("single-tile")]).stdout;
    bench.write("points.csv", &first);
    // The output is itself a point file: its points are the same numbers, so the field is the same text.
    let second = bench.run(&["field", &shipped("single-tile"), "--points", "points.csv", "-o", "again.csv"]);
    assert_eq!(second.stdout, "");
    assert_eq!(bench.read("again.csv"), first);
    assert_eq!(rows(&first).len(), 17 * 17 * 9);
    assert!(first.lines().all(|l| l.split(',').count() == 6));
}

#[test]
fn quantities_carry_their_units() {
    let bench = Bench::new();
    bench.write("points.csv", "x_mm,y_mm,z_mm\n0.1,0.2,0.1\n0,0,2\n");
    let of = |quantity: &str| {
        let said = bench.run(&["field", &shipped("single-tile"), "--points", "points.csv", "--quantity", quantity]);
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

/// The gradient is the slope of the field, symmetric and without trace, in tesla per millimetre.
#[test]
fn gradient_columns() {
    let bench = Bench::new();
    let h = 1e-4;
    bench.write("at.csv", "x_mm,y_mm,z_mm\n2,-1,-4\n");
    bench.write("around.csv", &format!("x_mm,y_mm,z_mm\n{},-1,-4\n{},-1,-4\n", 2.0 - h, 2.0 + h));
    let layout = shipped("published-film");
    let said = bench.run(&["field", &layout, "--points", "at.csv", "--quantity", "gradient"]);
    assert!(said.stdout.starts_with("x_mm,y_mm,z_mm,dbx_dx_t_per_mm,dbx_dy_t_per_mm,dbx_dz_t_per_mm,dby_dx_t_per_mm,"));
    let row = &rows(&said.stdout)[0][3..];
    assert_eq!(row.len(), 9);
    let around = rows(&bench.run(&["field", &layout, "--points", "around.csv"]).stdout);
    for component in 0..3 {
        let slope = (around[1][3 + component] - around[0][3 + component]) / (2.0 * h);
        // Truncation h^2 / 6 times a third derivative of about B / mm^3; rounding 1e-18 / h.
        assert!((row[3 * component] - slope).abs() < 1e-11, "dB_{component}/dx is {}, not {slope}", row[3 * component]);
    }
    assert!(
        (row[0] + row[4] + row[8]).abs() < 1e-17 && (row[1] - row[3]).abs() < 1e-17 && (row[5] - row[7]).abs() < 1e-17
    );
}

#[test]
fn an_existing_file_is_replaced_and_a_link_stays_a_link() {
    let bench = Bench::new();
    bench.write("target.csv", "old");
    #[cfg(unix)]
    std::os::unix::fs::symlink(bench.path("target.csv"), bench.path("out.csv")).unwrap();
    assert_eq!(bench.run(&["field", &shipped("single-tile"), "-o", "out.csv"]).status, 0);
    assert!(bench.read("target.csv").starts_with("x_mm,"));
    assert!(bench.path("out.csv").symlink_metadata().unwrap().is_symlink());
    assert_eq!(bench.files(), ["out.csv", "target.csv"]);
    #[cfg(unix)]
    {
        use std::os::unix::fs::{FileTypeExt, PermissionsExt};
        assert_eq!(bench.run(&["field", &shipped("single-tile"), "-o", "/dev/null"]).status, 0);
        assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());
        // Readable like any other new file.
        let plain = bench.path("plain");
        std::fs::write(&plain, "").unwrap();
        let mode = |path| std::fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(bench.path("target.csv")), mode(plain));
    }
}

/// Runs the program with nobody reading its output.
fn unread(arguments: &[&str]) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_magsplice"))
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(program.stdout.take());
    program.wait_with_output().unwrap()
}

#[test]
fn a_reader_that_stops_early_is_no_failure() {
    let output = unread(&["field", &shipped("single-tile")]);
    assert!(output.status.success());
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

#[test]
fn decouple_prints_the_published_numbers() {
    let said = Bench::new().run(&["decouple", &shipped("published-film")]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let lines: BTreeMap<&str, Vec<&str>> = said
        .stdout
        .lines()
        .filter(|l| l.len() > 38)
        .map(|l| (l[..38].trim(), l[38..].split_whitespace().collect()))
        .collect();
    assert_eq!(lines["uniformity RMSE"], ["0.062872", "0.062872", "0.039888"]);
    assert_eq!(lines["RMSE against the ideal film"], ["0.152165", "0.152165", "0.198419"]);
    assert_eq!(lines["best-fit amplitude"], ["0.818730"]);
    assert_eq!(lines["relative RMSE as is"], ["0.197428"]);
    assert_eq!(lines["relative RMSE after scaling"], ["0.095543"]);
    assert!(said.stdout.contains("singular points (B_z = 0): none"));
    assert!(said.stdout.lines().all(|l| l.len() <= 80), "fits a terminal");
}

#[test]
fn decouple_as_json() {
    let said = Bench::new().run(&["decouple", &shipped("published-film"), "--format", "json"]);
    let json: Value = serde_json::from_str(&said.stdout).unwrap();
    let k = std::f64::consts::TAU / 10.0;
    for (key, lengths, known) in [
        ("uniformity_rmse", "uniformity_rmse_mm", [0.062872, 0.062872, 0.039888]),
        ("ideal_rmse", "displacement_rmse_mm", [0.152165, 0.152165, 0.198419]),
    ] {
        for ((parameter, axis), known) in [("r_x", "x"), ("r_y", "y"), ("s_z", "z")].into_iter().zip(known) {
            let value = json[key][parameter].as_f64().unwrap();
            assert!((value - known).abs() <= 0.5e-6, "{key} {parameter} {value}");
            assert!((json[lengths][axis].as_f64().unwrap() - value / k).abs() < 1e-15);
        }
    }
    assert_eq!(json["layout"], "published film");
    assert_eq!(json["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!((json["points"].as_u64(), json["tiles"].as_u64()), (Some(405), Some(56)));
    assert_eq!(json["sha256"].as_str().unwrap().len(), 64);
    assert_eq!(json["reference_mm"], serde_json::json!([0.0, 0.0, -5.0]));
    assert_eq!(json["singular_points_mm"], serde_json::json!([]));
}

#[test]
fn singular_points_are_counted_and_named() {
    let bench = Bench::new();
    // J along x: B_z = 0 on the plane x = 0, which the grid meets; the reference is beside it.
    bench.write(
        "shear.toml",
        "format = 1\nname = \"shear\"\n[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 1\n\
         [volume]\nx_mm = [-1, 1]\ny_mm = [-1, 1]\nz_mm = [-5, -4]\nstep_mm = 1\nreference_mm = [1, 0, -5]\n\
         [[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [1, 0, 0]\n",
    );
    let said = bench.run(&["decouple", "shear.toml"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    let named = "singular points (B_z = 0), left out: 6, at (0, -1, -5) (0, -1, -4) (0, 0, -5)";
    assert!(said.stdout.contains(named), "{}", said.stdout);
    let json: Value = serde_json::from_str(&bench.run(&["decouple", "shear.toml", "--format", "json"]).stdout).unwrap();
    assert_eq!(json["singular_points_mm"].as_array().unwrap().len(), 6);
    assert!(json["uniformity_rmse"]["r_x"].as_f64().unwrap().is_finite());
}

#[test]
fn compare_as_text_and_json() {
    let said = Bench::new().run(&["compare", &shipped("published-film")]);
    assert!(said.status == 0 && said.stdout.contains("best-fit amplitude") && said.stdout.contains("0.818730"));
    let said = Bench::new().run(&["compare", &shipped("published-film"), "--format", "json"]);
    let json: Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!(json["comparison"]["points"], 405);
    assert!((json["comparison"]["relative_rmse"].as_f64().unwrap() - 0.197428).abs() < 0.5e-6);
    assert_eq!(json["comparison"]["worst_at_mm"], serde_json::json!([0.0, 0.0, -3.0]));
}

#[test]
fn tiles_of_the_published_film() {
    let said = Bench::new().run(&["tiles", &shipped("published-film")]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    assert_eq!(said.stdout.lines().filter(|l| l.starts_with("  film-x")).count(), 56);
    assert!(said.stdout.contains("  film-x2-y1  3.3 x 0.85 x 1"), "{}", said.stdout);
    // Dai 2024, Table 1: 16 squares, 24 strips, 16 strips at the rim.
    let bill = said.stdout.split("bill of materials\n").nth(1).expect("a bill");
    let rows: Vec<String> = bill.lines().skip(1).map(|l| l.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
    let known = [
        "16 3.3 x 3.3 x 1 0.12 (0.707107, 0.707107, 0) film-x2-y2",
        "24 3.3 x 1.7 x 1 0.12 (1, 0, 0) film-x2-y3",
        "16 3.3 x 0.85 x 1 0.12 (1, 0, 0) film-x1-y2",
    ];
    assert_eq!(rows, known);
}

#[test]
fn check_tells_findings_from_failures() {
    let bench = Bench::new();
    let tile = "format = 1\nname = \"idle\"\n[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\n";
    bench.write("idle.toml", &format!("{tile}polarization_t = [0, 0, 0]\n"));
    let said = bench.run(&["check", "idle.toml"]);
    assert_eq!(said.status, 1);
    assert_eq!(said.stderr, "magsplice: idle.toml: tile \"tile-1\" has no polarization, so no field\n");

    // One that cannot be used does not hide the others.
    bench.write("broken.toml", tile);
    let said = bench.run(&["check", "broken.toml", "idle.toml"]);
    assert_eq!(said.status, 2);
    assert!(said.stderr.contains("broken.toml: line 3: tile \"tile-1\": has no polarization: give polarization_t"));
    assert!(said.stderr.contains("idle.toml: tile \"tile-1\" has no polarization, so no field"));
}

#[test]
fn a_tolerance_is_kept_and_named() {
    let bench = Bench::new();
    let fine = std::fs::read_to_string(shipped("published-film")).unwrap().replace("step_mm = 0.5", "step_mm = 0.125");
    bench.write("fine.toml", &fine);
    for (arguments, fraction, tesla) in [
        (["fine.toml", "--within", "1e-5", "-o", "rough.csv"], 1e-5, 0.0),
        (["fine.toml", "--within", "20 nT", "-o", "rough.csv"], 0.0, 20e-9),
    ] {
        for (command, path) in [
            (&["field", "fine.toml", "-o", "exact.csv"][..], "exact.csv"),
            (&[&["field"], &arguments[..]].concat(), "rough.csv"),
        ] {
            let said = bench.run(command);
            assert_eq!((said.status, said.stderr.as_str()), (0, ""), "{path}");
        }
        let (exact, rough) = (rows(&bench.read("exact.csv")), rows(&bench.read("rough.csv")));
        assert_eq!((exact.len(), rough.len()), (33 * 33 * 17, 33 * 33 * 17));
        let mut worst = 0.0_f64;
        for (exact, rough) in exact.iter().zip(&rough) {
            assert_eq!(exact[..3], rough[..3]);
            let error = (3..6).map(|c| (exact[c] - rough[c]).powi(2)).sum::<f64>().sqrt();
            let length = exact[3..].iter().map(|c| c * c).sum::<f64>().sqrt();
            assert!(error <= fraction * length + tesla, "off by {error} of {length}");
            worst = worst.max(error);
        }
        assert!(worst > 0.0, "the exact field is no cheaper way");
    }
    let json = |arguments: &[&str]| -> Value {
        let said = bench.run(&[&["decouple", "fine.toml", "--format", "json"], arguments].concat());
        serde_json::from_str(&said.stdout).unwrap()
    };
    assert_eq!(json(&[])["accuracy"], "exact");
    let within = json(&["--within", "2.5uT"]);
    assert_eq!(within["accuracy"], serde_json::json!({ "absolute_t": 2.5e-6 }));
    let apart =
        within["uniformity_rmse"]["r_x"].as_f64().unwrap() - json(&[])["uniformity_rmse"]["r_x"].as_f64().unwrap();
    assert!(apart != 0.0 && apart.abs() < 1e-3, "{apart}");
    let said = bench.run(&["decouple", "fine.toml", "--within", "1e-7"]);
    assert!(said.stdout.contains("\naccuracy: within 1e-7 of |B|\n"), "{}", said.stdout);
    let said = bench.run(&["compare", "fine.toml", "--within", "1e-15"]);
    assert_eq!(said.status, 2);
    assert!(
        said.stderr.contains("(-2, -2, -5) mm: the tolerance cannot be kept: even the exact field"),
        "{}",
        said.stderr
    );
    for wrong in ["0", "-1e-3", "nan", "1e-6 kT", "T", ""] {
        let said = bench.run(&["field", "fine.toml", &format!("--within={wrong}")]);
        assert_eq!((said.status, said.stdout.as_str()), (2, ""), "{wrong}");
        assert!(said.stderr.contains("must be a"), "{wrong}: {}", said.stderr);
    }
}

#[test]
fn wrong_arguments_are_refused() {
    let bench = Bench::new();
    assert_eq!(bench.run(&[]).status, 2);
    assert_eq!(bench.run(&["field"]).status, 2);
    assert_eq!(bench.run(&["field", &shipped("single-tile"), "--quantity", "m"]).status, 2);
    assert_eq!(bench.run(&["check"]).status, 2);
    assert_eq!(bench.run(&["--version"]).stdout, format!("magsplice {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn standard_input_and_output_by_name() {
    let layout = shipped("single-tile");
    let expected = Bench::new().run(&["field", &layout]).stdout;
    for name in ["-", "/dev/stdout"] {
        let bench = Bench::new();
        assert_eq!(bench.run(&["field", &layout, "-o", name]).stdout, expected);
        assert_eq!(bench.files(), [""; 0]);
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

#[test]
fn findings_are_told_even_if_the_list_is_not_read() {
    let bench = Bench::new();
    let grid = "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n\
                grid = { count = [100, 100, 1], pitch_mm = [1, 1, 1] }\n";
    bench.write("grid.toml", &format!("format = 1\nname = \"grid\"\n{grid}[kind.idle]\nsize_mm = [1, 1, 1]\n"));
    let output = unread(&["check", bench.path("grid.toml").to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("kind \"idle\" is declared but no tile uses it"));
}

/// Ctrl-C while a file is being written leaves nothing, and what was there before.
#[cfg(unix)]
#[test]
fn an_interruption_leaves_no_file() {
    let bench = Bench::new();
    bench.write("out.csv", "before");
    let volume = "[volume]\nx_mm = [-4, 4]\ny_mm = [-4, 4]\nz_mm = [-8, -1]\nstep_mm = 0.02\n";
    let tile = "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
    bench.write("large.toml", &format!("format = 1\nname = \"large\"\n{volume}{tile}"));
    let mut program = Command::new(env!("CARGO_BIN_EXE_magsplice"))
        .args(["field", "large.toml", "-o", "out.csv"])
        .current_dir(bench.path(""))
        .spawn()
        .unwrap();
    while bench.files().len() < 3 {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let killed = Command::new("kill").args(["-INT", &program.id().to_string()]).status().unwrap();
    assert!(killed.success());
    assert_eq!(program.wait().unwrap().code(), Some(130));
    assert_eq!(bench.files(), ["large.toml", "out.csv"]);
    assert_eq!(bench.read("out.csv"), "before");
}

#[test]
fn a_plan_says_what_serves_which_points_and_what_is_left_out() {
    let bench = Bench::new();
    let film = shipped("published-film");
    let said = bench.run(&["plan", &film, "--within", "1e-6"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    for line in [
        "405 points of the working volume",
        "accuracy: within 1e-6 of |B|",
        "left out       nothing",
        "(1.0 times as many)",
    ] {
        assert!(said.stdout.contains(line), "{line:?} is not in {}", said.stdout);
    }
    // A finer grid is worth an expansion.
    let fine = std::fs::read_to_string(&film)
        .expect("a shipped layout")
        .replace("step_mm = 0.5", "step_mm = 0.1")
        .replace("published.field.csv", "fine.csv");
    let fine = bench.write("fine.toml", &fine);
    let said = bench.run(&["plan", fine.to_str().expect("UTF-8"), "--within", "10nT", "--format", "json"]);
    let plan: Value = serde_json::from_str(&said.stdout).expect("JSON");
    let part = &plan["parts"][0];
    assert_eq!((plan["parts"].as_array().map(Vec::len), part["model"].as_str()), (Some(1), Some("chebyshev")));
    assert_eq!((part["points"].as_u64(), part["distance_mm"].as_f64()), (Some(41 * 41 * 21), Some(3.0)));
    assert!(part["error_t"].as_f64().expect("a number") <= 1e-8);
    let (cost, exact) = (plan["cost"].as_f64().expect("a number"), plan["exact_cost"].as_f64().expect("a number"));
    assert_eq!(exact, 56.0 * 41.0 * 41.0 * 21.0);
    assert!(10.0 * cost < exact, "{cost}");
    // Points without a volume, and neither.
    let tile = "format = 1\nname = \"t\"\n[[tile]]\nname = \"t\"\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
    let tile = bench.write("tile.toml", tile);
    let tile = tile.to_str().expect("UTF-8");
    bench.write("p.csv", "x_mm,y_mm,z_mm\n0,0,-500\n1,0,-600\n");
    let said = bench.run(&["plan", &shipped("film-80mm"), "--points", "p.csv", "--within", "1e-4"]);
    assert!(
        said.stdout.contains("2 points of p.csv") && said.stdout.contains("800 of 800 by 1.0 expansions of degree"),
        "{}",
        said.stdout
    );
    bench.run(&["plan", tile, "--within", "1e-4"]).refuses("the layout has no [volume] table to take points from");
}

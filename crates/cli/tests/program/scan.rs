//! `scan`: measured scans against the layout.

use std::fmt::Write;

use serde_json::Value;

use crate::{Sandbox, rows, shipped};

/// Columns of a scan of the published film: places, and readings there.
pub(crate) fn field(sandbox: &Sandbox) -> Vec<Vec<f64>> {
    let said = sandbox.run(&["field", &shipped("published-film")]);
    assert_eq!(said.status, 0);
    rows(&said.stdout)
}

pub(crate) fn write(sandbox: &Sandbox, names: &str, lines: &[Vec<f64>]) {
    let mut text = format!("{names}\n");
    for line in lines {
        let cells: Vec<String> = line.iter().map(|value| format!("{value:?}")).collect();
        let _ = writeln!(text, "{}", cells.join(","));
    }
    sandbox.write("scan.csv", &text);
}

fn fitted(sandbox: &Sandbox, options: &[&str]) -> Value {
    let film = sandbox.published_with("");
    let said =
        sandbox.run(&[&["scan", "scan.csv", "--layout", &film, "--format", "json", "--quiet"], options].concat());
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    serde_json::from_str(&said.stdout).expect("JSON")
}

fn number(of: &Value) -> f64 {
    of.as_f64().unwrap_or_else(|| panic!("{of} is no number"))
}

/// A film that is 5 % stronger, in a stray field, under a sensor that is turned by 2 degrees about
/// z and whose scan began 0.4 mm beside the middle.
#[test]
fn known_parameters_of_a_scan_are_recovered() {
    let sandbox = Sandbox::new();
    let (start, strength, offset_ut, turn) = ([0.4, -0.3, 0.2], 1.05, [30.0, -20.0, 40.0], 2.0_f64.to_radians());
    let lines: Vec<Vec<f64>> = field(&sandbox)
        .iter()
        .map(|row| {
            let (x, y, z) = (strength * row[3], strength * row[4], strength * row[5]);
            let (turned_x, turned_y) = (x * turn.cos() + y * turn.sin(), y * turn.cos() - x * turn.sin());
            let place = [row[0] - start[0], row[1] - start[1], row[2] - start[2]];
            let reading = [turned_x * 1e6 + offset_ut[0], turned_y * 1e6 + offset_ut[1], z * 1e6 + offset_ut[2]];
            place.into_iter().chain(reading).collect()
        })
        .collect();
    write(&sandbox, "x_mm,y_mm,z_mm,bx (uT),by (uT),bz (uT)", &lines);
    let result = fitted(&sandbox, &["--save", "saved.csv"]);
    let found = &result["fitted"];
    assert!((number(&found["strength"]) - strength).abs() < 1e-9, "{found}");
    for axis in 0..3 {
        assert!((number(&found["offset_t"][axis]) - 1e-6 * offset_ut[axis]).abs() < 1e-12, "{found}");
        assert!((number(&found["start_mm"][axis]) - start[axis]).abs() < 1e-9, "{found}");
        let turned = if axis == 2 { 2.0 } else { 0.0 };
        assert!((number(&found["rotation_deg"][axis]) - turned).abs() < 1e-9, "{found}");
        // The readings without offset and rotation, and the field of the layout, decouple alike.
        let parameter = ["r_x", "r_y", "s_z"][axis];
        let [corrected, simulated] =
            ["corrected", "simulated"].map(|name| number(&result["uniformity_rmse"][name][parameter]));
        assert!((corrected - simulated).abs() < 1e-9, "{result}");
    }
    assert_eq!(
        result["excluded"],
        serde_json::json!({ "incomplete": [], "saturated": [], "outliers": [], "plateau": null })
    );
    assert_eq!(result["repeated"], serde_json::json!([]));
    assert_eq!(result["grid"], serde_json::json!([9, 9, 5]));
    // The table has the places of the film, and no residuals.
    let saved = rows(&sandbox.read("saved.csv"));
    for (row, place) in saved.iter().zip(field(&sandbox)) {
        assert!((0..3).all(|axis| (row[axis] - place[axis]).abs() < 1e-9), "{row:?}");
        assert!((9..12).all(|column| row[column].abs() < 1e-12), "{row:?}");
    }
}

/// Without errors the uniformity RMSE is that of `decouple`.
#[test]
fn perfect_scan_has_the_uniformity_of_the_film() {
    let sandbox = Sandbox::new();
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &field(&sandbox));
    let decoupled = sandbox.run(&["decouple", &shipped("published-film"), "--format", "json"]).stdout;
    let decoupled: Value = serde_json::from_str(&decoupled).expect("JSON");
    let result = fitted(&sandbox, &["--fit", "strength"]);
    for name in ["r_x", "r_y", "s_z"] {
        let (found, expected) =
            (number(&result["uniformity_rmse"]["readings"][name]), number(&decoupled["uniformity_rmse"][name]));
        assert!((found - expected).abs() < 1e-12, "{name}: {found}, not {expected}");
    }
    assert_eq!(result["deviation"]["offset_t"], serde_json::json!([0.0, 0.0, 0.0]));
}

/// A stage returns to a position to some micrometres: the positions form the planes of the grid.
/// Positions at random form none, and the reason is printed.
#[test]
fn uniformity_at_positions_of_a_stage() {
    let sandbox = Sandbox::new();
    let mut state = 3_u64;
    let mut scatter = |mm: f64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        mm * (2.0 * (state >> 11) as f64 / (1_u64 << 53) as f64 - 1.0)
    };
    let exact = field(&sandbox);
    let film = sandbox.published_with("");
    let mut scan = |mm: f64| {
        let mut moved = |row: &Vec<f64>| row[..3].iter().map(|c| ((c + scatter(mm)) * 1e4).round() / 1e4).collect();
        let places: Vec<Vec<f64>> = exact.iter().map(&mut moved).collect();
        write(&sandbox, "x_mm,y_mm,z_mm", &places);
        assert_eq!(sandbox.run(&["field", &film, "--points", "scan.csv", "-o", "readings.csv"]).status, 0);
        write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &rows(&sandbox.read("readings.csv")));
        fitted(&sandbox, &["--fit", "strength"])
    };
    let (grid, stage) = (scan(0.0), scan(0.004));
    assert!(stage["grid"].is_null(), "{}", stage["grid"]);
    for name in ["r_x", "r_y", "s_z"] {
        let of = |scan: &Value| number(&scan["uniformity_rmse"]["readings"][name]);
        assert!((of(&stage) - of(&grid)).abs() < 1e-4, "{name}: {} and {}", of(&stage), of(&grid));
        assert!(stage["uniformity_rmse"]["omitted"][name].is_null());
    }
    // Scatter of more than half a step.
    let random = scan(0.3);
    for name in ["r_x", "r_y", "s_z"] {
        assert!(random["uniformity_rmse"]["readings"][name].is_null(), "{random}");
        let reason = random["uniformity_rmse"]["omitted"][name].as_str().expect("a reason");
        assert!(reason.contains("must differ by at most 0.1 mm"), "{reason}");
    }
    let said = sandbox.run(&["scan", "scan.csv", "--layout", &sandbox.published_with(""), "--fit", "strength"]);
    assert!(said.stdout.contains("undefined: most positions share no plane normal to x"), "{}", said.stdout);
}

#[test]
fn gaps_repeated_positions_and_outliers_are_named() {
    let sandbox = Sandbox::new();
    let mut lines = field(&sandbox);
    let mut state = 7_u64;
    for line in &mut lines {
        for value in &mut line[3..] {
            // Uniform noise of 5 uT.
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            *value += 1e-5 * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5);
        }
    }
    lines[99][4] += 1e-3;
    lines[19] = lines[20].clone();
    lines.remove(200);
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &lines);
    let said = sandbox.run(&["scan", "scan.csv", "--layout", &sandbox.published_with("")]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    let named = "404 readings on a grid of 9 x 9 x 5; 2 missing: (-2, -0.5, -3), (0, 0, -5) mm; 1 repeated: line 22";
    assert!(said.stdout.contains(named), "{}", said.stdout);
    assert!(said.stderr.contains("scan.csv: line 101: excluded as an outlier, residual ("), "{}", said.stderr);
    assert!(said.stdout.lines().all(|line| line.len() <= 140), "{}", said.stdout);
    let result = fitted(&sandbox, &[]);
    assert_eq!(result["excluded"]["outliers"], serde_json::json!([101]));
    assert!((number(&result["residual_t"]) / (1e-5 / 12.0_f64.sqrt()) - 1.0).abs() < 0.1, "{result}");
    for name in ["offset_t", "start_mm", "rotation_deg"] {
        for axis in 0..3 {
            let [value, deviation] = ["fitted", "deviation"].map(|of| number(&result[of][name][axis]));
            assert!(deviation > 0.0 && value.abs() < 5.0 * deviation, "{name}: {value} +- {deviation}");
        }
    }
}

#[test]
fn scans_that_cannot_be_fitted_are_refused() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    let with = |text: &str| {
        sandbox.write("scan.csv", text);
        sandbox.run(&["scan", "scan.csv", "--layout", &film])
    };
    let names = "x_mm,y_mm,z_mm,bx_mt,by_mt,bz_mt";
    with(&format!("{names}\n0,0,-4,0,0,3\n"))
        .refuses("scan.csv: too few readings for the parameters: 1, must be at least 5");
    with(&format!("{names}\n{}", "0,0,-4,0,0,3\n".repeat(9))).refuses("scan.csv: the scan does not determine ");
    with("x,y,z,bx_mt,by_mt,bz_mt\n0,0,-4,0,0,3\n")
        .refuses("line 1: the columns x, y, z of the position have no unit: rename, as in x_mm, or give --unit");
    with("bx_mt,by_mt,bz_mt\n0,0,3\n")
        .refuses("line 1: no columns x_mm, y_mm, z_mm of the position (found: bx_mt,by_mt,bz_mt)");
    with(&format!("{names}\n0,0,-4,0,a,3\n")).refuses("line 2: by_mt = \"a\", must be a finite number");
}

/// Without a stated noise, smooth residuals are errors of the tiles.
#[test]
fn strength_is_held_by_smooth_residuals_of_an_unknown_noise() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    for index in ["0", "1", "2"] {
        let sample = ["tolerance", "sample", &film, "--preset", "workshop", "--index", index, "--scan", "scan.csv"];
        assert_eq!(sandbox.run(&sample).status, 0);
        let said = sandbox.run(&["scan", "scan.csv", "--layout", &film]);
        assert!(said.stdout.contains("strength / strength of layout, held      1.000000"), "{}", said.stdout);
        assert!(said.stderr.contains("each 10 % of strength is about 0.1"), "{}", said.stderr);
    }
}

/// Readings along a line, with noise: what they do not determine is named.
#[test]
fn parameters_that_a_line_does_not_determine_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("[sensor]\nnoise_ut = 5");
    let points: Vec<String> = (0..41).map(|n| format!("0.5,0.3,{:?}", -3.0 - 0.1 * f64::from(n))).collect();
    sandbox.write("points.csv", &format!("x_mm,y_mm,z_mm\n{}\n", points.join("\n")));
    let sample = [
        "tolerance",
        "sample",
        &film,
        "--preset",
        "workshop",
        "--points",
        "points.csv",
        "--scan",
        "scan.csv",
        "-o",
        "made.toml",
    ];
    assert_eq!(sandbox.run(&sample).status, 0);
    sandbox
        .run(&["scan", "scan.csv", "--layout", "made.toml"])
        .refuses("the scan does not determine rotation about z: fit fewer parameters");
    let said = sandbox.run(&["scan", "scan.csv", "--layout", "made.toml", "--fit", "strength,offset"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
}

/// A sensor whose range is smaller than stated.
#[test]
fn outliers_at_one_extreme_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("[sensor]\nnoise_ut = 5");
    let clipped = |row: &Vec<f64>| row.iter().enumerate().map(|(n, v)| if n < 3 { *v } else { v.min(7e-3) }).collect();
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &field(&sandbox).iter().map(clipped).collect::<Vec<_>>());
    let said = sandbox.run(&["scan", "scan.csv", "--layout", &film]);
    let named = "5 outliers share the largest reading of bz: if it is the limit of the sensor, state it as range_mt in \
                 [sensor] (it is 7.000000 mT)";
    assert!(said.stderr.contains(named), "{}{}", said.stdout, said.stderr);
}

/// A sensor of 16 bits with the range of the part, and the field 3 mm below the film.
#[test]
fn saturated_readings_are_excluded_and_named() {
    let sandbox = Sandbox::new();
    sandbox.published_with("[sensor]\npart = \"MLX90393\"");
    let points: Vec<String> = (0..361).map(|n| format!("{},{},-3", n % 19 - 9, n / 19 - 9)).collect();
    sandbox.write("points.csv", &format!("x_mm,y_mm,z_mm\n{}\n", points.join("\n")));
    let field = rows(&sandbox.run(&["field", "film.toml", "--points", "points.csv"]).stdout);
    let counts = [0.15e-6, 0.15e-6, 0.242e-6];
    let clipped = |factor: f64| -> (Vec<Vec<f64>>, usize) {
        let mut saturated = 0;
        let read = |row: &Vec<f64>| -> Vec<f64> {
            let counted = (0..3).map(|axis| (factor * row[3 + axis] / counts[axis]).round());
            let limited: Vec<f64> = counted.map(|count| count.clamp(-32768.0, 32767.0)).collect();
            saturated += usize::from(limited.iter().any(|count| [-32768.0, 32767.0].contains(count)));
            row[..3].iter().copied().chain((0..3).map(|axis| limited[axis] * counts[axis])).collect()
        };
        let lines = field.iter().map(read).collect();
        (lines, saturated)
    };
    // Stronger films saturate more readings. More than a third is at the limit of the last.
    for factor in [1.0, 1.3, 2.0] {
        let (lines, saturated) = clipped(factor);
        assert!(factor < 1.9 || saturated > 120, "{saturated}");
        write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &lines);
        let said = sandbox.run(&["scan", "scan.csv", "--layout", "film.toml", "--format", "json"]);
        assert_eq!(said.status, 0, "{}", said.stderr);
        let found: Value = serde_json::from_str(&said.stdout).expect("JSON");
        assert_eq!(found["excluded"]["saturated"].as_array().expect("a list").len(), saturated);
        assert_eq!(found["excluded"]["outliers"], serde_json::json!([]));
        assert!((number(&found["fitted"]["strength"]) - factor).abs() < 0.002 * factor, "{found}");
        if saturated > 0 {
            assert!(said.stderr.contains("excluded as saturated: a component is at the limit"), "{}", said.stderr);
        }
    }
}

#[cfg(feature = "report")]
#[test]
fn measured_planes_are_drawn_beside_simulated_ones() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    let mut lines: Vec<Vec<f64>> = field(&sandbox).iter().map(|row| row[..6].to_vec()).collect();
    lines.remove(100);
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &lines);
    let said = sandbox.run(&["scan", "scan.csv", "--layout", &film, "--figures", "figures"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    for name in ["scan-field-lowest", "scan-field-highest", "scan-parameters-middle", "scan-parameters-upright-x"] {
        assert!(sandbox.read(&format!("figures/{name}.svg")).contains("measured"), "{name}");
        // Measured and simulated are the same film; what is missing is empty in both.
        let table = sandbox.read(&format!("figures/{name}.csv"));
        let (full, gaps): (Vec<&str>, Vec<&str>) = table.lines().skip(1).partition(|line| !line.contains(",,"));
        for line in &full {
            let row: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
            assert!((0..3).all(|n| (row[3 + n] - row[6 + n]).abs() < 1e-7), "{name}: {line}");
        }
        assert!(full.len() >= 44 && gaps.len() <= 1, "{name}: {} and {}", full.len(), gaps.len());
    }
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &lines.iter().step_by(7).cloned().collect::<Vec<_>>());
    sandbox
        .run(&["scan", "scan.csv", "--layout", &film, "--figures", "other"])
        .refuses("scan.csv: --figures needs positions on a grid with equal steps");
    assert!(!sandbox.path("other").exists());
}

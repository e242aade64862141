//! `scan`: measured scans against the layout.

use std::fmt::Write;

use serde_json::Value;

use crate::{Sandbox, rows, shipped};

/// Columns of a scan of the published film: places, and readings there.
fn field(sandbox: &Sandbox) -> Vec<Vec<f64>> {
    let said = sandbox.run(&["field", &shipped("published-film")]);
    assert_eq!(said.status, 0);
    rows(&said.stdout)
}

fn write(sandbox: &Sandbox, names: &str, lines: &[Vec<f64>]) {
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

/// An offset makes up for a film of the same wavelength with other tiles.
#[test]
fn offsets_that_no_sensor_has_are_named() {
    let sandbox = Sandbox::new();
    let other = std::fs::read_to_string(shipped("designed-stock")).expect("readable");
    let other = other.split("\n\n").filter(|part| !part.contains("[sensor]")).collect::<Vec<_>>().join("\n\n");
    sandbox.write("other.toml", &other);
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &field(&sandbox));
    let said = sandbox.run(&["scan", "other.toml", "scan.csv"]);
    assert!(said.stderr.contains("the fitted offset is 5"), "{}{}", said.stderr, said.stdout);
    assert!(
        said.stderr.contains(" uT, several times the field of the earth: another magnet is near"),
        "{}",
        said.stderr
    );
}

/// Units of positions of a film made by hand, whose errors look like another strength, and
/// positions that count from a corner of the scan.
#[test]
fn units_of_positions_are_named_for_films_made_by_hand() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("[sensor]\npart = \"MLX90393\"");
    let sample = ["tolerance", "sample", &film, "--preset", "by-hand", "--scan", "made.csv"];
    assert_eq!(sandbox.run(&sample).status, 0);
    let made = rows(&sandbox.read("made.csv"));
    for (unit, length, origin) in [("centimetres", 10.0, 0.0), ("inches", 25.4, 7.0), ("metres", 1e3, 0.0)] {
        let scaled = |row: &Vec<f64>| -> Vec<f64> {
            let (at, b) = row.split_at(3);
            at.iter().map(|x| (x + origin) / length).chain(b.iter().copied()).collect()
        };
        write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &made.iter().map(scaled).collect::<Vec<_>>());
        let said = sandbox.run(&["scan", "scan.csv", "--layout", &film]);
        said.refuses(&format!("times as large: the positions are in {unit}, must be in mm"));
    }
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

/// One plane with z counted downwards is no plane of a sensor with reversed axes. Positions in
/// another unit are an error, in `diagnose` too.
#[test]
fn planes_counted_downwards_and_positions_in_another_unit_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    let (names, field) = ("x_mm,y_mm,z_mm,bx_t,by_t,bz_t", field(&sandbox));
    let plane = |sign: f64| -> Vec<Vec<f64>> {
        let nearest = field.iter().filter(|row| row[2] == -3.0);
        nearest.map(|row| vec![row[0], row[1], 3.0, row[3], row[4], sign * row[5]]).collect()
    };
    write(&sandbox, names, &plane(1.0));
    let said = sandbox.run(&["scan", "scan.csv", "--layout", &film]);
    assert!(said.stdout.contains("axes of the positions: z is reversed: change their columns"), "{}", said.stdout);
    assert!(!said.stdout.contains("axes of the sensor"), "{}", said.stdout);
    let said = sandbox.run(&["diagnose", &film, "--scan", "scan.csv", "--noise", "1uT"]);
    said.refuses("axes of the positions: z is reversed: change their columns");
    let across: Vec<Vec<f64>> =
        field.iter().map(|row| vec![row[0], row[1], -row[2], row[3], row[4], -row[5]]).collect();
    write(&sandbox, names, &across);
    let said = sandbox.run(&["scan", "scan.csv", "--layout", &film]);
    assert!(
        said.stderr.contains("the sensor was on the other side of the film than [volume]: the film is turned over")
    );
    for (unit, length) in [("inches", 25.4), ("metres", 1e3), ("micrometres", 1e-3)] {
        let scaled =
            |row: &Vec<f64>| row.iter().enumerate().map(|(n, v)| if n < 3 { v / length } else { *v }).collect();
        write(&sandbox, names, &field.iter().map(scaled).collect::<Vec<_>>());
        for verb in [&["scan", &film, "scan.csv"][..], &["diagnose", &film, "--scan", "scan.csv", "--noise", "1uT"]] {
            let said = sandbox.run(verb);
            said.refuses(&format!("times as large: the positions are in {unit}, must be in mm; the unit stands in"));
        }
    }
}

/// The scan of a film that is 3 % stronger, with exchanged axes, a turned sensor, the coordinates
/// of a stage, z counted downwards, and missing cells: the strength is found, and the cause is
/// named.
#[test]
fn axes_and_places_other_than_stated_are_found_and_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    type Change = fn(&[f64]) -> Vec<f64>;
    let changes: [(Change, &str); 6] = [
        (
            |row| vec![row[0], row[1], row[2], row[4], row[3], row[5]],
            "axes of the sensor: x and y are exchanged: name the columns of the field by, bx, bz",
        ),
        (
            |row| vec![row[0], row[1], row[2], row[3], row[4], -row[5]],
            "axes of the sensor: z is reversed: set gain = [1, 1, -1] in [sensor]",
        ),
        (|row| vec![row[0], row[1], row[2], -row[3], -row[4], row[5]], "180.0"),
        (
            |row| vec![row[0], row[1], row[2], row[4], row[5], row[3]],
            "its rotation is that of exchanged axes: x, y, z are y, z, x: if it was not mounted so, name the columns of \
             the field by, bz, bx",
        ),
        (|row| vec![row[0] + 102.0, row[1] + 55.0, row[2] + 5.0, row[3], row[4], row[5]], "-102.0"),
        (
            |row| vec![row[0], row[1], 30.0 - row[2], row[3], row[4], row[5]],
            "axes of the positions: z is reversed: change their columns",
        ),
    ];
    let field = field(&sandbox);
    for (change, named) in changes {
        let stronger = |row: &Vec<f64>| -> Vec<f64> {
            let values = row.iter().enumerate().map(|(n, value)| if n < 3 { *value } else { 1.03 * value });
            change(&values.collect::<Vec<f64>>())
        };
        write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &field.iter().map(stronger).collect::<Vec<_>>());
        let said = sandbox.run(&["scan", "scan.csv", "--layout", &film]);
        assert_eq!((said.status, said.stderr.as_str()), (0, ""), "{named}");
        assert!(said.stdout.contains(named), "{named}: {}", said.stdout);
        let row = said.stdout.lines().find(|line| line.contains("strength / strength")).expect("a row");
        assert!(row.ends_with(" 1.030000"), "{named}: {row}");
    }
    // Missing readings: NaN, and empty cells.
    let mut text = "x_mm,y_mm,z_mm,bx_t,by_t,bz_t\n".to_owned();
    for (index, row) in field.iter().enumerate() {
        let cells = match index % 50 {
            0 => "NaN,NaN,NaN".to_owned(),
            1 => format!("{:?},,{:?}", row[3], row[5]),
            _ => format!("{:?},{:?},{:?}", row[3], row[4], row[5]),
        };
        let _ = writeln!(text, "{:?},{:?},{:?},{cells}", row[0], row[1], row[2]);
    }
    sandbox.write("scan.csv", &text);
    let said = sandbox.run(&["scan", "scan.csv", "--layout", &film]);
    assert!(said.stdout.contains("incomplete, excluded                             18"), "{}", said.stdout);
    assert!(
        said.stderr.contains("scan.csv: line 2: excluded as incomplete: a component is missing"),
        "{}",
        said.stderr
    );
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

/// A film of another pattern, and readings in another unit than their columns say.
#[test]
fn fits_that_are_hardly_those_of_the_film_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    let scaled = |factor: f64| -> Vec<Vec<f64>> {
        let rows = field(&sandbox);
        rows.iter().map(|row| row[..3].iter().copied().chain(row[3..6].iter().map(|b| factor * b)).collect()).collect()
    };
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &scaled(3.0));
    let said = sandbox.run(&["scan", "scan.csv", "--layout", &film]);
    let strength = "scan.csv: the fitted strength is 3.000000 times the strength of the layout";
    assert!(said.stderr.contains(strength), "{}", said.stderr);
    write(&sandbox, "x_mm,y_mm,z_mm,bx_mt,by_mt,bz_mt", &scaled(1e4));
    let unit = "scan.csv: the readings times 0.1 fit the film: they have another unit, such as gauss in a column of mT";
    sandbox.run(&["scan", "scan.csv", "--layout", &film]).refuses(unit);
    for options in [&[][..], &["--fit", "--preset", "workshop"]] {
        let diagnose = ["diagnose", &film, "--scan", "scan.csv", "--noise", "5uT"];
        sandbox.run(&[&diagnose, options].concat()).refuses(unit);
    }
    sandbox.published_with("[sensor]\nnoise_ut = 1");
    let lines: Vec<Vec<f64>> = field(&sandbox)
        .iter()
        .enumerate()
        .map(|(n, row)| {
            let error = if n % 2 == 0 { 1e-5 } else { -1e-5 };
            row[..3].iter().copied().chain(row[3..6].iter().map(|b| b + error)).collect()
        })
        .collect();
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &lines);
    let said = sandbox.run(&["scan", "scan.csv", "--layout", "film.toml"]);
    assert!(said.stderr.contains("times the noise of the sensor: the film differs from the layout"), "{}", said.stderr);
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

/// The lines of a scan turned by an angle about z, and those of the field.
fn turned(lines: &[Vec<f64>], angle_deg: f64) -> Vec<Vec<f64>> {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    let turn = |x: f64, y: f64| [cos * x - sin * y, sin * x + cos * y];
    let of = |row: &Vec<f64>| [&turn(row[0], row[1])[..], &[row[2]], &turn(row[3], row[4]), &[row[5]]].concat();
    lines.iter().map(of).collect()
}

/// A film that lies turned on the stage. With errors of every tile the turn leaves their field,
/// more than half of the residual, and the errors that are expected then explain it.
#[test]
fn films_turned_on_the_stage_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("[sensor]\nnoise_ut = 5");
    let names = "x_mm,y_mm,z_mm,bx_t,by_t,bz_t";
    write(&sandbox, names, &turned(&field(&sandbox), 12.0));
    let named = "if it was turned by 12.0 deg about z against the positions: turn positions and readings by -12.0 deg";
    sandbox.run(&["scan", &film, "scan.csv"]).refuses(named);
    sandbox.run(&["diagnose", &film, "--scan", "scan.csv"]).refuses(named);
    let sample = ["tolerance", "sample", &film, "--preset", "by-hand", "--scan", "made.csv", "-o", "made.toml"];
    assert_eq!(sandbox.run(&sample).status, 0);
    write(&sandbox, names, &turned(&rows(&sandbox.read("made.csv")), 10.0));
    let diagnose = ["diagnose", &film, "--scan", "scan.csv", "--preset", "by-hand"];
    sandbox.run(&diagnose).refuses("deg about z against the positions: turn positions and readings by");
}

/// Two columns with the same values, a stuck axis, and two equal coordinates are causes that the
/// fit does not show. The same columns are no fault where the scan fits.
#[test]
fn columns_that_no_scan_has_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    let field = field(&sandbox);
    let changed = |change: fn(&mut [f64])| -> Vec<Vec<f64>> {
        let mut lines: Vec<Vec<f64>> = field.iter().step_by(4).cloned().collect();
        lines.iter_mut().for_each(|line| change(line));
        lines
    };
    type Change = fn(&mut [f64]);
    let cases: [(Change, &str); 3] = [
        (|line| line[4] = line[3], "bx and by are equal in all readings"),
        (|line| line[5] = 1e-3, "bz is 1 mT in all readings"),
        (|line| line[1] = line[0], "x and y of all positions are equal"),
    ];
    for (change, cause) in cases {
        write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &changed(change));
        sandbox.run(&["scan", &film, "scan.csv"]).refuses(cause);
    }
    sandbox.run(&["diagnose", &film, "--scan", "scan.csv", "--noise", "10uT"]).refuses("x and y of all positions");
    let mut stuck = changed(|_| ());
    let (half, count) = (stuck.len() / 2, stuck.len());
    let reading_t = stuck[half][4];
    stuck[half..].iter_mut().for_each(|line| line[4] = reading_t);
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &stuck);
    let cause = format!("mT in {} successive readings, from reading {} on", count - half, half + 1);
    sandbox.run(&["scan", &film, "scan.csv"]).refuses(&cause);
    sandbox.run(&["diagnose", &film, "--scan", "scan.csv", "--noise", "10uT"]).refuses(&cause);
    let mut still = field.clone();
    let half = still.len() / 2;
    let x_mm = still[half][0];
    still[half..].iter_mut().for_each(|line| line[0] = x_mm);
    let first = still.iter().rposition(|line| line[0] != x_mm).expect("other positions") + 2;
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &still);
    let cause = format!("x has one value from reading {first} on: the stage or its log stood still");
    sandbox.run(&["scan", &film, "scan.csv"]).refuses(&cause);
    sandbox.run(&["diagnose", &film, "--scan", "scan.csv", "--noise", "10uT"]).refuses(&cause);
    // On the diagonal bx and by are equal, and the film has no other reading there.
    let diagonal: Vec<Vec<f64>> = field.into_iter().filter(|line| line[0] == line[1]).collect();
    write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &diagonal);
    let said = sandbox.run(&["scan", &film, "scan.csv", "--fit", "strength,offset"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
}

/// Readings that are a row late, a column of positions that is, lines that were scanned to and fro,
/// and a log that was frozen. The axes of the sensor have noise, so that no readings are equal.
#[test]
fn readings_in_another_order_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("[sensor]\nnoise_ut = 2");
    let sample = ["tolerance", "sample", &film, "--preset", "jig", "--scan", "made.csv"];
    assert_eq!(sandbox.run(&sample).status, 0);
    let made = rows(&sandbox.read("made.csv"));
    let scan = |change: &dyn Fn(&mut [Vec<f64>])| {
        let mut lines = made.clone();
        change(&mut lines);
        write(&sandbox, "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", &lines);
        sandbox.run(&["scan", &film, "scan.csv"])
    };
    assert_eq!(scan(&|_| ()).status, 0);
    let moved = |lines: &mut [Vec<f64>], columns: std::ops::Range<usize>, rows: usize| {
        for row in (rows..lines.len()).rev() {
            let earlier = lines[row - rows][columns.clone()].to_vec();
            lines[row][columns.clone()].copy_from_slice(&earlier);
        }
    };
    scan(&|lines| moved(lines, 3..6, 1))
        .refuses("the readings fit the positions 1 row earlier than their own far better");
    let diagnose = ["diagnose", &film, "--scan", "scan.csv"];
    sandbox.run(&diagnose).refuses("the readings fit the positions 1 row earlier than their own far better");
    scan(&|lines| moved(lines, 0..3, 2))
        .refuses("the readings fit the positions 2 rows later than their own far better");
    scan(&|lines| moved(lines, 2..3, 1)).refuses("the readings fit z of the positions 1 row later than their own");
    // Nine lines along y of five heights each, for each x.
    let to_and_fro = |lines: &mut [Vec<f64>]| {
        lines.chunks_mut(45).skip(1).step_by(2).flatten().for_each(|line| line[1] = -line[1]);
    };
    scan(&to_and_fro).refuses("the readings of every second line of the scan fit y in reversed order far better");
    let frozen = scan(&|lines| {
        let last = lines[300][3..].to_vec();
        lines[300..].iter_mut().for_each(|line| line[3..].copy_from_slice(&last));
    });
    frozen.refuses("rows 301 to 405 are equal in all components of the readings, at different positions: the log was");
    // Columns of different units are named before the fit fails.
    sandbox.write("scan.csv", &sandbox.read("made.csv").replace("z_mm", "z_cm"));
    let said = sandbox.run(&["scan", &film, "scan.csv"]);
    assert!(said.stderr.contains("the coordinates have different units: x_mm, y_mm, z_cm"), "{}", said.stderr);
}

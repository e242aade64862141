//! Files of measured fields, forces and tiles as instruments write them: missing values, units,
//! lines before the names.

use crate::{RunOutput, Sandbox, rows, shipped};

/// The readings of the reference point and of another point of the published film.
const READINGS: &str = "bx_mt,by_mt,bz_mt\n0,0,2\n0.1,-0.2,2.5\n";

/// What `read` prints for this file, by the published film with `sensor` added.
fn read(readings: &str, sensor: &str, options: &[&str]) -> RunOutput {
    let sandbox = Sandbox::new();
    sandbox.write("b.csv", readings);
    sandbox.published_with(sensor);
    sandbox.run(&[&["read", "b.csv", "--layout", "film.toml"], options].concat())
}

/// Asserts that the displacements are those of [`READINGS`], to the round-off of a conversion.
#[track_caller]
fn same(readings: &str, sensor: &str, options: &[&str]) {
    let (wanted, found) = (read(READINGS, sensor, &[]), read(readings, sensor, options));
    assert_eq!((found.status, found.stderr.as_str()), (0, ""), "{readings}");
    let (wanted, found) = (rows(&wanted.stdout), rows(&found.stdout));
    assert_eq!((wanted.len(), found.len()), (2, 2), "{readings}");
    for (wanted, found) in wanted.iter().zip(&found) {
        let near = wanted.iter().zip(found).all(|(wanted, found)| (wanted - found).abs() < 1e-9);
        assert!(near, "{readings}: {found:?}, not {wanted:?}");
    }
}

#[test]
fn units_of_instruments_are_read() {
    for (names, first, second) in [
        ("Bx (G),By (G),Bz (G)", "0,0,20", "1,-2,25"),
        ("Bx [mT],By [mT],Bz [mT]", "0,0,2", "0.1,-0.2,2.5"),
        ("B_x/mT;B_y/mT;B_z/mT", "0;0;2", "0,1;-0,2;2,5"),
        ("b_x_t,b_y_t,b_z_t", "0,0,2e-3", "1e-4,-2e-4,2.5e-3"),
        ("bx mT\tby mT\tbz mT", "0\t0\t2", "0.1\t-0.2\t2.5"),
        ("Bx_kG Gs By_kG Bz_kG", "0 7 0 2e-2", "1e-3 7 -2e-3 2.5e-2"),
        ("Bx_mG By_mG Bz_mG", "0 0 2e4", "1e3 -2e3 2.5e4"),
        ("Hx (Oe),Hy (Oe),Hz (Oe)", "0,0,20", "1,-2,25"),
        ("\"Bx (mT)\", \"By (mT)\", \"Bz (mT)\", \"Sample, no\"", "0, 0, 2, \"a, b\"", "0.1, -0.2, 2.5, c"),
        ("\"Sample number\" \"Bx (mT)\" \"By (mT)\" \"Bz (mT)\"", "1 0 0 2", "2 0.1 -0.2 2.5"),
        ("'Bx, uT';'By, uT';'Bz, uT'", "0;0;2000", "100;-200;2500"),
    ] {
        same(&format!("{names}\n{first}\n{second}\n"), "", &[]);
        same(&format!("\u{feff}{names}\r\n{first}\r\n{second}"), "", &[]);
    }
    same("Bx,By,Bz\n0,0,20\n1,-2,25\n", "", &["--unit", "g"]);
    let mixed = read("Bx_kG,By_G,Bz_mG\n0,0,2e4\n", "", &[]);
    assert!(mixed.stderr.contains("the readings have different units: Bx_kG, By_G, Bz_mG"), "{}", mixed.stderr);
}

/// Counts of the MLX90393 with GAIN_SEL = 7 and RES = 0: 0.15 uT along x and y, 0.242 uT along z.
#[test]
fn counts_are_converted_by_the_sensor() {
    let sensor = "\n[sensor]\npart = \"MLX90393\"\nnoise_ut = 0\n";
    let counts = |z: f64| z / 0.242e-3;
    let text =
        |names: &str| format!("{names}\n0,0,{:?}\n{:?},{:?},{:?}\n", counts(2.0), 2e3 / 3.0, -4e3 / 3.0, counts(2.5));
    same(&text("bx_counts,by_counts,bz_counts"), sensor, &[]);
    same(&text("Bx (LSB),By (LSB),Bz (LSB)"), sensor, &[]);
    same(&text("bx,by,bz"), sensor, &["--unit", "counts"]);
    read(&text("bx_counts,by_counts,bz_counts"), "", &[]).refuses(
        "b.csv: line 1: counts in bx_counts, by_counts, bz_counts, and film.toml does not give the flux density of a \
         count: add part or count_ut to [sensor]",
    );
}

#[test]
fn lines_before_the_names_are_skipped() {
    let rows = "0,0,2\n0.1,-0.2,2.5\n";
    for before in [
        "Gaussmeter X-100\n",
        "Instrument;X-100\nDate,2024-01-02 10:11\n\n# operator: a\n",
        "% made by a script\n; and another\n",
        "Field along x y z of the film\nPoints: 2\n",
    ] {
        same(&format!("{before}bx_mt,by_mt,bz_mt\n{rows}"), "", &[]);
    }
    same("Instrument X\n% bx_mt by_mt bz_mt\n0 0 2\n% pause\n; pause\n0.1 -0.2 2.5\n", "", &[]);
    // Units in a line of their own.
    for names in ["No,Bx,By,Bz\n,mT,mT,mT", "No;Bx;By;Bz\n-;(mT);(mT);(mT)", "No\tBx\tBy\tBz\n\n\t[mT]\t[mT]\t[mT]"] {
        let mark = if names.contains(';') {
            ";"
        } else if names.contains('\t') {
            "\t"
        } else {
            ","
        };
        let rows = "1,0,0,2\n2,0.1,-0.2,2.5\n".replace(',', mark);
        same(&format!("X-100\n{names}\n{rows}"), "", &[]);
    }
    same("X Pos [mm],|B| [mT],Bx [mT],By [mT],Bz [mT]\n0,2,0,0,2\n1,---,0.1,-0.2,2.5\n", "", &[]);
    read("Bx,By,Bz\nmm,mm,mm\n0,0,2\n", "", &[]).refuses("line 1: the columns Bx, By, Bz of the flux density have");
    // A row of numbers is no line before the names.
    read("0,0,2\nbx_mt,by_mt,bz_mt\n0,0,2\n", "", &[]).refuses("line 1: has no names of columns");
    read("Gaussmeter\nbx_mt,by_mt\n0,0\n", "", &[])
        .refuses("line 2: no column bz_mt of the flux density (found: bx_mt,by_mt)");
}

#[test]
fn faults_of_units_have_one_wording() {
    for (names, options, message) in [
        (
            "Bx (V),By (V),Bz (V)",
            &[][..],
            "line 1: the columns Bx (V), By (V), Bz (V) of the flux density have the unit v, must be one of: T, mT, uT, nT, \
             G, mG, kG, Oe, mOe, kOe, counts\n",
        ),
        (
            "Bx,By,Bz_mt",
            &[],
            "the columns Bx, By of the flux density have no unit: rename, as in bx_mt, or give --unit",
        ),
        ("Bx,By,Bz", &["--unit", "mm"], "--unit mm is no unit of these columns, must be one of: T, mT, uT, nT, G,"),
        ("Bx,By,Bz", &["--unit", ","], "must be a unit, or several with commas between them, such as mm,uT"),
        ("Bx_mT,By_mT,Bz_mT,bx_t", &[], "more than one column bx of the flux density: Bx_mT, bx_t"),
    ] {
        let said = read(
            &format!(
                "{names}\n{}\n",
                "1,2,3,4".split_at(if names.len() > 20 && names.ends_with("bx_t") { 7 } else { 5 }).0
            ),
            "",
            options,
        );
        assert!(said.status == 2 && said.stderr.contains(message), "{names}: {}", said.stderr);
    }
}

#[test]
fn missing_readings_are_counted_and_named() {
    let text = "bx_mt,by_mt,bz_mt,note\n0,0,2,a\n,,,\n0.1,nan,2,\nNA,0,null,-\n0.1,-0.2,2.5,b\n,,,\n";
    let said = read(text, "", &[]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    let found = rows(&said.stdout);
    let status: Vec<f64> = found.iter().map(|row| row[row.len() - 1]).collect();
    assert_eq!(status, [0.0, 5.0, 5.0, 5.0, 0.0]);
    assert!(found[1][1].is_nan() && found[4][0] == 5.0);
    for line in [3, 4, 5] {
        assert!(
            said.stderr.contains(&format!("b.csv: line {line}: a component of the reading is missing")),
            "{}",
            said.stderr
        );
    }
}

/// A log that was cut within its last line. A short line elsewhere stays an error.
#[test]
fn cut_last_line_is_left_out() {
    for cut in ["0.1,-0.2", "0.1,-0.2,2.5e-", "0.", "0.1,\"-0."] {
        let said = read(&format!("{READINGS}{cut}"), "", &[]);
        assert_eq!((said.status, rows(&said.stdout).len()), (0, 2), "{cut}: {}", said.stderr);
        assert_eq!(said.stderr, "magsplice: b.csv: line 4: left out: the file ends within this line\n");
    }
    // Ten numbers with three decimals, and one with two that no end of line follows.
    let with = |last: &str| format!("bx_mt,by_mt,bz_mt\n{}{last}", "0.100,-0.200,2.500\n".repeat(10));
    for (last, left) in [("0.100,-0.200,2.50", 10), ("0.100,-0.200,2.500", 11), ("0.100,-0.200,2.50\n", 11)] {
        assert_eq!(rows(&read(&with(last), "", &[]).stdout).len(), left, "{last:?}");
    }
    read(&format!("{READINGS}0.1,-0.2\n"), "", &[]).refuses("line 4: has 2 fields, must have 3 like line 1");
    read("bx_mt,by_mt,bz_mt\n0,0\n0,0,2", "", &[]).refuses("line 2: has 2 fields, must have 3 like line 1");
    // Points and blocks are not logs.
    let sandbox = Sandbox::new();
    sandbox.write("p.csv", "x_mm,y_mm,z_mm\n9,9,9\n9,9");
    sandbox.run(&["field", &shipped("single-tile"), "--points", "p.csv"]).refuses("line 3: has 2 fields");
}

/// A scan and a calibration with bare names, missing readings and positions, and a cut end.
#[test]
fn scans_and_calibrations_read_logs() {
    let sandbox = Sandbox::new();
    let film = shipped("published-film");
    let field = rows(&sandbox.run(&["field", &film]).stdout);
    let mut scan = "Stage 3\nx,y,z,Bx,By,Bz\n".to_owned();
    for (index, row) in field.iter().enumerate() {
        let b: Vec<String> = row[3..6].iter().map(|b| format!("{:?}", 1e4 * b)).collect();
        let [x, y, z] = [0, 1, 2].map(|axis| format!("{:?}", row[axis] / 25.4));
        scan += &match index {
            7 => format!("{x},{y},{z},,,\n"),
            9 => format!("{x},{y},{z},{},NaN,{}\n", b[0], b[2]),
            11 => format!("{x},,{z},{}\n", b.join(",")),
            _ => format!("{x},{y},{z},{}\n", b.join(",")),
        };
    }
    sandbox.write("scan.csv", &format!("{scan}0.1,0.1"));
    let said = sandbox.run(&[
        "scan",
        "scan.csv",
        "--layout",
        &film,
        "--unit",
        "in,G",
        "--fit",
        "strength,offset",
        "--format",
        "json",
    ]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    let found: serde_json::Value = serde_json::from_str(&said.stdout).expect("JSON");
    assert_eq!((&found["readings"], &found["excluded"]["incomplete"]), (&404.into(), &serde_json::json!([10, 12])));
    assert!((found["fitted"]["strength"].as_f64().expect("a number") - 1.0).abs() < 1e-9, "{found}");
    for message in ["line 14: left out: a coordinate of its position is missing", "line 408: left out: the file ends"] {
        assert!(said.stderr.contains(message), "{}", said.stderr);
    }
    let said = sandbox.run(&["diagnose", &film, "--scan", "scan.csv", "--noise", "10uT", "--unit", "in,mm"]);
    said.refuses("the columns Bx, By, Bz of the flux density have no unit");
}

#[test]
fn forces_have_units_of_load_cells() {
    let sandbox = Sandbox::new();
    let layer = "\n[elastomer]\narea_mm2 = 400\nthickness_mm = 7\nyoungs_modulus_mpa = 0.1\npoisson_ratio = 0.45\n";
    sandbox.published_with(layer);
    assert_eq!(sandbox.run(&["experiment", "film.toml", "-o", "moved.csv"]).status, 0);
    let moved = sandbox.read("moved.csv");
    let names: Vec<&str> = moved.lines().next().expect("names").split(',').collect();
    let column = |name: &str| names.iter().position(|known| *known == name).expect("a column");
    let columns = ["fx_n", "fy_n", "fz_n", "bx_t", "by_t", "bz_t"].map(column);
    let calibrate = |names: &str, newton: f64| {
        let mut text = format!("{names}\n");
        for row in rows(&moved) {
            let force: Vec<String> = columns[..3].iter().map(|at| format!("{:?}", row[*at] / newton)).collect();
            let b: Vec<String> = columns[3..].iter().map(|at| format!("{:?}", row[*at] * 1e4)).collect();
            text += &format!("{},{}\n", force.join(","), b.join(","));
        }
        sandbox.write("forces.csv", &text);
        let said = sandbox.run(&["calibrate", "forces.csv", "--layout", "film.toml", "--format", "json"]);
        assert_eq!(said.status, 0, "{}", said.stderr);
        let found: serde_json::Value = serde_json::from_str(&said.stdout).expect("JSON");
        found["by_field"]["z"]["stiffness_n_per_mm"].as_f64().expect("a number")
    };
    let wanted = calibrate("fx_n,fy_n,fz_n,bx_g,by_g,bz_g", 1.0);
    for (unit, newton) in [("gf", 9.80665e-3), ("kgf", 9.80665), ("lbf", 4.4482216152605), ("mN", 1e-3)] {
        let found = calibrate(&format!("Fx ({unit}),Fy ({unit}),Fz ({unit}),Bx (G),By (G),Bz (G)"), newton);
        assert!((found / wanted - 1.0).abs() < 1e-9, "{unit}: {found}, not {wanted}");
    }
}

/// The same sensor at another gain than stated.
#[test]
fn readings_beyond_the_range_name_the_setting_that_holds_them() {
    let sensor = "\n[sensor]\npart = \"MLX90393\"\n";
    let beyond = "bx_mt,by_mt,bz_mt\n0,0,2\n0,6,9.5\n";
    let said = read(beyond, sensor, &[]);
    let message = "b.csv: readings reach (0.000000, 6.000000, 9.500000) mT, beyond the range of [sensor], (4.915200, \
                   4.915200, 7.929856) mT: the sensor had another setting; gain_sel = 6, res = 0 in [sensor] has the \
                   range (6.553600, 6.553600, 10.584064) mT\n";
    assert!(said.stderr.contains(message), "{}", said.stderr);
    let said = read("bx_mt,by_mt,bz_mt\n0,0,2\n0,6,3\n", sensor, &[]);
    assert!(said.stderr.contains("the axes of the sensor are exchanged, or the sensor had another setting; gain_sel"));
    let said = read(beyond, &format!("{sensor}gain_sel = 6\nres = 0\n"), &[]);
    assert!(!said.stderr.contains("range"), "{}", said.stderr);
    let said = read("bx_mt,by_mt,bz_mt\n0,0,2\n0,4.9152,2\n", sensor, &[]);
    let message = "1 reading is at the limit of the range of [sensor], (4.915200, 4.915200, 7.929856) mT; gain_sel = 6, \
                   res = 0 in [sensor] has";
    assert!(said.stderr.contains(message), "{}", said.stderr);
    let said = read(beyond, "\n[sensor]\nrange_mt = 5\n", &[]);
    assert!(said.stderr.contains("another setting; correct range_mt in [sensor]\n"), "{}", said.stderr);
}

/// Fields below a film are smaller than its polarization: larger readings have another unit, or are
/// wild.
#[test]
fn readings_that_no_tile_can_cause_are_of_another_unit() {
    let sensor = "\n[sensor]\npart = \"MLX90393\"\n";
    let remark = |readings: &str| read(readings, sensor, &[]).stderr;
    let other = remark("bx_t,by_t,bz_t\n0,0,2\n0.1,-0.2,2.5\n");
    assert!(other.contains("the polarization of the tiles at most 120.000000 mT: check their unit"), "{other}");
    let wild = remark("bx_mt,by_mt,bz_mt\n0,0,2\n0.1,-0.2,2.5\n0.1,300,2.5\n");
    assert!(wild.contains("1 reading is above 120.000000 mT, the largest polarization of a tile: wild"), "{wild}");
}

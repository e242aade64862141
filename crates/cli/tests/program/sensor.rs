//! `read` and `resolution`: displacements from readings, and what noise lets a sensor see.

use serde_json::Value;

use crate::Sandbox;

const NAMES: &str = "dx_mm,dy_mm,dz_mm,deviation_x_mm,deviation_y_mm,deviation_z_mm,closed_form_dx_mm,\
                     closed_form_dy_mm,closed_form_dz_mm,status";

/// The line of names, and the numbers below it.
fn rows(text: &str) -> (&str, Vec<Vec<f64>>) {
    (text.lines().next().expect("a line of names"), crate::rows(text))
}

/// Random points of the working volume, as CSV. The numbers are those of a linear congruential
/// generator.
fn random_points(count: u64) -> (String, Vec<[f64; 3]>) {
    let mut state = 1_u64;
    let mut next = |low: f64, high: f64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let points: Vec<[f64; 3]> = (0..count).map(|_| [next(-2.0, 2.0), next(-2.0, 2.0), next(-5.0, -3.0)]).collect();
    let lines: Vec<String> = points.iter().map(|[x, y, z]| format!("{x:?},{y:?},{z:?}")).collect();
    (format!("x_mm,y_mm,z_mm\n{}\n", lines.join("\n")), points)
}

/// The field that `field` writes is that of the places that `read` finds. Without noise they agree
/// to 1e-6 mm, where the closed form is off by tenths of a millimetre.
#[test]
fn readings_without_noise_give_the_displacements() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    let (text, points) = random_points(500);
    sandbox.write("points.csv", &text);
    assert_eq!(sandbox.run(&["field", &film, "--points", "points.csv", "-o", "b.csv"]).status, 0);
    let said = sandbox.run(&["read", "b.csv", "--layout", &film, "--noise", "5uT"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let (names, found) = rows(&said.stdout);
    assert_eq!(names, format!("reading,{NAMES}"));
    let mut worst_closed_form = 0.0_f64;
    for (number, (row, [x, y, z])) in found.iter().zip(&points).enumerate() {
        // From the reference point (0, 0, -5) mm.
        for (axis, truth) in [*x, *y, z + 5.0].into_iter().enumerate() {
            assert!((row[1 + axis] - truth).abs() < 1e-6, "{row:?}");
            worst_closed_form = worst_closed_form.max((row[7 + axis] - truth).abs());
            assert!(row[4 + axis] > 5e-4 && row[4 + axis] < 0.02, "{row:?}");
        }
        assert_eq!((row[0], row[10]), (number as f64 + 1.0, 0.0));
    }
    assert_eq!(found.len(), points.len());
    assert!(worst_closed_form > 0.3, "{worst_closed_form}");
    // Numbers of rows are whole.
    assert!(said.stdout.lines().nth(1).is_some_and(|line| line.starts_with("1,")), "{}", said.stdout);
    // Columns with other units are the same readings.
    let mut lines = vec!["Bx (uT);By (uT);Bz (uT)".to_owned()];
    let b = sandbox.read("b.csv");
    let (_, field) = rows(&b);
    lines.extend(field.iter().map(|row| format!("{:?};{:?};{:?}", row[3] * 1e6, row[4] * 1e6, row[5] * 1e6)));
    sandbox.write("microtesla.csv", &lines.join("\n"));
    let again = sandbox.run(&["read", "microtesla.csv", "--layout", &film, "--noise", "5uT"]);
    let (_, again) = rows(&again.stdout);
    for (one, other) in found.iter().zip(&again) {
        assert!((0..3).all(|axis| (one[1 + axis] - other[1 + axis]).abs() < 1e-9), "{one:?} {other:?}");
    }
}

/// A stray field and the offset of the sensor are in every reading. Readings at rest tell them.
#[test]
fn readings_at_rest_take_out_a_constant_field() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    sandbox.write("points.csv", "x_mm,y_mm,z_mm\n0,0,-5\n0,0,-5\n1,-0.5,-4\n");
    assert_eq!(sandbox.run(&["field", &film, "--points", "points.csv", "-o", "b.csv"]).status, 0);
    let b = sandbox.read("b.csv");
    let (_, field) = rows(&b);
    let lines: Vec<String> =
        field.iter().map(|row| format!("{:?},{:?},{:?}", row[3] + 5e-5, row[4] - 3e-5, row[5] + 2e-5)).collect();
    sandbox.write("b.csv", &format!("bx_t,by_t,bz_t\n{}\n", lines.join("\n")));
    let displacement = |options: &[&str]| {
        let said = sandbox.run(&[&["read", "b.csv", "--layout", &film], options].concat());
        let (_, found) = rows(&said.stdout);
        [found[2][1] - 1.0, found[2][2] + 0.5, found[2][3] - 1.0].map(f64::abs).into_iter().fold(0.0, f64::max)
    };
    assert!(displacement(&[]) > 1e-3);
    assert!(displacement(&["--zero", "2"]) < 1e-9);
    sandbox
        .run(&["read", "b.csv", "--layout", &film, "--zero", "4"])
        .refuses("b.csv: has 3 readings, fewer than the 4");
}

#[test]
fn readings_without_a_place_in_the_volume_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    sandbox.write("b.csv", "bx_mt,by_mt,bz_mt\n0,0,2\n100,0,0\n0,0,9\n");
    let said = sandbox.run(&["read", "b.csv", "--layout", &film]);
    assert_eq!(said.status, 0);
    let (_, found) = rows(&said.stdout);
    let last = found[0].len() - 1;
    let status: Vec<f64> = found.iter().map(|row| row[last]).collect();
    assert_eq!(status, [0.0, 3.0, 1.0]);
    assert!(found[1][1].is_nan() && found[2][3] > 2.0, "{found:?}");
    let named = "b.csv: line 3: no position in or near the volume has this reading\n";
    assert!(said.stderr.contains(named), "{}", said.stderr);
    let named = "line 4: the position with this reading is outside the volume, at (0, 0, -2.";
    assert!(said.stderr.contains(named), "{}", said.stderr);
    assert_eq!(sandbox.run(&["read", "b.csv", "--layout", &film, "--quiet"]).stderr, "");
    // The status is an integer in every format.
    assert!(said.stdout.lines().nth(2).is_some_and(|line| line.ends_with(",3")), "{}", said.stdout);
    let json = sandbox.run(&["read", "b.csv", "--layout", &film, "--format", "json"]).stdout;
    let json: Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["columns"]["status"].to_string(), "[0,3,1]");
    assert_eq!(json["columns"]["reading"].to_string(), "[1,2,3]");
    assert_eq!(sandbox.run(&["read", "b.csv", "--layout", &film, "-o", "b.npz"]).status, 0);
}

#[test]
fn faulty_files_of_readings_are_refused() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    let with = |text: &str, options: &[&str]| {
        sandbox.write("b.csv", text);
        sandbox.run(&[&["read", "b.csv", "--layout", &film], options].concat())
    };
    with("bx_mt,by_mt,bz_mt\n", &[]).refuses("b.csv: has no readings below its names of columns");
    with("bx_mt,by_mt\n1,2\n", &[]).refuses("b.csv: line 1: no column bz_mt of the flux density (found: bx_mt,by_mt)");
    with("bx_mt,by,bz_mt\n1,2,3\n", &[])
        .refuses("b.csv: line 1: the column by of the flux density has no unit: rename, as in bx_mt, or give --unit");
    with("bx_mt,by_mt,bz_v\n1,2,3\n", &[])
        .refuses("the column bz_v of the flux density has the unit v, must be one of: T, mT, uT, ");
    with("bx_mt,by_mt,bz_mt\n1,2,3\n", &["--unit", "t"])
        .refuses("--unit T contradicts the columns bx_mt, by_mt, bz_mt of the flux density");
    with("bx_mt,by_mt,bz_mt\n1,x,3\n1,2\n", &[]).refuses("line 2: by_mt = \"x\", must be a finite number");
    with("bx,by,bz\n0,0,2\n", &["--noise", "0uT"])
        .refuses_arguments("0 T, must be above 0 and at most 1 T, such as 5uT");
    with("bx,by,bz\n0,0,2\n", &["-o", "b.vtp"]).refuses("readings have no place in VTK");
    assert_eq!(with("bx,by,bz\n0,0,2\n", &["--unit", "mT"]).status, 0);
    let tile = "[[tile]]\nposition_mm = [0, 0, 1]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
    sandbox.write("film.toml", &format!("format = 1\nname = \"a tile\"\n{tile}"));
    let said = sandbox.run(&["read", "b.csv", "--layout", "film.toml", "--unit", "mT"]);
    said.refuses("film.toml: the layout has no [volume] table with the region of the sensor");
}

/// The deviations of `read` at the points of the volume are those of `resolution`. Twice the noise
/// doubles them.
#[test]
fn resolution_is_the_deviation_of_readings() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    let said = sandbox.run(&["resolution", &film, "--noise", "5uT", "-o", "resolution.csv"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    assert!(said.stdout.contains("noise of a reading: 5 uT (standard deviation)"), "{}", said.stdout);
    let table = sandbox.read("resolution.csv");
    let (names, resolution) = rows(&table);
    assert!(names.ends_with("closed_form_deviation_y_mm,closed_form_deviation_z_mm"), "{names}");
    assert_eq!(sandbox.run(&["field", &film, "-o", "b.csv"]).status, 0);
    let read = sandbox.run(&["read", "b.csv", "--layout", &film, "--noise", "10uT,10uT,10uT"]).stdout;
    let (_, read) = rows(&read);
    for (one, other) in resolution.iter().zip(&read) {
        for axis in 0..3 {
            let ratio = other[4 + axis] / one[3 + axis];
            assert!((ratio - 2.0).abs() < 1e-9, "{one:?} {other:?}");
        }
    }
    // The root mean square stands in the text.
    let rms = (resolution.iter().map(|row| row[3] * row[3]).sum::<f64>() / resolution.len() as f64).sqrt();
    let row = said.stdout.lines().find(|line| line.contains("RMS over the volume")).expect("a row");
    assert!(row.contains(&format!("{rms:.6}")), "{row}, not {rms}");
    let json = sandbox.run(&["read", "b.csv", "--layout", &film, "--format", "json"]).stdout;
    let json: Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!((&json["readings"], json["columns"]["dx_mm"].as_array().map(Vec::len)), (&405.into(), Some(405)));
}

/// Readings with a reversed axis or in another unit have no position, and no displacement by the
/// closed form.
#[test]
fn readings_with_other_axes_or_units_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    let said = sandbox.run(&["field", &film]);
    let (_, field) = rows(&said.stdout);
    let read = |change: fn(&[f64]) -> [f64; 3]| {
        let lines = field.iter().step_by(7).map(|row| change(&row[3..]).map(|b| format!("{b:?}")).join(","));
        sandbox.write("b.csv", &format!("bx_t,by_t,bz_t\n{}\n", lines.collect::<Vec<_>>().join("\n")));
        sandbox.run(&["read", &film, "b.csv"])
    };
    let reversed = read(|b| [b[0], b[1], -b[2]]);
    let named = "readings have positions in the volume if the axes of the sensor are others: z is reversed";
    assert!(reversed.stderr.contains(named), "{}", reversed.stderr);
    // The film is symmetric: reflected and exchanged x and y look alike.
    let circle = read(|b| [b[1], b[2], b[0]]);
    let named =
        "so they have with 7 other exchanges, by the symmetry of the film: compare a displacement that you know";
    assert!(circle.stderr.contains(named), "{}", circle.stderr);
    let clipped = read(|b| [b[0], b[1], b[2].min(3e-3)]);
    let named = "different readings share the largest bz, 3.000000 mT: if it is the limit of the sensor, state it";
    assert!(clipped.stderr.contains(named), "{}", clipped.stderr);
    let other_unit = read(|b| [1e3 * b[0], 1e3 * b[1], 1e3 * b[2]]);
    assert!(other_unit.stderr.contains("readings times 0.001 have positions in the volume"), "{}", other_unit.stderr);
    let (names, found) = rows(&other_unit.stdout);
    let column = names.split(',').position(|name| name == "closed_form_dz_mm").expect("a column");
    assert!(found.iter().all(|row| row[column].is_nan()), "{}", other_unit.stdout);
    assert_eq!(read(|b| [b[0], b[1], b[2]]).stderr, "");
    // The field at the reference point was set to zero.
    let tared = read(|b| [b[0], b[1], b[2] - 1.659e-3]);
    let named =
        "the readings have positions with the field on the axis of the film added: the zero of the sensor was set";
    assert!(tared.stderr.contains(named), "{}", tared.stderr);
    // The first reading is at a corner of the volume, not at the reference point.
    let elsewhere = sandbox.run(&["read", &film, "b.csv", "--zero", "1"]);
    let named = "several times the field of the earth: take them at the reference point of [volume]";
    assert!(elsewhere.stderr.contains(named), "{}", elsewhere.stderr);
}

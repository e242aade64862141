//! `read` with the readings of every sensor of a head.

use std::fmt::Write;

use crate::{Sandbox, rows, shipped};

/// The places of the sensors of the shipped cross.
const PLACES: [[f64; 2]; 5] = [[0.0, 0.0], [-5.0, -5.0], [5.0, -5.0], [-5.0, 5.0], [5.0, 5.0]];

const POSITIONS: [[f64; 3]; 3] = [[0.0, 0.0, -5.0], [0.7, -0.4, -4.1], [-1.9, 1.3, -3.2]];

const STRAY_T: [f64; 3] = [3e-5, -2e-5, 4e-5];

/// Readings of all sensors at the positions, one row for each.
fn readings(sandbox: &Sandbox) -> Vec<Vec<f64>> {
    let mut points = "x_mm,y_mm,z_mm\n".to_owned();
    for [x, y, z] in POSITIONS {
        PLACES.iter().for_each(|[dx, dy]| writeln!(points, "{},{},{z}", x + dx, y + dy).expect("a string"));
    }
    sandbox.write("points.csv", &points);
    let said = sandbox.run(&["field", &shipped("published-film"), "--points", "points.csv"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    let read: Vec<Vec<f64>> = rows(&said.stdout).iter().map(|row| row[3..6].to_vec()).collect();
    let in_stray = |b: &Vec<f64>| (0..3).map(|axis| b[axis] + STRAY_T[axis]).collect::<Vec<f64>>();
    read.chunks(PLACES.len()).map(|of_head| of_head.iter().flat_map(in_stray).collect()).collect()
}

fn write(sandbox: &Sandbox, first: usize, rows: &[Vec<f64>]) {
    let names: Vec<String> =
        (first..first + 5).map(|number| format!("bx{number}_t,by{number}_t,bz{number}_t")).collect();
    let lines = rows.iter().map(|row| row.iter().map(|b| format!("{b:?}")).collect::<Vec<_>>().join(","));
    sandbox.write("readings.csv", &[names.join(",")].into_iter().chain(lines).collect::<Vec<_>>().join("\n"));
}

/// A column of a result.
fn column(csv: &str, name: &str) -> Vec<f64> {
    let index = csv.lines().next().and_then(|names| names.split(',').position(|of| of == name));
    rows(csv).iter().map(|row| row[index.unwrap_or_else(|| panic!("no {name} in {csv}"))]).collect()
}

/// The errors are those of the exact field over its gradient. Names count from 0 or from 1.
#[test]
fn displacements_and_stray_fields_are_read_from_all_sensors() {
    let sandbox = Sandbox::new();
    let film = shipped("heads/published-cross");
    let readings = readings(&sandbox);
    for (first, fit) in [(1, &[][..]), (0, &["--fit", "pose"])] {
        write(&sandbox, first, &readings);
        let said = sandbox.run(&[&["read", &film, "readings.csv"], fit].concat());
        assert_eq!((said.status, said.stderr.as_str()), (0, ""));
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let moved = column(&said.stdout, &format!("d{name}_mm"));
            let stray_t = column(&said.stdout, &format!("stray_{name}_t"));
            for (index, position) in POSITIONS.iter().enumerate() {
                assert!((moved[index] - (position[axis] - POSITIONS[0][axis])).abs() < 1e-7, "{}", said.stdout);
                assert!((stray_t[index] - STRAY_T[axis]).abs() < 1e-10, "{}", said.stdout);
            }
        }
        assert_eq!(column(&said.stdout, "status"), [0.0; 3]);
        assert!(column(&said.stdout, "deviation_x_mm").iter().all(|of| (1e-4..1e-2).contains(of)));
        assert_eq!(said.stdout.contains("rotation_x_deg"), !fit.is_empty());
    }
}

/// A sensor with an offset of 300 uT contradicts the others, until readings at rest show it.
#[test]
fn contradicting_sensors_are_named() {
    let sandbox = Sandbox::new();
    let film = shipped("heads/published-cross");
    let mut readings = readings(&sandbox);
    readings.iter_mut().for_each(|row| row[9] += 3e-4);
    write(&sandbox, 1, &readings);
    let said = sandbox.run(&["read", &film, "readings.csv"]);
    assert_eq!((said.status, column(&said.stdout, "status")), (0, vec![6.0; 3]));
    let named = "the residual of 3 of 3 readings is larger than the noise allows (in 1 of 1000 by chance)";
    assert!(said.stderr.contains(named), "{}", said.stderr);
    assert!(said.stderr.contains("without sensor 4 the others agree: that sensor is suspect"), "{}", said.stderr);
    let said = sandbox.run(&["read", &film, "readings.csv", "--zero", "1"]);
    assert_eq!((said.stderr.as_str(), column(&said.stdout, "status")), ("", vec![0.0; 3]));
    assert!(column(&said.stdout, "stray_x_t").iter().all(|stray_t| stray_t.abs() < 1e-10), "{}", said.stdout);
}

/// Another unit or a reversed axis of all sensors, and a stray field that is not that of the earth.
#[test]
fn units_axes_and_strong_stray_fields_of_heads_are_named() {
    let sandbox = Sandbox::new();
    let film = shipped("heads/published-cross");
    let exact = readings(&sandbox);
    let remarks = |change: &dyn Fn(usize, f64) -> f64| {
        let changed: Vec<Vec<f64>> =
            exact.iter().map(|row| row.iter().enumerate().map(|(n, b)| change(n, *b)).collect()).collect();
        write(&sandbox, 1, &changed);
        sandbox.run(&["read", &film, "readings.csv"]).stderr
    };
    let unit = remarks(&|_, b| 1e3 * b);
    assert!(unit.contains("readings times 0.001 have positions in the volume"), "{unit}");
    let reversed = remarks(&|n, b| if n % 3 == 2 { -b } else { b });
    assert!(reversed.contains("z is reversed: set gain = [1, 1, -1] in [sensor]"), "{reversed}");
    let stray = remarks(&|n, b| if n % 3 == 0 { b + 1e-3 } else { b });
    assert!(stray.contains("the fitted stray field is 1031 uT in the median"), "{stray}");
}

#[test]
fn readings_that_do_not_suit_the_head_are_refused() {
    let sandbox = Sandbox::new();
    let (cross, pair) = (shipped("heads/published-cross"), shipped("heads/published-pair-z"));
    let readings = readings(&sandbox);
    write(&sandbox, 1, &readings);
    let text = sandbox.read("readings.csv");
    sandbox.write("readings.csv", &text.replace("bz5_t", "note"));
    sandbox.run(&["read", &cross, "readings.csv"]).refuses("no column bz5_mt of the flux density");
    sandbox.write("readings.csv", &text);
    sandbox.run(&["read", &pair, "readings.csv"]).refuses("has columns of sensor 3, and the head of ");
    let first_two: String =
        text.lines().map(|line| line.split(',').take(6).collect::<Vec<_>>().join(",") + "\n").collect();
    sandbox.write("readings.csv", &first_two);
    sandbox
        .run(&["read", &pair, "readings.csv", "--fit", "pose"])
        .refuses("2 sensors give 6 numbers, fewer than the 9 that are fitted");
    sandbox.write("sums.csv", "bx_t,by_t,bz_t\n1e-3,1e-3,1e-3\n");
    let each = "--fit needs a reading of each sensor of the head: bx1, by1, bz1, bx2, ...";
    sandbox.run(&["read", &cross, "sums.csv", "--fit", "position"]).refuses(each);
    sandbox.write("readings.csv", &text.replacen("0.", ",0.", 1).replace("bx1_t", "x_mm,y_mm,z_mm,bx1_t"));
    let scan = sandbox.run(&["scan", &cross, "readings.csv"]);
    assert!(scan.status != 0 && scan.stderr.contains("needs the readings of one sensor"), "{}", scan.stderr);
}

/// One sensor without noise leaves no deviations and no test of the residual, but positions.
#[test]
fn sensors_without_noise_have_no_deviations() {
    let sandbox = Sandbox::new();
    let readings = readings(&sandbox);
    write(&sandbox, 1, &readings);
    let text = std::fs::read_to_string(shipped("heads/published-cross")).expect("a layout");
    let element = |noise_ut: f64, [x, y]: [f64; 2]| {
        format!("[[sensor.element]]\nposition_mm = [{x:?}, {y:?}, 0.0]\nnoise_ut = {noise_ut:?}\n")
    };
    let elements: String = PLACES.iter().enumerate().map(|(n, place)| element(n as f64, *place)).collect();
    let (before, after) = text.split_once("[sensor]").expect("a table");
    let (_, after) = after.split_once("[expect]").expect("a table");
    sandbox.write("film.toml", &format!("{before}[sensor]\n{elements}[expect]{after}"));
    let said = sandbox.run(&["read", "film.toml", "readings.csv"]);
    assert_eq!((said.status, column(&said.stdout, "status")), (0, vec![0.0; 3]), "{}", said.stderr);
    assert!(!said.stdout.contains("deviation") && !said.stdout.contains("chi_squared"), "{}", said.stdout);
    assert!((column(&said.stdout, "dx_mm")[2] - POSITIONS[2][0]).abs() < 1e-7, "{}", said.stdout);
    let said = sandbox.run(&["resolution", "film.toml"]);
    assert!(said.status == 0 && !said.stdout.contains("by all sensors"), "{}", said.stdout);
}

/// Six numbers determine position and stray field of a pair exactly, by the difference of the
/// readings alone, as the weighted sum does. More sensors tell more, and a known stray field too.
#[test]
fn all_sensors_resolve_as_much_as_the_sum_or_more() {
    let sandbox = Sandbox::new();
    for name in ["heads/published-pair-z", "heads/published-cross"] {
        let said = sandbox.run(&["resolution", &shipped(name), "-o", "points.csv"]);
        assert_eq!((said.status, said.stderr.as_str()), (0, ""));
        assert!(said.stdout.contains("by all sensors, with the stray field fitted"), "{}", said.stdout);
        let table = sandbox.read("points.csv");
        for axis in ["x", "y", "z"] {
            let [sum, known, fitted] =
                ["deviation", "known_stray", "fitted_stray"].map(|of| column(&table, &format!("{of}_{axis}_mm")));
            for ((sum, known), fitted) in sum.iter().zip(known).zip(fitted) {
                assert!(known < fitted && fitted < sum * (1.0 + 1e-9), "{name}: {known}, {fitted}, {sum}");
                assert!(name.ends_with("cross") || fitted > sum * (1.0 - 1e-9), "{name}: {fitted}, {sum}");
            }
        }
        // The least visible direction is seen less than any axis.
        let singular = column(&table, "least_singular_value_per_mm");
        let deviation = column(&table, "fitted_stray_z_mm");
        assert!(singular.iter().zip(deviation).all(|(of, mm)| *of > 0.0 && of * mm < 1.0 + 1e-9), "{name}");
    }
}

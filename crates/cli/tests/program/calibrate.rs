//! `calibrate`: the stiffness of the elastic layer.

use std::fmt::Write;

use serde_json::Value;

use crate::{Sandbox, rows};

const STIFFNESS_N_PER_MM: [f64; 3] = [0.8, 0.9, 2.5];
const AT_REST_N: [f64; 3] = [0.1, -0.2, 0.3];

/// Normal deviates by the sum of twelve uniform ones, from a linear congruential generator.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform() - 0.5).sum()
    }
}

/// Displacements of the film in shear and towards the sensor, and the field that the sensor then
/// reads.
fn displaced(sandbox: &Sandbox) -> Vec<([f64; 3], [f64; 3])> {
    let mut moved = Vec::new();
    for step in 0..30 {
        let s = f64::from(step) / 29.0;
        moved.push([-1.8 + 3.6 * s, 1.2 * (7.0 * s).sin(), -1.9 * s]);
    }
    // The sensor moves by the opposite, from the reference point (0, 0, -5) mm.
    let lines: Vec<String> = moved.iter().map(|[x, y, z]| format!("{:?},{:?},{:?}", -x, -y, -5.0 - z)).collect();
    sandbox.write("points.csv", &format!("x_mm,y_mm,z_mm\n{}\n", lines.join("\n")));
    let said = sandbox.run(&["field", &sandbox.published_with(""), "--points", "points.csv"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    moved.into_iter().zip(rows(&said.stdout)).map(|(moved, row)| (moved, [row[3], row[4], row[5]])).collect()
}

fn calibrated(sandbox: &Sandbox, readings: &[([f64; 3], [f64; 3])], noise: [f64; 2], seed: u64) -> Value {
    let mut random = Random(seed);
    let mut text = "Fx (mN);Fy (mN);Fz (mN);Bx (uT);By (uT);Bz (uT)\n".to_owned();
    for (moved, field) in readings {
        let [force_noise, field_noise] = noise;
        let mut cells = Vec::new();
        for axis in 0..3 {
            let force = STIFFNESS_N_PER_MM[axis] * moved[axis] + AT_REST_N[axis] + force_noise * random.normal();
            cells.push(format!("{:?}", 1e3 * force));
        }
        for b in field {
            cells.push(format!("{:?}", 1e6 * (b + field_noise * random.normal())));
        }
        let _ = writeln!(text, "{}", cells.join(";"));
    }
    sandbox.write("forces.csv", &text);
    let film = sandbox.published_with("");
    let said = sandbox.run(&["calibrate", "forces.csv", "--layout", &film, "--format", "json"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    serde_json::from_str(&said.stdout).expect("JSON")
}

fn number(of: &Value) -> f64 {
    of.as_f64().unwrap_or_else(|| panic!("{of} is no number"))
}

/// Without noise the coefficients by the field of the layout are exact. Those of the closed form
/// are off by the error of the film.
#[test]
fn stiffness_without_noise_is_exact() {
    let sandbox = Sandbox::new();
    let result = calibrated(&sandbox, &displaced(&sandbox), [0.0, 0.0], 1);
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let found = &result["by_field"][name];
        assert!((number(&found["stiffness_n_per_mm"]) - STIFFNESS_N_PER_MM[axis]).abs() < 1e-8, "{found}");
        assert!((number(&found["force_at_rest_n"]) - AT_REST_N[axis]).abs() < 1e-8, "{found}");
        let closed = &result["by_closed_form"][name];
        assert!((number(&closed["stiffness_n_per_mm"]) / STIFFNESS_N_PER_MM[axis] - 1.0).abs() > 0.02, "{closed}");
    }
    let film = sandbox.published_with("");
    let said = sandbox.run(&["calibrate", "forces.csv", "--layout", &film]);
    let text = &said.stdout;
    // The force at rest, -0.2 N, over the stiffness along y.
    let at_rest = "without a force the film is 0.222222 mm along y from where the sensor is at its reference point";
    assert!(said.stderr.contains(at_rest), "{}", said.stderr);
    assert!(text.contains("forces.csv: 30 readings; force = stiffness x displacement"), "{text}");
    let row = text.lines().find(|line| line.contains("stiffness, N/mm")).expect("a row");
    assert!(row.ends_with("0.800000     0.900000     2.500000"), "{row}");
}

/// Intervals of 95 % contain the coefficient in 90 to 99 of 100 trials: of 600 in 540 to 594.
#[test]
fn intervals_contain_the_coefficients_as_often_as_they_say() {
    let sandbox = Sandbox::new();
    let readings = displaced(&sandbox);
    let mut contained = 0;
    for seed in 0..100 {
        let result = calibrated(&sandbox, &readings, [0.02, 1e-6], 1000 + seed);
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let found = &result["by_field"][name];
            for (name, truth) in
                [("stiffness_n_per_mm", STIFFNESS_N_PER_MM[axis]), ("force_at_rest_n", AT_REST_N[axis])]
            {
                let [value, half] = [number(&found[name]), number(&found[format!("{name}_95")])];
                assert!(half > 0.0 && half < 0.1, "{found}");
                contained += u32::from((value - truth).abs() <= half);
            }
        }
    }
    assert!((540..=594).contains(&contained), "{contained} of 600");
}

#[test]
fn calibrations_that_tell_nothing_are_refused() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    let with = |text: &str| {
        sandbox.write("forces.csv", text);
        sandbox.run(&["calibrate", "forces.csv", "--layout", &film])
    };
    let names = "fx_n,fy_n,fz_n,bx_mt,by_mt,bz_mt";
    with(&format!("{names}\n0,0,0,0,0,2\n0,0,1,0,0,3\n")).refuses("forces.csv: along x: too few readings for a line");
    with(&format!("{names}\n{}", "0,0,1,0,0,2\n".repeat(5)))
        .refuses("forces.csv: along x: all displacements are the same");
    with(&format!("{names}\n0,0,1,100,0,0\n")).refuses("forces.csv: line 2: no position in or near the volume");
    with("fx,fy_n,fz_n,bx_mt,by_mt,bz_mt\n0,0,1,0,0,2\n")
        .refuses("the column fx of the force has no unit: rename, as in fx_n, or give --unit");
}

/// A slipped force, a missing one and a wild reading do not change the stiffness. They are named.
#[test]
fn wild_forces_are_excluded_and_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    let mut readings = displaced(&sandbox);
    let clean = calibrated(&sandbox, &readings, [0.005, 1e-6], 5);
    readings[4].1[0] += 5e-4;
    calibrated(&sandbox, &readings, [0.005, 1e-6], 5);
    let mut lines: Vec<String> = sandbox.read("forces.csv").lines().map(str::to_owned).collect();
    let with = |line: &str, cell: &str| format!("{cell};{}", line.split_once(';').expect("cells").1);
    lines[10] = with(&lines[10], "9000");
    lines[20] = with(&lines[20], "");
    sandbox.write("forces.csv", &(lines.join("\n") + "\n"));
    let said = sandbox.run(&["calibrate", "forces.csv", "--layout", &film, "--format", "json"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    let found: Value = serde_json::from_str(&said.stdout).expect("JSON");
    for name in ["x", "y", "z"] {
        let [found, clean] = [&found, &clean].map(|of| &of["by_field"][name]);
        let difference = number(&found["stiffness_n_per_mm"]) - number(&clean["stiffness_n_per_mm"]);
        assert!(difference.abs() < number(&clean["stiffness_n_per_mm_95"]), "{name}: {found}");
    }
    assert!(
        said.stderr.contains("line 11: excluded as an outlier: its force contradicts the others"),
        "{}",
        said.stderr
    );
    assert_eq!(found["excluded"]["incomplete"], serde_json::json!([21]));
    assert!(said.stderr.contains("line 21: excluded as incomplete: a force is missing"), "{}", said.stderr);
}

/// The published film is the same with x and y exchanged, so that exchanged columns give positions.
#[test]
fn exchanged_columns_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    calibrated(&sandbox, &displaced(&sandbox), [0.0, 0.0], 1);
    sandbox.write("forces.csv", &sandbox.read("forces.csv").replacen("Bx (uT);By (uT)", "By (uT);Bx (uT)", 1));
    let said = sandbox.run(&["calibrate", "forces.csv", "--layout", &film]);
    for axis in ["x", "y"] {
        let named = format!("the force along {axis} follows displacements along other axes, not along {axis}");
        assert!(said.stderr.contains(&named), "{}", said.stderr);
    }
    assert!(!said.stderr.contains("the force along z"), "{}{}", said.stderr, said.stdout);
}

/// Forces in millinewton under a name in newton.
#[test]
fn forces_in_another_unit_are_named() {
    let sandbox = Sandbox::new();
    calibrated(&sandbox, &displaced(&sandbox), [0.0, 0.0], 1);
    let layer = "[elastomer]\narea_mm2 = 400\nthickness_mm = 7\nyoungs_modulus_mpa = 0.1\npoisson_ratio = 0.45";
    let film = sandbox.published_with(layer);
    let calibrate = || sandbox.run(&["calibrate", &film, "forces.csv"]).stderr;
    assert!(!calibrate().contains("Hooke"));
    sandbox.write("forces.csv", &sandbox.read("forces.csv").replace("(mN)", "(N)"));
    let said = calibrate();
    assert!(
        said.contains("times that of Hooke's law with the layer of the layout: the forces have another unit"),
        "{said}"
    );
}

/// Forces that point against the motion, and a film that moves along z alone.
#[test]
fn negative_and_missing_stiffnesses_are_named() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("");
    let readings = displaced(&sandbox);
    calibrated(&sandbox, &readings, [0.0, 0.0], 1);
    let text = sandbox.read("forces.csv");
    let reversed = text.lines().enumerate().map(|(n, line)| {
        let (x, rest) = line.split_once(';').expect("cells");
        if n == 0 { line.to_owned() } else { format!("{:?};{rest}", -x.parse::<f64>().expect("a number")) }
    });
    sandbox.write("forces.csv", &reversed.collect::<Vec<_>>().join("\n"));
    let said = sandbox.run(&["calibrate", "forces.csv", "--layout", &film]);
    let named = "the stiffness along x is negative: the force is positive where the film moves along -x";
    assert!(said.status == 0 && said.stderr.contains(named), "{}", said.stderr);
    sandbox.write("points.csv", "x_mm,y_mm,z_mm\n0,0,-5\n0,0,-4.5\n0,0,-4\n0,0,-3.5\n0,0,-3\n");
    let field = rows(&sandbox.run(&["field", &film, "--points", "points.csv"]).stdout);
    let along_z = field
        .iter()
        .enumerate()
        .map(|(n, row)| format!("0,0,{:?},{:?},{:?},{:?}", -0.5 * n as f64, row[3], row[4], row[5]));
    let names = "fx_n,fy_n,fz_n,bx_t,by_t,bz_t\n".to_owned();
    sandbox.write("forces.csv", &(names + &along_z.collect::<Vec<_>>().join("\n")));
    let said = sandbox.run(&["calibrate", "forces.csv", "--layout", &film, "--format", "json"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    let found: Value = serde_json::from_str(&said.stdout).expect("JSON");
    assert!((number(&found["by_field"]["z"]["stiffness_n_per_mm"]) - 1.0).abs() < 1e-6, "{found}");
    assert_eq!(found["by_field"]["x"], Value::Null);
    assert!(said.stderr.contains("no stiffness along x: "), "{}", said.stderr);
    // A press measures the normal force alone.
    let normal_alone: String = sandbox.read("forces.csv").replace("fx_n,fy_n,", "").replace("\n0,0,", "\n");
    sandbox.write("forces.csv", &normal_alone);
    let said = sandbox.run(&["calibrate", "forces.csv", "--layout", &film, "--format", "json"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    let alone: Value = serde_json::from_str(&said.stdout).expect("JSON");
    assert_eq!(alone["by_field"]["z"], found["by_field"]["z"]);
    assert_eq!(alone["excluded"]["incomplete"], serde_json::json!([]));
}

/// Forces that are late, a sensor that is stuck, and an axis along which nothing moves, in a log of
/// a smooth path with noise.
#[test]
fn logs_that_are_not_in_step_are_named() {
    let sandbox = Sandbox::new();
    let readings = displaced(&sandbox);
    let film = sandbox.published_with("");
    type Change<'c> = &'c dyn Fn(usize, &mut [f64; 3], &mut [f64; 3]);
    let remarks = |change: Change| {
        let mut random = Random(3);
        let mut text = "fx_n,fy_n,fz_n,bx_t,by_t,bz_t\n".to_owned();
        for (row, (moved, field)) in readings.iter().enumerate() {
            let mut force = [0, 1, 2].map(|axis| STIFFNESS_N_PER_MM[axis] * moved[axis] + 0.01 * random.normal());
            let mut field = field.map(|b| b + 1e-6 * random.normal());
            change(row, &mut force, &mut field);
            let _ = writeln!(
                text,
                "{:?},{:?},{:?},{:?},{:?},{:?}",
                force[0], force[1], force[2], field[0], field[1], field[2]
            );
        }
        sandbox.write("log.csv", &text);
        sandbox.run(&["calibrate", &film, "log.csv"]).stderr
    };
    let as_they_are = remarks(&|_, _, _| ());
    assert!(as_they_are.lines().all(|line| line.contains("is outside the volume")), "{as_they_are}");
    let late = remarks(&|row, force, _| {
        let moved = readings[row.saturating_sub(3)].0;
        *force = [0, 1, 2].map(|axis| STIFFNESS_N_PER_MM[axis] * moved[axis]);
    });
    assert!(late.contains("the forces fit the readings 3 rows before far better"), "{late}");
    let early = remarks(&|row, force, _| {
        let moved = readings[(row + 1).min(29)].0;
        *force = [0, 1, 2].map(|axis| STIFFNESS_N_PER_MM[axis] * moved[axis]);
    });
    assert!(early.contains("the forces fit the readings 1 row after far better"), "{early}");
    let stuck = remarks(&|row, _, field| {
        if row >= 14 {
            field[1] = 5e-5;
        }
    });
    assert!(stuck.contains("by is 0.05 mT in 16 successive readings, from reading 15 on"), "{stuck}");
    let mut random = Random(5);
    let unrelated: Vec<f64> = readings.iter().map(|_| random.normal()).collect();
    let unrelated = remarks(&|row, force, _| force[1] = unrelated[row]);
    assert!(unrelated.contains("the stiffness along y is 0 within its error"), "{unrelated}");
    let normal_only = remarks(&|_, force, _| (force[0], force[1]) = (f64::NAN, f64::NAN));
    assert!(!normal_only.contains("no stiffness along x"), "{normal_only}");
}

/// Readings at rest of a film that moved.
#[test]
fn readings_at_rest_of_a_moving_film_are_named() {
    let sandbox = Sandbox::new();
    calibrated(&sandbox, &displaced(&sandbox), [0.0, 0.0], 1);
    let film = sandbox.published_with("");
    let moving = sandbox.run(&["calibrate", &film, "forces.csv", "--rest", "5"]).stderr;
    assert!(moving.contains("the readings at rest are of positions up to "), "{moving}");
    let still = sandbox.run(&["calibrate", &film, "forces.csv", "--rest", "1"]).stderr;
    assert!(!still.contains("the readings at rest"), "{still}");
}

/// The intervals are of a film without the errors that its layout states.
#[test]
fn errors_of_tiles_are_not_in_the_intervals() {
    let sandbox = Sandbox::new();
    calibrated(&sandbox, &displaced(&sandbox), [0.0, 0.0], 1);
    let film = sandbox.published_with("[tolerance]\npreset = \"by-hand\"");
    let said = sandbox.run(&["calibrate", &film, "forces.csv"]).stderr;
    assert!(said.contains("the intervals do not contain the errors of the tiles that [tolerance] states"), "{said}");
}

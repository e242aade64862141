//! `decouple` and `compare`: numbers of the published film, singular points.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::{Sandbox, shipped};

#[test]
fn decouple_prints_the_published_numbers() {
    let said = Sandbox::new().run(&["decouple", &shipped("published-film")]);
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
    let said = Sandbox::new().run(&["decouple", &shipped("published-film"), "--format", "json"]);
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
    let sandbox = Sandbox::new();
    // J along x: B_z = 0 on the plane x = 0. Six points of the grid lie on it, the reference does
    // not.
    sandbox.write(
        "shear.toml",
        "format = 1\nname = \"shear\"\n[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 1\n\
         [volume]\nx_mm = [-1, 1]\ny_mm = [-1, 1]\nz_mm = [-5, -4]\nstep_mm = 1\nreference_mm = [1, 0, -5]\n\
         [[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [1, 0, 0]\n",
    );
    let said = sandbox.run(&["decouple", "shear.toml"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    let named = "singular points (B_z = 0), excluded: 6, at (0, -1, -5) (0, -1, -4) (0, 0, -5)";
    assert!(said.stdout.contains(named), "{}", said.stdout);
    let json: Value =
        serde_json::from_str(&sandbox.run(&["decouple", "shear.toml", "--format", "json"]).stdout).unwrap();
    assert_eq!(json["singular_points_mm"].as_array().unwrap().len(), 6);
    assert!(json["uniformity_rmse"]["r_x"].as_f64().unwrap().is_finite());
}

#[test]
fn compare_as_text_and_json() {
    let said = Sandbox::new().run(&["compare", &shipped("published-film")]);
    assert!(said.status == 0 && said.stdout.contains("best-fit amplitude") && said.stdout.contains("0.818730"));
    let said = Sandbox::new().run(&["compare", &shipped("published-film"), "--format", "json"]);
    let json: Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!(json["points"], 405);
    assert!((json["relative_rmse"].as_f64().unwrap() - 0.197428).abs() < 0.5e-6);
    assert_eq!(json["worst_at_mm"], serde_json::json!([0.0, 0.0, -3.0]));
}

/// Eqs. 1 and 2 of the published film, with the numbers of the figures.
#[test]
fn ideal_film_is_drawn_as_the_equations_say() {
    let sandbox = Sandbox::new();
    assert_eq!(sandbox.run(&["compare", &shipped("published-film"), "--figures", "ideal", "-q"]).status, 0);
    let rows = |name: &str| -> Vec<[f64; 6]> {
        assert!(
            sandbox.path(&format!("ideal/{name}.svg")).is_file()
                && sandbox.path(&format!("ideal/{name}.png")).is_file()
        );
        let text = sandbox.read(&format!("ideal/{name}.csv"));
        let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect::<Vec<f64>>();
        text.lines().skip(1).map(|line| row(line).try_into().unwrap()).collect()
    };
    // The tables have nine digits.
    const DIGITS: f64 = 1e-9;
    let k = 0.2 * std::f64::consts::PI;
    let polarization = rows("ideal-polarization");
    assert!(polarization.len() >= 24 * 24);
    for [x, y, _, j_x, j_y, j_z] in polarization {
        assert!(
            (j_x - 0.12 * (k * x).sin()).abs() < DIGITS && (j_y - 0.12 * (k * y).sin()).abs() < DIGITS && j_z == 0.0
        );
    }
    let vectors = rows("ideal-vectors");
    assert!(vectors.len() > 500);
    let surface_t = 0.06 * (1.0 - (-k).exp());
    for [x, y, z, b_x, b_y, b_z] in vectors {
        let scale_t = surface_t * (k * z).exp();
        let known = [-(k * x).sin(), -(k * y).sin(), (k * x).cos() + (k * y).cos()];
        for (found, known) in [b_x, b_y, b_z].into_iter().zip(known) {
            assert!((found - scale_t * known).abs() < DIGITS, "({x}, {y}, {z})");
        }
    }
}

#[test]
fn warnings_are_recalled_after_the_numbers() {
    let sandbox = Sandbox::new();
    let text = std::fs::read_to_string(shipped("published-film")).expect("a shipped layout");
    let text = text.replace("field = {", "# field = {");
    let idle = |n: usize| {
        format!(
            "[[tile]]\nname = \"idle-{n}\"\nposition_mm = [{n}, 20, 0.5]\nsize_mm = [0.5, 1, 1]\npolarization_t = [0, 0, 0]\n"
        )
    };
    for (count, recalled) in [(0, ""), (1, "magsplice: 1 warning above\n"), (2, "magsplice: 2 warnings above\n")] {
        sandbox.write("film.toml", &(text.clone() + &(0..count).map(idle).collect::<String>()));
        let said = sandbox.run(&["decouple", "film.toml"]);
        assert_eq!(said.stderr.matches("warning: ").count(), count, "{}", said.stderr);
        let end = said.stderr.lines().last().map_or(String::new(), |line| format!("{line}\n"));
        assert_eq!(end, recalled);
        assert!(!sandbox.run(&["decouple", "film.toml", "--quiet"]).stderr.contains("above"));
        assert!(!sandbox.run(&["decouple", "film.toml", "-o", "film.txt"]).stderr.contains("above"));
    }
}

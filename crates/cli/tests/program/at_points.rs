//! `compare --points` and `decouple --points`.

use serde_json::Value;

use crate::{Sandbox, rows, shipped};

/// The points of the published film's working volume as a file, and what the verb says of them.
fn both(verb: &str) -> [Value; 2] {
    let sandbox = Sandbox::new();
    let film = shipped("published-film");
    assert_eq!(sandbox.run(&["field", &film, "-o", "points.csv"]).status, 0);
    [&[][..], &["--points", "points.csv"]].map(|points| {
        let said = sandbox.run(&[&[verb, &film, "--format", "json"], points].concat());
        assert_eq!((said.status, said.stderr.as_str()), (0, ""));
        serde_json::from_str(&said.stdout).expect("JSON")
    })
}

#[test]
fn comparison_at_the_points_of_the_volume_is_that_of_the_volume() {
    let [volume, points] = both("compare");
    assert_eq!(volume, points);
    let sandbox = Sandbox::new();
    sandbox.write("points.csv", "# x,y,z\n0.001,0,-0.004\n0,-0.002,-0.005\n");
    let film = shipped("published-film");
    let said = sandbox.run(&["compare", &film, "--points", "points.csv", "--unit", "m"]);
    assert!(said.status == 0 && said.stdout.contains("at 2 points of points.csv\naccuracy: exact"), "{}", said.stdout);
    assert!(said.stdout.contains("best-fit amplitude"));
}

#[test]
fn parameters_at_the_points_of_the_volume_are_those_of_the_volume() {
    let [volume, points] = both("decouple");
    for key in ["ideal_rmse", "displacement_rmse_mm", "comparison", "reference_mm", "points"] {
        assert_eq!(volume[key], points[key], "{key}");
    }
    for column in ["bz_t", "r_x_rad", "r_y_rad", "s_z"] {
        assert_eq!(volume["columns"][column], points["columns"][column], "{column}");
    }
    assert!(points.get("uniformity_rmse").is_none());
    assert!(points["omitted"]["uniformity_rmse"].as_str().expect("a reason").contains("planes of a grid"));
    let column = |name: &str| -> Vec<f64> {
        points["columns"][name].as_array().expect(name).iter().map(|v| v.as_f64().expect("a number")).collect()
    };
    // Eq. 14: the displacement is the change of a parameter over k, from the reference at z = -5.
    let k = std::f64::consts::TAU / 10.0;
    let at_reference =
        (0..405).find(|i| (column("x_mm")[*i], column("y_mm")[*i], column("z_mm")[*i]) == (0.0, 0.0, -5.0));
    let at_reference = at_reference.expect("a point of the grid");
    let (r_x, s_z) = (column("r_x_rad"), column("s_z"));
    let mut squares = 0.0;
    let mut worst: f64 = 0.0;
    for i in 0..405 {
        let x = -(r_x[i] - r_x[at_reference]) / k - column("x_mm")[i];
        let z = (s_z[i] - s_z[at_reference]) / k - (column("z_mm")[i] + 5.0);
        let found = ["x", "y", "z"].map(|axis| column(&format!("displacement_error_{axis}_mm"))[i]);
        assert!((found[0] - x).abs() < 1e-13 && (found[2] - z).abs() < 1e-13, "{found:?}, not {x} and {z}");
        assert!((column("r_x_error_rad")[i] + k * x).abs() < 1e-13);
        squares += found[0] * found[0] / 405.0;
        worst = worst.max(found.iter().map(|e| e * e).sum::<f64>().sqrt());
    }
    assert!((points["displacement_rmse_mm"]["x"].as_f64().expect("a number") - squares.sqrt()).abs() < 1e-13);
    let told = ["x", "y", "z"].map(|axis| points["worst_displacement_error_mm"][axis].as_f64().expect("a number"));
    assert!((told.iter().map(|e| e * e).sum::<f64>().sqrt() - worst).abs() < 1e-13);
}

#[test]
fn report_gives_the_reason_for_omitted_keys() {
    let sandbox = Sandbox::new();
    sandbox.write("points.csv", "x_mm,y_mm,z_mm\n0,0,-5\n1,0.5,-4\n");
    let film = shipped("published-film");
    let said = sandbox.run(&["decouple", &film, "--points", "points.csv"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    for line in [
        "at 2 points of points.csv",
        "  uniformity RMSE: undefined, needs the planes of a grid",
        "  (1, 0.5, -4) mm",
        "    at (1, 0.5, -4) mm",
    ] {
        assert!(said.stdout.contains(line), "{line}: {}", said.stdout);
    }
    assert!(said.stdout.lines().all(|l| l.len() <= 80), "fits a terminal");
    // The reference has no displacement, and so no error.
    let at_reference = said.stdout.lines().skip_while(|line| !line.starts_with("  (0, 0, -5) mm")).nth(1);
    let zeros = "    displacement error, mm                 0.000000     0.000000     0.000000";
    assert_eq!(at_reference, Some(zeros));
    let said = sandbox.run(&["decouple", &film, "--points", "points.csv", "-o", "out.csv", "--within", "1e-9"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    assert_eq!(rows(&sandbox.read("out.csv")).len(), 2);
    assert_eq!(sandbox.run(&["decouple", &film, "--points", "points.csv", "-o", "out.vtp"]).status, 0);
    sandbox
        .run(&["decouple", &film, "--points", "points.csv", "-o", "out.vti"])
        .refuses("points of a file are poly data");
    sandbox
        .run(&["decouple", &film, "--points", "points.csv", "-o", "points.csv"])
        .refuses("it is an input, which would be lost");
}

#[test]
fn points_without_an_ideal_field_are_named() {
    let sandbox = Sandbox::new();
    let film = shipped("published-film");
    sandbox.write("points.csv", "x_mm,y_mm,z_mm\n0,0,-4\n1,0,0\n# a comment\n7,0,-4\n0,-5,-4\n2,0,3\n");
    for verb in ["compare", "decouple"] {
        let said = sandbox.run(&[verb, &film, "--points", "points.csv"]);
        said.refuses("points.csv: line 3: (1, 0, 0) mm is not below the film, and Eq. 2 holds only for z < 0");
        said.refuses("points.csv: line 7: (2, 0, 3) mm is not below the film");
        let half_wave =
            "points.csv: line 5: (7, 0, -4) mm: x = 7, must be less than half a wavelength, 5 mm, from the axis";
        assert_eq!(said.stderr.contains(half_wave), verb == "decouple", "{}", said.stderr);
        assert_eq!(said.stderr.contains("line 6: (0, -5, -4) mm: y = -5"), verb == "decouple", "{}", said.stderr);
    }
    sandbox.write("good.csv", "x_mm,y_mm,z_mm\n0,0,-4\n");
    sandbox
        .run(&["compare", &shipped("single-tile"), "--points", "good.csv"])
        .refuses("the layout has no [ideal] table");
}

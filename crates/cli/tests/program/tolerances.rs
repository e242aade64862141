//! `--within` and `plan`.

use serde_json::Value;

use crate::{Sandbox, rows, shipped};

#[test]
fn field_keeps_its_tolerance_and_states_it() {
    let sandbox = Sandbox::new();
    let fine = std::fs::read_to_string(shipped("published-film")).unwrap().replace("step_mm = 0.5", "step_mm = 0.125");
    sandbox.write("fine.toml", &fine);
    for (arguments, fraction, tesla) in [
        (["fine.toml", "--within", "1e-5", "-o", "rough.csv"], 1e-5, 0.0),
        (["fine.toml", "--within", "20 nT", "-o", "rough.csv"], 0.0, 20e-9),
    ] {
        for (command, path) in [
            (&["field", "fine.toml", "-o", "exact.csv"][..], "exact.csv"),
            (&[&["field"], &arguments[..]].concat(), "rough.csv"),
        ] {
            let said = sandbox.run(command);
            assert_eq!((said.status, said.stderr.as_str()), (0, ""), "{path}");
        }
        let (exact, rough) = (rows(&sandbox.read("exact.csv")), rows(&sandbox.read("rough.csv")));
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
        let said = sandbox.run(&[&["decouple", "fine.toml", "--format", "json"], arguments].concat());
        serde_json::from_str(&said.stdout).unwrap()
    };
    assert_eq!(json(&[])["accuracy"], "exact");
    let within = json(&["--within", "2.5uT"]);
    assert_eq!(within["accuracy"], serde_json::json!({ "absolute_t": 2.5e-6 }));
    let apart =
        within["uniformity_rmse"]["r_x"].as_f64().unwrap() - json(&[])["uniformity_rmse"]["r_x"].as_f64().unwrap();
    assert!(apart != 0.0 && apart.abs() < 1e-3, "{apart}");
    let said = sandbox.run(&["decouple", "fine.toml", "--within", "1e-7"]);
    assert!(said.stdout.contains("\naccuracy: within 1e-7 of |B|\n"), "{}", said.stdout);
    let said = sandbox.run(&["compare", "fine.toml", "--within", "1e-15"]);
    assert_eq!(said.status, 2);
    assert!(
        said.stderr.contains("(-2, -2, -5) mm: the tolerance cannot be kept: even the exact field"),
        "{}",
        said.stderr
    );
    for wrong in ["0", "-1e-3", "nan", "1e-6 kT", "T", ""] {
        let said = sandbox.run(&["field", "fine.toml", &format!("--within={wrong}")]);
        assert_eq!((said.status, said.stdout.as_str()), (2, ""), "{wrong}");
        assert!(said.stderr.contains("must be a"), "{wrong}: {}", said.stderr);
    }
}

#[test]
fn plan_states_methods_points_and_truncation() {
    let sandbox = Sandbox::new();
    let film = shipped("published-film");
    let said = sandbox.run(&["plan", &film, "--within", "1e-6"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    for line in [
        "405 points of the working volume",
        "accuracy: within 1e-6 of |B|",
        "truncation     none",
        "(1.0 times as many)",
    ] {
        assert!(said.stdout.contains(line), "{line:?} is not in {}", said.stdout);
    }
    // A tolerance that `field` does not keep has no plan either.
    for tolerance in ["1e-300", "1e-300nT", "1e-17"] {
        let cause = "the tolerance cannot be kept: even the exact field is only certain to";
        sandbox.run(&["field", &film, "--within", tolerance, "-o", "out.csv"]).refuses(cause);
        sandbox.run(&["plan", &film, "--within", tolerance]).refuses(cause);
        sandbox.run(&["plan", &film, "--within", tolerance, "--format", "json"]).refuses(cause);
    }
    // On a finer grid an expansion is cheaper.
    let fine = std::fs::read_to_string(&film)
        .expect("a shipped layout")
        .replace("step_mm = 0.5", "step_mm = 0.1")
        .replace("published.field.csv", "fine.csv");
    let fine = sandbox.write("fine.toml", &fine);
    let said = sandbox.run(&["plan", fine.to_str().expect("UTF-8"), "--within", "10nT", "--format", "json"]);
    let plan: Value = serde_json::from_str(&said.stdout).expect("JSON");
    let part = &plan["parts"][0];
    assert_eq!((plan["parts"].as_array().map(Vec::len), part["model"].as_str()), (Some(1), Some("chebyshev")));
    assert_eq!((part["points"].as_u64(), part["distance_mm"].as_f64()), (Some(41 * 41 * 21), Some(3.0)));
    assert!(part["error_t"].as_f64().expect("a number") <= 1e-8);
    let (cost, exact) = (plan["cost"].as_f64().expect("a number"), plan["exact_cost"].as_f64().expect("a number"));
    assert_eq!(exact, 56.0 * 41.0 * 41.0 * 21.0);
    assert!(10.0 * cost < exact, "{cost}");
    // Points of a file, and a layout without a volume.
    let tile = "format = 1\nname = \"t\"\n[[tile]]\nname = \"t\"\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
    let tile = sandbox.write("tile.toml", tile);
    let tile = tile.to_str().expect("UTF-8");
    // Fewer points are not worth a tree.
    let far: String = (0..300).map(|n| format!("{n},0,-500\n")).collect();
    sandbox.write("p.csv", &format!("x_mm,y_mm,z_mm\n{far}"));
    let said = sandbox.run(&["plan", &shipped("film-80mm"), "--points", "p.csv", "--within", "1e-4"]);
    assert!(
        said.stdout.contains("300 points of p.csv") && said.stdout.contains("800 of 800 by 1.0 expansions of degree"),
        "{}",
        said.stdout
    );
    sandbox.run(&["plan", tile, "--within", "1e-4"]).refuses("the layout has no [volume] table to take points from");
}

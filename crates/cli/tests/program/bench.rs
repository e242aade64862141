//! `bench`: pairs per second.

use serde_json::Value;

use crate::{Sandbox, shipped};

fn measured(sandbox: &Sandbox, arguments: &[&str]) -> Value {
    let said = sandbox.run(&[&["bench", "--format", "json", "--seconds", "0.2"], arguments].concat());
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    serde_json::from_str(&said.stdout).expect("JSON")
}

#[test]
fn bench_states_pairs_per_second_of_each_accuracy_and_thread_count() {
    let sandbox = Sandbox::new();
    let json = measured(&sandbox, &[&shipped("published-film"), "--threads", "2"]);
    let number = |value: &Value| value.as_f64().expect("a number");
    assert_eq!((json["points"].as_u64(), json["tiles"].as_u64()), (Some(405), Some(56)));
    assert_eq!(number(&json["pairs"]), 405.0 * 56.0);
    assert!(json["rounds"].as_u64().expect("a count") >= 3);
    let cases = json["cases"].as_array().expect("cases");
    let named: Vec<(String, u64)> =
        cases.iter().map(|c| (c["accuracy"].to_string(), c["threads"].as_u64().expect("a count"))).collect();
    let accuracies = ["\"exact\"", "{\"relative\":0.001}", "{\"relative\":1e-6}", "{\"relative\":1e-9}"];
    let expected: Vec<(String, u64)> =
        [1, 2].into_iter().flat_map(|n| accuracies.map(|accuracy| (accuracy.to_owned(), n))).collect();
    assert_eq!(named, expected);
    for case in cases {
        let (pairs, seconds) = (number(&case["pairs_per_second"]), number(&case["seconds"]));
        assert!((pairs * seconds / (405.0 * 56.0) - 1.0).abs() < 1e-12 && seconds > 0.0, "{case}");
        let [least, largest] = ["least_seconds", "largest_seconds"].map(|key| number(&case[key]));
        // Three rounds or more, timed to a nanosecond or better, are never all the same.
        assert!(0.0 < least && least <= seconds && seconds <= largest && least < largest, "{case}");
    }
    assert_eq!((number(&cases[0]["times_exact"]), number(&cases[4]["times_exact"])), (1.0, 1.0));
    let ratio = number(&cases[0]["seconds"]) / number(&cases[1]["seconds"]);
    assert!((number(&cases[1]["times_exact"]) / ratio - 1.0).abs() < 1e-12);
    // One thread is one column of cases.
    assert_eq!(
        measured(&sandbox, &[&shipped("published-film"), "--threads", "1"])["cases"].as_array().map(Vec::len),
        Some(4)
    );
}

#[test]
fn bench_as_text_and_at_points_of_a_file() {
    let sandbox = Sandbox::new();
    sandbox.write("p.csv", "x_mm,y_mm,z_mm\n0,0,-4\n1,0,-4\n");
    let film = shipped("published-film");
    let said = sandbox.run(&["bench", &film, "--points", "p.csv", "--seconds", "0.1", "--threads", "1"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    assert!(said.stdout.contains("2 points of p.csv; pairs of a tile and a point: 112"), "{}", said.stdout);
    assert!(said.stdout.contains(" rounds, with the fastest and the slowest\n"), "{}", said.stdout);
    let table: Vec<&str> = said.stdout.lines().skip_while(|line| !line.starts_with("accuracy")).collect();
    assert_eq!(table.len(), 5, "{}", said.stdout);
    for (line, accuracy) in table[1..].iter().zip(["exact", "within 1e-3", "within 1e-6", "within 1e-9"]) {
        assert!(line.starts_with(accuracy) && line.len() <= 80, "{line}");
        // The spread is written as least .. largest.
        let cells: Vec<&str> = line.split_whitespace().rev().collect();
        assert_eq!(cells[2], "..", "{line}");
        let [times, largest, least, ms, pairs] = [0, 1, 3, 4, 5].map(|i| cells[i].parse::<f64>().expect("a number"));
        assert!(times > 0.0 && pairs > 1e4 && 0.0 < least && least <= ms && ms <= largest && least < largest, "{line}");
    }
}

#[test]
fn bench_refuses_points_without_a_field_and_layouts_without_points() {
    let sandbox = Sandbox::new();
    let tile = "format = 1\nname = \"t\"\n[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
    sandbox.write("t.toml", tile);
    sandbox.run(&["bench", "t.toml"]).refuses("has no [volume] table to take points from");
    sandbox.write("p.csv", "x_mm,y_mm,z_mm\n0.5,0,0.5\n");
    sandbox.run(&["bench", "t.toml", "--points", "p.csv"]).refuses("the field is unbounded there");
    sandbox.write("p.csv", "x_mm,y_mm,z_mm\n");
    sandbox.run(&["bench", "t.toml", "--points", "p.csv"]).refuses("has no points below its names of columns");
    sandbox.run(&["bench", "t.toml", "--seconds", "0"]).refuses_arguments("must be a number greater than 0");
}

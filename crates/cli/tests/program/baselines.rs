//! Baselines of `check`: how they are compared, and what `--update` replaces.

use serde_json::{Value, json};

use crate::checks::{expectation, published, report};
use crate::{Sandbox, shipped};

#[test]
fn changed_film_differs_from_its_baseline_until_update() {
    let sandbox = Sandbox::new();
    published(&sandbox, |text| text.replace("0.85, 3.3", "0.8500001, 3.3"));
    let (status, json) = report(&sandbox, &["films/film.toml"]);
    assert_eq!(status, 1);
    let field = expectation(&json, "field");
    assert_eq!((&field["status"], &field["at_most"]), (&json!("failed"), &json!(1e-12)));
    assert!(field["value"].as_f64().unwrap() > 1e-9 && field["at_mm"].as_array().unwrap().len() == 3);
    // The change is too small for the bounds of the other expectations.
    assert_eq!(expectation(&json, "amplitude")["status"], "ok");

    let before = sandbox.read("films/published.field.csv");
    let said = sandbox.run(&["check", "--update", "films/film.toml"]);
    assert_eq!(said.status, 0);
    let wrote = "magsplice: wrote films/published.field.csv, 405 points: the field moved by at most ";
    let moved = said.stderr.strip_prefix(wrote).unwrap_or_else(|| panic!("{}", said.stderr));
    assert!(moved.contains("e-8 of |B|, at (") || moved.contains("e-7 of |B|, at ("), "{moved}");
    // The largest change that `check` found before, to the digits that are printed.
    let (largest, place) = moved.split_once(" of |B|, at ").unwrap();
    assert_eq!(largest, format!("{:.3e}", field["value"].as_f64().unwrap()));
    let at: Vec<String> = field["at_mm"].as_array().unwrap().iter().map(|c| c.as_f64().unwrap().to_string()).collect();
    assert_eq!(place, format!("({}) mm\n", at.join(", ")));
    assert_ne!(sandbox.read("films/published.field.csv"), before);
    // The baseline is byte for byte what `field` writes.
    assert_eq!(sandbox.read("films/published.field.csv"), sandbox.run(&["field", "films/film.toml"]).stdout);
    assert_eq!(report(&sandbox, &["films/film.toml"]).0, 0);
    for (change, told) in [
        (None, "the field is the same to the last digit"),
        (Some("x_mm,y_mm,z_mm,bx_t,by_t,bz_t\n0,0,0,0,0,0\n"), "the earlier baseline had other points"),
        (Some("x_mm,y_mm,z_mm,bx_t,by_t,bz_t\n0,0\n"), "the earlier baseline could not be read"),
        (Some(""), "a new baseline"),
    ] {
        match change {
            Some("") => std::fs::remove_file(sandbox.path("films/published.field.csv")).unwrap(),
            Some(text) => drop(sandbox.write("films/published.field.csv", text)),
            None => {}
        }
        let said = sandbox.run(&["check", "--update", "films/film.toml"]);
        assert!(said.status == 0 && said.stderr.ends_with(&format!(", 405 points: {told}\n")), "{}", said.stderr);
    }
    assert_eq!(sandbox.files(), ["films"]);
    assert_eq!(std::fs::read_dir(sandbox.path("films")).unwrap().count(), 2);
}

#[test]
fn unusable_baseline_is_an_error() {
    let sandbox = Sandbox::new();
    published(&sandbox, |text| text);
    let good = sandbox.read("films/published.field.csv");
    let second = good.lines().nth(1).unwrap().to_owned();
    for (text, message) in [
        (
            None,
            "films/published.field.csv: cannot read this baseline: No such file or directory (os error 2) (`magsplice check --update` writes it)",
        ),
        (Some(String::new()), "published.field.csv: line 1: no column x_mm, y_mm, z_mm, bx_t, by_t, bz_t, must have"),
        (Some(good.replace("by_t", "by_mt")), "line 1: no column by_t, must have x_mm,y_mm,z_mm,bx_t,by_t,bz_t"),
        (
            Some(good.replace(&second, "0,0,-5,1,nan,x")),
            "line 2: by_t = \"nan\", bz_t = \"x\", must be a finite number",
        ),
        (Some(good.replace(&second, "0,0,-5,1")), "line 2: has 4 fields, must have 6"),
        (Some(good.replace(&format!("{second}\n"), "")), "the baseline has 404 points and the working volume 405"),
        (
            Some(good.replace(&second, "0,0,-5,1,1,1")),
            "point 1 of the baseline is (0, 0, -5) mm and of the working volume (-2, -2, -5)",
        ),
    ] {
        match &text {
            None => std::fs::remove_file(sandbox.path("films/published.field.csv")).unwrap(),
            Some(text) => drop(sandbox.write("films/published.field.csv", text)),
        }
        let said = sandbox.run(&["check", "films/film.toml"]);
        assert_eq!(said.status, 2, "{message}: {}", said.stdout);
        assert!(
            said.stdout.contains(message) && said.stderr.is_empty(),
            "{message:?} is not in {:?}, or in {:?}",
            said.stdout,
            said.stderr
        );
        // The other expectations are evaluated.
        assert!(
            said.stdout.contains("  ERROR    field")
                && said.stdout.matches("  ok  ").count() == 5
                && said.stdout.contains(message),
            "{}",
            said.stdout
        );
    }
}

#[test]
fn failed_update_keeps_the_earlier_files() {
    let sandbox = Sandbox::new();
    // The layout names itself as its baseline.
    published(&sandbox, |text| text.replace("published.field.csv", "film.toml"));
    let layout = sandbox.read("films/film.toml");
    let said = sandbox.run(&["check", "--update", "films/film.toml"]);
    assert_eq!(said.status, 2);
    assert!(said.stdout.contains("cannot write films/film.toml: it does not begin with"), "{}", said.stdout);
    assert_eq!(sandbox.read("films/film.toml"), layout);
    // Points of the volume on an exposed edge have no field.
    published(&sandbox, |text| {
        text.replace("[[lattice]]", "[[tile]]\nname = \"in the way\"\nposition_mm = [0, 0, -4.5]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n[[lattice]]")
    });
    let baseline = sandbox.read("films/published.field.csv");
    let said = sandbox.run(&["check", "--update", "films/film.toml"]);
    assert_eq!(said.status, 2);
    assert!(
        said.stdout.contains("mm: the field is unbounded there, on an exposed edge of tile \"in the way\""),
        "{}",
        said.stdout
    );
    assert_eq!(sandbox.read("films/published.field.csv"), baseline);
    // Five expectations fail for one cause, which is printed once. The clearance is negative: the
    // depth by which the tile reaches into the volume.
    assert_eq!(said.stdout.matches("(-0.5, -0.5, -5) mm").count(), 1, "{}", said.stdout);
    assert_eq!(said.stdout.matches("for the same reason as uniformity_rmse.r_x\n").count(), 4, "{}", said.stdout);
    assert_eq!(said.stderr, "");
    assert!(
        said.stdout.contains("FAILED   clearance_mm") && said.stdout.contains("-1.000000  at least 3.0"),
        "{}",
        said.stdout
    );
    assert!(said.stdout.contains("tile \"in the way\""));
}

/// The layout names the file that `--update` writes, so a stranger's layout could name any file.
#[test]
fn update_replaces_nothing_but_a_baseline() {
    let sandbox = Sandbox::new();
    let name = |file: &str| published(&sandbox, |text| text.replace("\"published.field.csv\"", &format!("\"{file}\"")));
    let with_notes = "x_mm,y_mm,z_mm,bx_t,by_t,bz_t,note\n0,0,0,0,0,0,mine\n";
    for text in ["mine\n", "", "x_mm,y_mm,z_mm\n0,0,0\n", with_notes] {
        name("../notes.txt");
        sandbox.write("notes.txt", text);
        let said = sandbox.run(&["check", "--update", "films/film.toml"]);
        assert_eq!(said.status, 2);
        assert!(
            said.stdout.contains("cannot write films/../notes.txt: it does not begin with x_mm,")
                && said.stdout.contains(" and would be lost: delete it first\n"),
            "{}",
            said.stdout
        );
        assert_eq!(sandbox.read("notes.txt"), text);
    }
    // Another layout of the same call is no baseline either.
    name("../other.toml");
    std::fs::copy(shipped("single-tile"), sandbox.path("other.toml")).unwrap();
    assert_eq!(sandbox.run(&["check", "--update", "films/film.toml", "other.toml"]).status, 2);
    assert_eq!(sandbox.read("other.toml"), std::fs::read_to_string(shipped("single-tile")).unwrap());
    #[cfg(unix)]
    {
        // Endless, with or without --update.
        name("/dev/zero");
        for arguments in [&["check", "films/film.toml"][..], &["check", "--update", "films/film.toml"]] {
            let said = sandbox.run(arguments);
            assert_eq!(said.status, 2);
            assert!(said.stdout.contains("/dev/zero: ") && said.stdout.contains("it is not a regular file"));
        }
    }
    // An earlier baseline with the ends of lines of Windows is one.
    name("published.field.csv");
    let windows = sandbox.read("films/published.field.csv").replace('\n', "\r\n");
    sandbox.write("films/published.field.csv", &windows);
    assert_eq!(sandbox.run(&["check", "--update", "films/film.toml"]).status, 0);
}

#[test]
fn update_refuses_a_baseline_of_two_layouts() {
    let sandbox = Sandbox::new();
    published(&sandbox, |text| text);
    let other = sandbox.read("films/film.toml").replace("0.85, 3.3", "0.8500001, 3.3");
    sandbox.write("films/other.toml", &other.replace("published.field.csv", "../films/published.field.csv"));
    let baseline = sandbox.read("films/published.field.csv");
    for exists in [true, false] {
        if !exists {
            std::fs::remove_file(sandbox.path("films/published.field.csv")).unwrap();
        }
        let said = sandbox.run(&["check", "--update", "films"]);
        assert_eq!((said.status, said.stdout.as_str()), (2, ""));
        let both = "the layouts films/film.toml and films/other.toml have the same baseline";
        assert!(said.stderr.contains(both), "{}", said.stderr);
        assert_eq!(sandbox.path("films/published.field.csv").exists(), exists);
        assert!(!exists || sandbox.read("films/published.field.csv") == baseline);
    }
    // One layout that is named twice is no conflict.
    assert_eq!(sandbox.run(&["check", "--update", "films/film.toml", "./films/film.toml"]).status, 0);
}

#[test]
fn quiet_update_states_in_its_results_how_far_the_field_moved() {
    let sandbox = Sandbox::new();
    published(&sandbox, |text| text.replace("0.85, 3.3", "0.8500001, 3.3"));
    let arguments = ["check", "--update", "-q", "films/film.toml", "--format"];
    let said = sandbox.run(&[&arguments[..], &["json"]].concat());
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let json: Value = serde_json::from_str(&said.stdout).unwrap();
    let moved = json["layouts"][0]["moved"].as_str().expect("a text");
    assert!(moved.starts_with("the field moved by at most ") && moved.ends_with(" mm"), "{moved}");
    let xml = sandbox.run(&[&arguments[..], &["junit"]].concat()).stdout;
    assert!(xml.contains("<property name=\"moved\" value=\"the field is the same to the last digit\"/>"), "{xml}");
    assert!(report(&sandbox, &["films/film.toml"]).1["layouts"][0].get("moved").is_none());
}

//! `check`: expectations, baselines, JSON and JUnit.

use serde_json::{Value, json};

use crate::{Sandbox, shipped};

/// Writes the published film and its baseline to a folder below the one the program runs in.
pub(crate) fn published(sandbox: &Sandbox, change: impl Fn(String) -> String) {
    std::fs::create_dir_all(sandbox.path("films")).unwrap();
    let layout = shipped("published-film");
    sandbox.write("films/film.toml", &change(std::fs::read_to_string(&layout).unwrap()));
    std::fs::copy(
        layout.replace("published-film.toml", "published.field.csv"),
        sandbox.path("films/published.field.csv"),
    )
    .unwrap();
}

pub(crate) fn report(sandbox: &Sandbox, arguments: &[&str]) -> (i32, Value) {
    let said = sandbox.run(&[&["check", "--format", "json"], arguments].concat());
    (said.status, serde_json::from_str(&said.stdout).unwrap())
}

/// The expectation of this name of the first layout in a report.
pub(crate) fn expectation<'a>(report: &'a Value, name: &str) -> &'a Value {
    let all = report["layouts"][0]["expectations"].as_array().unwrap();
    all.iter().find(|e| e["expectation"] == name).unwrap_or_else(|| panic!("no {name} in {all:?}"))
}

#[test]
fn check_prints_value_bound_and_margin_of_each_expectation() {
    let sandbox = Sandbox::new();
    published(&sandbox, |text| text);
    let said = sandbox.run(&["check", "films/film.toml"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let lines: Vec<Vec<&str>> = said.stdout.lines().map(|l| l.split_whitespace().collect()).collect();
    assert_eq!(lines[0].join(" "), "films/film.toml: published film, 56 tiles");
    assert_eq!(lines[1].join(" "), "ok uniformity_rmse.r_x 0.062872 at most 0.0629 margin 2.83687e-5");
    let keys: Vec<&str> = lines[1..7].iter().map(|l| l[1]).collect();
    let known =
        ["uniformity_rmse.r_x", "uniformity_rmse.r_y", "uniformity_rmse.s_z", "amplitude", "field", "clearance_mm"];
    assert_eq!(keys, known);
    // Nothing about recoil, because the layout has no permeability.
    assert_eq!((lines.len(), lines[7].join(" ")), (8, "1 layout checked".to_owned()), "{}", said.stdout);
    assert_eq!(lines[6][1..6], ["clearance_mm", "3.000000", "at", "least", "3.0"]);
    assert!(said.stdout.lines().all(|l| l.len() <= 100), "fits a wide terminal: {}", said.stdout);

    let bare = sandbox.run(&["check", &shipped("single-tile"), "films/film.toml"]);
    assert!(bare.stdout.contains("clearance_mm  0.500000  at least 0.5"), "{}", bare.stdout);
}

#[test]
fn unmet_expectations_are_findings() {
    let sandbox = Sandbox::new();
    published(&sandbox, |text| {
        text.replace("s_z = 0.0399", "s_z = 0.0398")
            .replace("min = 0.8187", "min = 0.9")
            .replace("min = 3.0", "min = 3.5")
    });
    let said = sandbox.run(&["check", "films/film.toml"]);
    assert_eq!((said.status, said.stderr.as_str()), (1, ""));
    let failed: Vec<&str> = said.stdout.lines().filter(|l| l.starts_with("  FAILED")).collect();
    assert_eq!(failed.len(), 3, "{}", said.stdout);
    for (line, part) in failed.iter().zip(["margin -8.83778e-5", "margin -0.081270", "margin -0.500000"]) {
        assert!(line.contains(part), "{line}");
    }
    let (status, json) = report(&sandbox, &["films/film.toml"]);
    assert_eq!((status, &json["layouts"][0]["status"]), (1, &json!("failed")));
    let s_z = expectation(&json, "uniformity_rmse.s_z");
    assert_eq!((&s_z["status"], &s_z["at_most"], &s_z["error"]), (&json!("failed"), &json!(0.0398), &Value::Null));
    let (value, margin) = (s_z["value"].as_f64().unwrap(), s_z["margin"].as_f64().unwrap());
    assert!((value - 0.039888).abs() < 1e-6 && margin == 0.0398 - value);
    let clearance = expectation(&json, "clearance_mm");
    assert_eq!((&clearance["at_least"], &clearance["value"]), (&json!(3.5), &json!(3.0)));
    assert!(clearance["tile"].as_str().unwrap().starts_with("film-x"));
    assert_eq!(expectation(&json, "uniformity_rmse.r_x")["status"], "ok");
}

#[test]
fn json_and_junit_hold_findings_and_errors_of_all_layouts() {
    let sandbox = Sandbox::new();
    published(&sandbox, |text| text.replace("min = 3.0", "min = 4.0"));
    let tile = "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\n";
    sandbox.write("idle.toml", &format!("format = 1\nname = \"a < b & c\"\n{tile}polarization_t = [0, 0, 0]\n"));
    sandbox.write("broken.toml", &format!("format = 1\nname = \"broken\"\n{tile}"));
    let all = ["films/film.toml", "idle.toml", "broken.toml"];
    let (status, json) = report(&sandbox, &all);
    assert_eq!((status, json["version"].as_str()), (2, Some(env!("CARGO_PKG_VERSION"))));
    let of = |key: &str| json["layouts"].as_array().unwrap().iter().map(|l| l[key].clone()).collect::<Vec<Value>>();
    assert_eq!(of("status"), ["failed", "failed", "error"]);
    assert_eq!(of("findings"), [json!([]), json!(["tile \"tile-1\" has no polarization, so no field"]), json!([])]);
    assert!(of("error")[2].as_str().unwrap().contains("broken.toml: line 3: tile \"tile-1\": has no polarization"));

    let said = sandbox.run(&[&["check", "--format", "junit"], &all[..]].concat());
    assert_eq!(said.status, 2);
    let xml = &said.stdout;
    assert!(xml.starts_with("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"), "{xml}");
    assert!(
        xml.contains(
            "<testsuites name=\"magsplice check\" tests=\"9\" skipped=\"0\" failures=\"2\" errors=\"1\" time=\""
        ),
        "{xml}"
    );
    assert!(xml.contains("<testcase name=\"clearance_mm\" classname=\"films/film.toml\" time=\"0.000\">\n            <failure message=\"3.0, at least 4.0, margin -1.0 tile"), "{xml}");
    assert!(xml.contains("<failure message=\"tile &quot;tile-1&quot; has no polarization"), "{xml}");
    assert!(xml.contains("<error message=\"broken.toml: line 3: "), "{xml}");
    assert!(xml.contains("at most 1e-12, margin "), "{xml}");
    // Standard output is a file in a build, and the log has standard error.
    for told in [
        "magsplice: films/film.toml: FAILED clearance_mm: 3.0, at least 4.0, margin -1.0 tile \"",
        "magsplice: idle.toml: tile \"tile-1\" has no polarization, so no field\n",
        "magsplice: broken.toml: line 3: ",
    ] {
        assert_eq!(said.stderr.matches(told).count(), 1, "{}", said.stderr);
    }
}

/// A message of many lines is the body of its element; its attribute has the first line.
#[test]
fn junit_messages_have_one_line() {
    let sandbox = Sandbox::new();
    published(&sandbox, |text| text.replace("published.field.csv", "bad.csv"));
    sandbox.write("films/bad.csv", "x_mm,y_mm,z_mm,bx_t,by_t,bz_t\n0,0,0,0,0,a\n0,0,0,0,0,b\n");
    sandbox.write("broken.toml", "format = 1\n[[tile]\n");
    let said = sandbox.run(&["check", "--format", "junit", "films", "broken.toml"]);
    let xml = roxmltree::Document::parse(&said.stdout).expect("well-formed XML");
    let errors: Vec<_> = xml.descendants().filter(|node| node.has_tag_name("error")).collect();
    assert_eq!(errors.len(), 2, "{}", said.stdout);
    for error in errors {
        let (message, body) = (error.attribute("message").expect("a message"), error.text().expect("a body"));
        assert_eq!(Some(message), body.lines().next());
        assert!(body.lines().count() > 1, "{body}");
        let case = error.parent_element().expect("a case");
        assert!(!case.children().any(|node| node.has_tag_name("system-out")), "{}", said.stdout);
    }
    assert!(!said.stdout.contains("&#xA;") && !said.stdout.contains("&#10;"), "{}", said.stdout);
}

/// XML has no escapes for some characters, which names, paths and excerpts may have.
#[test]
fn junit_is_well_formed_for_any_character() {
    let sandbox = Sandbox::new();
    let tile = "format = 1\nname = \"idle\"\n[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\n";
    let name = "\u{fffe}\u{ffff}]]>&<\"\u{1f600}";
    sandbox.write("idle.toml", &format!("{tile}name = '{name}'\npolarization_t = [0, 0, 0]\n"));
    sandbox.write("broken.toml", "# \u{1}\u{1b}[31m\u{fffe}\n");
    let mut files = vec!["idle.toml", "broken.toml"];
    if cfg!(target_os = "linux") {
        sandbox.write("\u{7}\u{ffff}\n.toml", tile);
        files.push("\u{7}\u{ffff}\n.toml");
    }
    let said = sandbox.run(&[&["check", "--format", "junit"], &files[..]].concat());
    assert_eq!(said.status, 2);
    let xml = roxmltree::Document::parse(&said.stdout).unwrap_or_else(|error| panic!("{error}: {}", said.stdout));
    let finding = xml.descendants().find(|node| node.has_tag_name("failure")).expect("a finding");
    let message = finding.attribute("message").expect("a message");
    assert_eq!(message, "tile \"\u{fffd}\u{fffd}]]>&<\"\u{1f600}\" has no polarization, so no field");
}

#[test]
fn findings_exit_with_1_and_unusable_layouts_with_2() {
    let sandbox = Sandbox::new();
    let tile = "format = 1\nname = \"idle\"\n[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\n";
    sandbox.write("idle.toml", &format!("{tile}polarization_t = [0, 0, 0]\n"));
    let said = sandbox.run(&["check", "idle.toml"]);
    assert_eq!(said.status, 1);
    assert_eq!(said.stderr, "");
    let lines = [
        "idle.toml: idle, 1 tile, no expectations",
        "  FINDING  tile \"tile-1\" has no polarization, so no field",
        "1 layout checked, 1 failed",
    ];
    assert_eq!(said.stdout.lines().collect::<Vec<_>>(), lines);

    // An unusable layout does not hide the findings of the others.
    sandbox.write("broken.toml", tile);
    let said = sandbox.run(&["check", "broken.toml", "idle.toml"]);
    assert_eq!(said.status, 2);
    let error =
        "broken.toml: cannot be used\n  ERROR    broken.toml: line 3: tile \"tile-1\": has no polarization: give";
    assert!(said.stdout.contains(error), "{}", said.stdout);
    assert!(said.stdout.contains("  FINDING  tile \"tile-1\" has no polarization, so no field\n"), "{}", said.stdout);
    assert!(said.stdout.ends_with("\n2 layouts checked, 1 failed, 1 with an error\n"), "{}", said.stdout);
    assert_eq!(said.stderr, "");
}

#[test]
fn junit_states_times_that_add_up() {
    let sandbox = Sandbox::new();
    published(&sandbox, |text| text.replace("step_mm = 0.5", "step_mm = 0.025"));
    let said = sandbox.run(&["check", "--format", "junit", "films/film.toml", &shipped("single-tile")]);
    let xml = roxmltree::Document::parse(&said.stdout).expect("well-formed XML");
    let time = |node: roxmltree::Node| -> f64 { node.attribute("time").expect("a time").parse().expect("seconds") };
    let all = |tag: &'static str| xml.descendants().filter(move |node| node.has_tag_name(tag));
    let cases: f64 = all("testcase").map(time).sum();
    let (suites, total) = (all("testsuite").map(time).sum::<f64>(), time(xml.root_element()));
    // Three digits after the point for each of about ten cases.
    assert!((cases - total).abs() < 0.01 && (suites - total).abs() < 0.01, "{cases} {suites} {total}");
    // The first expectation that needs the field bears its time: that of two million values.
    let first = all("testcase").find(|case| case.attribute("name") == Some("uniformity_rmse.r_x")).expect("a case");
    assert!(time(first) > 0.5 * total && total > 0.05, "{} of {total}", time(first));
}

#[test]
fn folders_stand_for_all_layouts_below_them_in_order() {
    let sandbox = Sandbox::new();
    published(&sandbox, |text| text);
    let tile = "format = 1\nname = \"tile\"\n[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
    for folder in ["films/a", "films/a/deep", "films/.hidden", "empty"] {
        std::fs::create_dir_all(sandbox.path(folder)).unwrap();
    }
    for file in ["films/z.toml", "films/a/deep/b.TOML", "films/.hidden/c.toml", "films/.d.toml", "films/a/e.txt"] {
        sandbox.write(file, tile);
    }
    sandbox.write("films/Cargo.toml", "[package]\nname = \"film\"\n");
    let files = |json: &Value| -> Vec<String> {
        json["layouts"].as_array().unwrap().iter().map(|l| l["file"].as_str().unwrap().to_owned()).collect()
    };
    let (status, json) = report(&sandbox, &["films"]);
    assert_eq!(files(&json), ["films/a/deep/b.TOML", "films/film.toml", "films/z.toml"]);
    assert_eq!(status, 0);
    let said = sandbox.run(&["check", "films"]);
    assert!(
        said.stdout.starts_with("films/Cargo.toml: skipped, not a layout: it has no key `format`\n"),
        "{}",
        said.stdout
    );
    let quiet = sandbox.run(&["check", "films", "--quiet"]);
    assert_eq!((quiet.stdout.as_str(), quiet.stderr.as_str()), ("3 layouts checked, 1 other file skipped\n", ""));
    // A file and a folder, in the order of the arguments.
    assert_eq!(files(&report(&sandbox, &["films/z.toml", "films/a"]).1), ["films/z.toml", "films/a/deep/b.TOML"]);
    // A broken layout is no other file, and neither is one without its first line.
    sandbox.write("films/a/broken.toml", "format = 1\n[[tile]\n");
    sandbox.write("films/a/headless.toml", "[[tile]]\nposition_mm = [0, 0, 0]\n");
    let said = sandbox.run(&["check", "films"]);
    assert_eq!(said.status, 2);
    for error in ["films/a/broken.toml: TOML parse error", "films/a/headless.toml: TOML parse error"] {
        assert!(said.stdout.contains(error), "{}", said.stdout);
    }
    sandbox.run(&["check", "empty"]).refuses("empty: no layout in this folder");
    #[cfg(unix)]
    {
        // A link to a folder above has no end.
        std::os::unix::fs::symlink("..", sandbox.path("films/loop")).unwrap();
        let said = sandbox.run(&["check", "films", "--format", "json"]);
        assert!(said.stdout.contains("films/z.toml") && !said.stdout.contains("loop"), "{}", said.stdout);
    }
}

/// A build reads the file of results: a bad path must not leave it empty, nor hide good films.
#[test]
fn folder_without_layouts_is_an_error_among_the_results() {
    let sandbox = Sandbox::new();
    published(&sandbox, |text| text);
    for folder in ["empty", "others"] {
        std::fs::create_dir_all(sandbox.path(folder)).unwrap();
    }
    sandbox.write("others/Cargo.toml", "[package]\nname = \"film\"\n");
    let (status, json) = report(&sandbox, &["empty", "others", "films"]);
    assert_eq!(status, 2);
    let of = |key: &str| json["layouts"].as_array().unwrap().iter().map(|l| l[key].clone()).collect::<Vec<Value>>();
    assert_eq!(of("file"), ["empty", "others", "films/film.toml"]);
    assert_eq!(of("status"), ["error", "error", "ok"]);
    assert!(of("error")[0].as_str().unwrap().starts_with("empty: no layout in this folder"), "{json}");
    assert_eq!(
        json["skipped"],
        json!([{ "file": "others/Cargo.toml", "reason": "not a layout: it has no key `format`" }])
    );
    assert_eq!(of("expectations")[2].as_array().unwrap().len(), 6);

    let said = sandbox.run(&["check", "empty", "others", "films", "--format", "junit", "-q"]);
    assert_eq!(said.status, 2);
    let xml = roxmltree::Document::parse(&said.stdout).expect("well-formed XML");
    let count = |tag: &'static str| xml.descendants().filter(move |node| node.has_tag_name(tag)).count();
    assert_eq!((count("testsuite"), count("testcase"), count("error"), count("skipped")), (4, 10, 2, 1));
    assert_eq!(xml.root_element().attribute("skipped"), Some("1"));
}

/// A film whose link is broken must not vanish from the build.
#[cfg(unix)]
#[test]
fn link_to_nothing_in_a_folder_is_an_error() {
    let sandbox = Sandbox::new();
    published(&sandbox, |text| text);
    std::os::unix::fs::symlink("gone.toml", sandbox.path("films/a.toml")).unwrap();
    let (status, json) = report(&sandbox, &["films"]);
    assert_eq!(status, 2);
    let first = &json["layouts"][0];
    assert_eq!((&first["file"], &first["status"]), (&json!("films/a.toml"), &json!("error")));
    let message = first["error"].as_str().unwrap();
    assert!(message.starts_with("films/a.toml: cannot follow this symbolic link: No such file"), "{message}");
    assert_eq!(json["layouts"][1]["status"], "ok");
}

//! `report` of two films, and `report --watch`.

use std::fs;

use serde_json::Value;

use crate::report::{FIGURES, assert_links_lead_somewhere, cell_number, cells, texts};
use crate::{Sandbox, shipped};

#[test]
fn two_films_share_a_page_with_their_numbers_and_scales() {
    let sandbox = Sandbox::new();
    let layouts = ["published-film", "designed-displacement"].map(shipped);
    let said = sandbox.run(&["report", &layouts[0], &layouts[1], "-o", "out"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    assert!(said.stdout.contains("report.html: 10 and 8 figures side by side"), "{}", said.stdout);
    let page = sandbox.read("out/report.html");
    for name in FIGURES {
        for prefix in ["first", "second"] {
            assert!(page.contains(&format!("<figure id=\"{prefix}-{name}\">")), "{prefix}-{name}");
            for ending in ["svg", "png", "csv"] {
                assert!(sandbox.path(&format!("out/{prefix}-{name}.{ending}")).is_file(), "{prefix}-{name}.{ending}");
            }
        }
    }
    // All that the page of one film has: verdicts, tables, views, results, source.
    assert_links_lead_somewhere(&page);
    for part in ["verdict", "view", "map", "data", "numbers-json", "sha256"] {
        for prefix in ["first", "second"] {
            assert!(page.contains(&format!(" id=\"{prefix}-{part}\"")), "{prefix}-{part}");
        }
    }
    // Each number is the one of `decouple`, and the third column is the difference.
    let json = |layout: &str| {
        let text = sandbox.run(&["decouple", layout, "--format", "json"]).stdout;
        serde_json::from_str::<Value>(&text).expect("JSON")["uniformity_rmse"]["r_x"].as_f64().expect("a number")
    };
    let expected = [json(&layouts[0]), json(&layouts[1])];
    let cells: Vec<f64> = cells(&page, "uniformity RMSE: R_x").iter().map(|cell| cell_number(cell)).collect();
    assert_eq!(cells.len(), 3);
    for (cell, value) in cells.iter().zip([expected[0], expected[1], expected[1] - expected[0]]) {
        assert!((cell - value).abs() <= 1e-3 * value.abs(), "{cells:?}, not {expected:?}");
    }
    // The same numbers stand on the axes and beside the colours of both films, though their own
    // ranges differ.
    let single = sandbox.run(&["report", &layouts[1], "-o", "single"]);
    assert_eq!(single.status, 0);
    let mut differ = 0;
    for name in FIGURES.into_iter().filter(|name| *name != "layout") {
        let numbers = |path: &str| -> Vec<String> {
            let digits = |text: &String| text.chars().all(|c| c.is_ascii_digit() || ".\u{2212}".contains(c));
            texts(&sandbox.read(path)).into_iter().filter(digits).collect()
        };
        let second = numbers(&format!("out/second-{name}.svg"));
        assert_eq!(numbers(&format!("out/first-{name}.svg")), second, "{name}");
        differ += usize::from(numbers(&format!("single/{name}.svg")) != second);
    }
    assert!(differ >= 3, "{differ} figures have other scales than those of the film alone");

    // Films without an ideal film have their tiles and fields side by side.
    let said = sandbox.run(&["report", &layouts[0], &shipped("single-tile"), "-o", "mixed"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    assert!(said.stdout.contains("single-tile.toml: absent: no comparison"), "{}", said.stdout);
    assert!(sandbox.read("mixed/report.html").contains("<td role=\"cell\">none</td>"));
    sandbox.run(&["report", "a.toml", "b.toml", "c.toml", "-o", "out"]).refuses_arguments("c.toml");
}

/// The layout of one tile of this length.
#[cfg(target_os = "linux")]
fn one_tile(length_mm: &str) -> String {
    format!(
        "format = 1\nname = \"one\"\n[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [{length_mm}, 1, 1]\npolarization_t = [0, 0, 1]\n"
    )
}

/// An editor that replaces the file, a broken layout, a file beside it, and Ctrl-C.
#[cfg(target_os = "linux")]
#[test]
fn watch_draws_anew_when_the_layout_is_saved() {
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;
    use std::sync::mpsc;
    use std::time::Duration;

    let sandbox = Sandbox::new();
    sandbox.write("film.toml", &one_tile("1.5"));
    let mut child = crate::terminal::program(&sandbox, &["report", "film.toml", "-o", "out", "--watch"])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    let (sender, lines) = mpsc::channel();
    let stderr = BufReader::new(child.stderr.take().expect("standard error"));
    std::thread::spawn(move || stderr.lines().map_while(Result::ok).try_for_each(|line| sender.send(line)));
    let next = || lines.recv_timeout(Duration::from_secs(60)).expect("a line on standard error");
    let drawn = |length_mm: &str| {
        let line = next();
        assert_eq!(line, "magsplice: waiting for changes of film.toml; Ctrl-C ends");
        let csv = sandbox.read("out/layout.csv");
        assert!(csv.lines().nth(1).expect("a tile").contains(&format!(",{length_mm},1,1,")), "{length_mm} mm: {csv}");
    };
    drawn("1.5");
    // Written in place.
    sandbox.write("film.toml", &one_tile("2.5"));
    drawn("2.5");
    // Replaced by another file, twice: a watch of the file itself would be lost.
    for length_mm in ["3.5", "4.5"] {
        sandbox.write("film.toml.new", &one_tile(length_mm));
        fs::rename(sandbox.path("film.toml.new"), sandbox.path("film.toml")).unwrap();
        drawn(length_mm);
    }
    // A broken layout tells its faults and keeps the report.
    sandbox.write("film.toml", &one_tile("-1"));
    let fault = next();
    assert!(fault.contains("film.toml") && fault.contains("-1"), "{fault}");
    loop {
        let line = next();
        if line.starts_with("magsplice: waiting") {
            break;
        }
    }
    assert!(sandbox.read("out/layout.csv").contains(",4.5,1,1,"));
    // A file beside it and a saved file without a change draw nothing.
    sandbox.write("other.toml", "");
    sandbox.write("film.toml", &one_tile("-1"));
    assert!(lines.recv_timeout(Duration::from_millis(800)).is_err());
    sandbox.write("film.toml", &one_tile("5.5"));
    drawn("5.5");
    let pid = rustix::process::Pid::from_child(&child);
    rustix::process::kill_process(pid, rustix::process::Signal::INT).expect("it runs");
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    assert_eq!(sandbox.files(), ["film.toml", "other.toml", "out"]);
}

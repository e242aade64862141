//! `design` and `splice`.

use crate::{Bench, shipped};

/// The published film with a design that takes a second.
fn film(design: &str) -> String {
    let text = std::fs::read_to_string(shipped("published-film")).expect("a shipped layout");
    let (before, rest) = text.split_once("[design]").expect("a design");
    let (_, lattice) = rest.split_once("[[lattice]]").expect("a lattice");
    let expectations = before.find("[expect]").expect("expectations");
    format!("{}[design]\n{design}\n[[lattice]]{lattice}", &before[..expectations])
}

const QUICK: &str =
    "vary = [\"cut\"]\nsymmetry = \"four-fold\"\ngoal = \"displacement\"\nsmallest_cut_mm = 0.8\nstarts = 1\n";

#[test]
fn a_film_is_found_that_check_accepts() {
    let bench = Bench::new();
    bench.write("film.toml", &film(QUICK));
    let said = bench.run(&["design", "film.toml", "-o", "better.toml"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    for part in
        ["uniformity RMSE", "RMSE of displacement, mm", "amplitude", "rounded", "5 x finer", "wrote better.toml"]
    {
        assert!(said.stdout.contains(part), "{part:?} is not in {}", said.stdout);
    }
    assert_eq!(said.stderr, "");
    let checked = bench.run(&["check", "better.toml"]);
    assert_eq!((checked.status, checked.stdout.matches("ok ").count()), (0, 7), "{}", checked.stdout);
    let better = bench.read("better.toml");
    assert!(
        better.contains("history = [") && better.contains("magsplice 0.1.0 design: from \"published film\""),
        "{better}"
    );
    assert!(better.contains("[design]") && better.contains("published film, designed"));
    // Found again from itself, with one more line of history.
    let again = bench.run(&["design", "better.toml", "--quiet"]);
    assert_eq!((again.status, again.stderr.as_str()), (0, ""));
    assert_eq!(again.stdout.matches("magsplice 0.1.0 design: from").count(), 2);
    assert_eq!(bench.files(), ["better.toml", "film.toml"]);
}

#[test]
fn as_json() {
    let bench = Bench::new();
    bench.write("film.toml", &film(QUICK));
    let said = bench.run(&["design", "film.toml", "-o", "better.toml", "--format", "json"]);
    let found: serde_json::Value = serde_json::from_str(&said.stdout).expect("JSON");
    let error = |figures: &str| found[figures]["displacement_rmse_mm"][0].as_f64().expect("a number");
    assert!(error("after") < 0.1 * error("before") && error("five_times_finer") < 0.1 * error("before"));
    assert_eq!(found["before"]["points"], 405);
    assert_eq!(found["five_times_finer"]["points"], 41 * 41 * 21);
    assert_eq!(found["short_of"].as_array().map(Vec::len), Some(0));
}

/// Status 1, a film, and what it is short of.
#[test]
fn what_is_out_of_reach_is_a_finding() {
    let bench = Bench::new();
    bench.write("film.toml", &film(&format!("{QUICK}amplitude = {{ min = 5.0 }}")));
    let said = bench.run(&["design", "film.toml", "-o", "better.toml"]);
    assert_eq!(said.status, 1, "{}", said.stderr);
    assert!(
        said.stdout.contains("not reached: amplitude ") && said.stdout.contains(", must be at least 5"),
        "{}",
        said.stdout
    );
    assert_eq!(bench.run(&["check", "better.toml"]).status, 0);
}

#[test]
fn what_cannot_be_designed_is_refused_and_nothing_written() {
    let bench = Bench::new();
    bench.write("better.toml", "earlier");
    bench.write("film.toml", &film("vary = []"));
    bench
        .run(&["design", "film.toml", "-o", "better.toml"])
        .refuses("design: vary = [], must name at least one of size, position, cut");
    let wrong = "vary = [\"cut\", \"size\", \"strength\"]\ngap_mm = -1.0\nparts = 0\nstarts = 0\nweights = { r_x = 0.0, r_y = 0.0, s_z = 0.0 }";
    bench.write("film.toml", &film(wrong));
    let said = bench.run(&["design", "film.toml", "-o", "better.toml"]);
    said.refuses("vary names cut, which moves all faces on a line together, and size or position");
    // All at once.
    for message in ["gap_mm = -1,", "parts = 0,", "starts = 0,", "weights are all 0", "so strength_t = "] {
        assert!(said.stderr.contains(message), "{message:?} is not in {}", said.stderr);
    }
    bench.write("film.toml", &film("vary = [\"size\"]\nsmallest_cut_mm = 4.0\nstarts = 1"));
    bench.run(&["design", "film.toml", "-o", "better.toml"]).refuses("a side must be at least 4 mm");
    bench.run(&["design", &shipped("single-tile"), "-o", "better.toml"]).refuses("no [design] table");
    bench.write("film.toml", &film(QUICK));
    bench.run(&["design", "film.toml", "-o", "film.toml"]).refuses("it is the input, which would be lost");
    bench.run(&["design", "film.toml", "--front"]).refuses("--front writes a folder: name one with -o DIR");
    bench.run(&["design", "film.toml", "--amplitudes", "0.5"]).refuses_arguments("--front");
    assert_eq!(bench.read("better.toml"), "earlier");
    assert_eq!(bench.files(), ["better.toml", "film.toml"]);
}

#[test]
fn the_trade_as_tables_figures_and_films() {
    let bench = Bench::new();
    bench.write("film.toml", &film(QUICK));
    let said = bench.run(&["design", "film.toml", "--front", "--amplitudes", "0.6,0.8,5", "-o", "front"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    assert!(said.stdout.contains("at least 0.6") && said.stdout.contains("at least 0.8"), "{}", said.stdout);
    assert!(!said.stdout.contains("at least 5") && said.stderr.contains("no film with an amplitude of 5 was found"));
    let front: serde_json::Value = serde_json::from_str(&bench.read("front/front.json")).expect("JSON");
    let films = front["films"].as_array().expect("films");
    assert_eq!(films.len(), 2);
    for film in films {
        let file = format!("front/{}", film["file"].as_str().expect("a name"));
        assert_eq!(bench.run(&["check", &file]).status, 0);
    }
    if cfg!(feature = "report") {
        assert!(bench.read("front/front-amplitude.svg").contains("<svg"));
    }
    // Replaced, but only if it is a front.
    assert_eq!(bench.run(&["design", "film.toml", "--front", "--amplitudes", "0.6", "-o", "front"]).status, 0);
    bench.write("front/notes.txt", "mine");
    bench.run(&["design", "film.toml", "--front", "--amplitudes", "0.6", "-o", "front"]).refuses("it holds notes.txt");
}

#[test]
fn a_film_from_nothing() {
    let bench = Bench::new();
    let said = bench.run(&["splice", "--wavelength", "6", "--film", "12x12", "--starts", "1", "-o", "film.toml"]);
    assert_eq!(said.status, 0, "{}{}", said.stdout, said.stderr);
    let checked = bench.run(&["check", "film.toml"]);
    assert_eq!(checked.status, 0, "{}", checked.stdout);
    let found = bench.run(&["decouple", "film.toml", "--format", "json"]);
    let found: serde_json::Value = serde_json::from_str(&found.stdout).expect("JSON");
    assert!(found["displacement_rmse_mm"]["x"].as_f64().expect("a number") < 0.002, "{found}");
    bench
        .run(&["splice", "--wavelength", "6", "--film", "3x12"])
        .refuses("film: 3 mm along x, must be at least 5.0000 mm");
    bench.run(&["splice", "--wavelength", "6", "--film", "12"]).refuses_arguments("two numbers with an x between them");
}

/// The first Ctrl-C ends the search, not the program.
#[cfg(unix)]
#[test]
fn an_interrupted_search_writes_its_best() {
    let bench = Bench::new();
    bench.write(
        "film.toml",
        &film("vary = [\"size\", \"position\", \"direction\"]\nsmallest_cut_mm = 0.8\nstarts = 10000\n"),
    );
    let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_magsplice"))
        .args(["design", "film.toml", "-o", "better.toml"])
        .current_dir(bench.path("."))
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("it starts");
    // Ten thousand starts of 280 free numbers take hours; that the file beside the result is there says that the search has begun.
    while bench.files().len() < 2 {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    std::thread::sleep(std::time::Duration::from_millis(1500));
    let killed =
        std::process::Command::new("kill").args(["-INT", &program.id().to_string()]).status().expect("kill runs");
    assert!(killed.success());
    assert_eq!(program.wait().expect("it ends").code(), Some(0));
    let mut said = String::new();
    std::io::Read::read_to_string(&mut program.stderr.take().expect("a pipe"), &mut said).expect("UTF-8");
    assert!(said.contains("interrupted: this is the best film found until then"), "{said}");
    assert_eq!(bench.run(&["check", "better.toml"]).status, 0);
    assert_eq!(bench.files(), ["better.toml", "film.toml"]);
}

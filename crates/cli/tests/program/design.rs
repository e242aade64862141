//! `design` and `design --front`.

use crate::{Sandbox, shipped};

/// The published film with this [design] table, without its expectations.
fn film(design: &str) -> String {
    let text = std::fs::read_to_string(shipped("published-film")).expect("a shipped layout");
    let (before, rest) = text.split_once("[design]").expect("a design");
    let (_, lattice) = rest.split_once("[[lattice]]").expect("a lattice");
    let expectations = before.find("[expect]").expect("expectations");
    format!("{}[design]\n{design}\n[[lattice]]{lattice}", &before[..expectations])
}

/// A design that takes about a second.
const QUICK: &str =
    "vary = [\"cut\"]\nsymmetry = \"four-fold\"\ngoal = \"displacement\"\nsmallest_cut_mm = 0.8\nstarts = 1\n";

#[test]
fn designed_film_passes_check() {
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", &film(&QUICK.replace("starts = 1", "starts = 1  # quick")));
    let said = sandbox.run(&["design", "film.toml", "-o", "better.toml"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    for part in ["uniformity RMSE", "RMSE of displacement, mm", "amplitude", "5 x finer", "wrote better.toml"] {
        assert!(said.stdout.contains(part), "{part:?} is not in {}", said.stdout);
    }
    // A slow machine gets an estimate of the time.
    let is_estimate = |line: &str| line.contains("estimated from the first step");
    assert!(said.stderr.lines().all(is_estimate), "{}", said.stderr);
    let checked = sandbox.run(&["check", "better.toml"]);
    assert_eq!((checked.status, checked.stdout.matches("ok ").count()), (0, 7), "{}", checked.stdout);
    let better = sandbox.read("better.toml");
    assert!(
        better.contains("starts = 1  # quick") && better.contains("# The film of Dai et al."),
        "comments stay: {better}"
    );
    assert!(
        better.contains("history = [") && better.contains("magsplice 0.1.0 design: from \"published film\""),
        "{better}"
    );
    assert!(better.contains("[design]") && better.contains("published film, designed"));
    // A design of the designed film adds a line of history.
    let again = sandbox.run(&["design", "better.toml", "--quiet"]);
    assert_eq!((again.status, again.stderr.as_str()), (0, ""));
    assert_eq!(again.stdout.matches("magsplice 0.1.0 design: from").count(), 2);
    assert_eq!(sandbox.files(), ["better.toml", "film.toml"]);
}

#[test]
fn design_as_json() {
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", &film(QUICK));
    let said = sandbox.run(&["design", "film.toml", "-o", "better.toml", "--format", "json"]);
    let found: serde_json::Value = serde_json::from_str(&said.stdout).expect("JSON");
    let error = |figures: &str| found[figures]["displacement_rmse_mm"]["x"].as_f64().expect("a number");
    assert!(error("after") < 0.1 * error("before") && error("five_times_finer") < 0.1 * error("before"));
    assert_eq!(found["before"]["points"], 405);
    assert_eq!(found["five_times_finer"]["points"], 41 * 41 * 21);
    assert_eq!(found["short_of"].as_array().map(Vec::len), Some(0));
}

/// The film is found for its errors, sampled beside the film before, and written with what it
/// reached.
#[test]
fn design_under_tolerance_states_the_films_that_are_made() {
    let sandbox = Sandbox::new();
    let robust = format!("{QUICK}under = \"tolerance\"\n[tolerance]\npreset = \"workshop\"\nsamples = 300\n");
    sandbox.write("film.toml", &film(&robust));
    let said = sandbox.run(&["design", "film.toml", "-o", "better.toml"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    let of_made = said.stdout.split("RMSE of displacement of films as made, mm; 300 samples, seed 1").nth(1);
    let of_made = of_made.unwrap_or_else(|| panic!("{}", said.stdout));
    let row = |name: &str| -> Vec<f64> {
        let line = of_made.lines().find_map(|line| line.trim().strip_prefix(name));
        line.unwrap_or_else(|| panic!("{name:?} is not in {of_made}"))
            .split_whitespace()
            .map(|number| number.parse().expect("a number"))
            .collect()
    };
    let (before, after) = (row("before, P95"), row("after, P95"));
    for axis in 0..3 {
        assert!(after[axis] < 0.2 * before[axis], "{before:?} {after:?}");
    }
    for name in ["mean", "P50", "P99"] {
        assert_eq!(row(&format!("after, {name}")).len(), 3);
    }
    let checked = sandbox.run(&["check", "better.toml"]);
    assert_eq!(checked.status, 0, "{}", checked.stdout);
    assert!(sandbox.read("better.toml").contains("[expect.made.displacement_rmse_mm]"));
    // The samples are those of `tolerance`. The file of the film found has its tiles in another
    // order, so that each gets other errors.
    let json = |arguments: &[&str]| -> serde_json::Value {
        serde_json::from_str(&sandbox.run(arguments).stdout).expect("JSON")
    };
    let made = json(&["design", "film.toml", "-o", "again.toml", "--format", "json"])["made"].clone();
    assert_eq!((&made["samples"], &made["seed"]), (&300.into(), &1.into()));
    for (file, errors, within) in [("film.toml", &made["before"], 1e-9), ("better.toml", &made["after"], 0.12)] {
        let sampled = json(&["tolerance", file, "--format", "json"]);
        for (axis, name) in ["x", "y", "z"].into_iter().flat_map(|axis| ["mean", "p50", "p95"].map(|name| (axis, name)))
        {
            let figure = |of: &serde_json::Value| of["displacement_rmse_mm"][axis][name]["value"].as_f64();
            let [a, b] = [&sampled, errors].map(|of| figure(of).expect("a number"));
            assert!((a / b - 1.0).abs() < within, "{file}, {axis}, {name}: {a} and {b}");
        }
    }
    sandbox.write("film.toml", &film(&format!("{QUICK}under = \"tolerance\"")));
    sandbox.run(&["design", "film.toml", "-o", "no.toml"]).refuses("under = \"tolerance\" needs the table [tolerance]");
    sandbox.write("film.toml", &film(&robust.replace("displacement", "uniformity")));
    let said = sandbox.run(&["design", "film.toml", "-o", "no.toml"]);
    said.refuses("goal = \"uniformity\" with under = \"tolerance\", must be \"displacement\"");
}

#[test]
fn missed_amplitude_exits_with_1() {
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", &film(&format!("{QUICK}amplitude = {{ min = 5.0 }}")));
    let said = sandbox.run(&["design", "film.toml", "-o", "better.toml"]);
    assert_eq!(said.status, 1, "{}", said.stderr);
    assert!(
        said.stdout.contains("not reached: amplitude ") && said.stdout.contains(", must be at least 5"),
        "{}",
        said.stdout
    );
    assert_eq!(sandbox.run(&["check", "better.toml"]).status, 0);
}

#[test]
fn impossible_designs_are_refused_and_nothing_is_written() {
    let sandbox = Sandbox::new();
    sandbox.write("better.toml", "earlier");
    sandbox.write("film.toml", &film("vary = []"));
    sandbox
        .run(&["design", "film.toml", "-o", "better.toml"])
        .refuses("design: vary = [], must have at least one of size, position, cut");
    let wrong = "vary = [\"cut\", \"size\", \"strength\"]\ngap_mm = -1.0\nparts = 0\nstarts = 0\nweights = { r_x = 0.0, r_y = 0.0, s_z = 0.0 }";
    sandbox.write("film.toml", &film(wrong));
    let said = sandbox.run(&["design", "film.toml", "-o", "better.toml"]);
    said.refuses("vary has cut, which moves all faces on a line together, and size or position");
    // All problems in one message.
    for message in ["gap_mm = -1,", "parts = 0,", "starts = 0,", "weights are all 0", "so strength_t = "] {
        assert!(said.stderr.contains(message), "{message:?} is not in {}", said.stderr);
    }
    sandbox.write("film.toml", &film("vary = [\"size\"]\nsmallest_cut_mm = 4.0\nstarts = 1"));
    sandbox.run(&["design", "film.toml", "-o", "better.toml"]).refuses("a side must be at least 4 mm");
    sandbox.run(&["design", &shipped("single-tile"), "-o", "better.toml"]).refuses(
        "no [design] table, which design needs: add one, at the least the line `design = { vary = [\"size\", \"position\", \
         \"direction\"] }` below the name",
    );
    sandbox.write("film.toml", &film(QUICK));
    sandbox.run(&["design", "film.toml", "-o", "film.toml"]).refuses("it is an input, which would be lost");
    sandbox.run(&["design", "film.toml", "--front"]).refuses("--front writes a folder: give one with -o DIR");
    sandbox.run(&["design", "film.toml", "--amplitudes", "0.5"]).refuses_arguments("--front");
    assert_eq!(sandbox.read("better.toml"), "earlier");
    assert_eq!(sandbox.files(), ["better.toml", "film.toml"]);
}

#[test]
fn a_film_beside_the_centre_has_no_symmetry() {
    let sandbox = Sandbox::new();
    let lattice = film("vary = [\"direction\"]\nsymmetry = \"four-fold\"\nstarts = 1");
    let moved = lattice.replace("start_mm = [-10.0,", "start_mm = [-10.2,");
    assert_ne!(lattice, moved);
    sandbox.write("film.toml", &moved);
    let said = sandbox.run(&["design", "film.toml", "-o", "better.toml"]);
    said.refuses(
        "the film spans x = -10.2 .. 9.8 mm, which is not centred on 0: tiles without an image under the symmetry",
    );
}

#[test]
fn the_shortest_design_table_works() {
    let sandbox = Sandbox::new();
    let text = film("").replace("[design]\n", "");
    let (head, tables) = text.split_at(text.find("\n[").expect("a table") + 1);
    sandbox
        .write("film.toml", &format!("{head}design = {{ vary = [\"size\", \"position\", \"direction\"] }}\n{tables}"));
    assert_eq!(sandbox.run(&["check", "film.toml"]).status, 0);
}

#[test]
fn front_writes_tables_figures_and_layouts() {
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", &film(QUICK));
    let said = sandbox.run(&["design", "film.toml", "--front", "--amplitudes", "0.6,0.8,5", "-o", "front"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    assert!(said.stdout.contains("at least 0.6") && said.stdout.contains("at least 0.8"), "{}", said.stdout);
    assert!(!said.stdout.contains("at least 5") && said.stderr.contains("no film with an amplitude of 5 was found"));
    let front: serde_json::Value = serde_json::from_str(&sandbox.read("front/front.json")).expect("JSON");
    let films = front["films"].as_array().expect("films");
    assert_eq!(films.len(), 2);
    for film in films {
        let file = format!("front/{}", film["file"].as_str().expect("a name"));
        assert_eq!(sandbox.run(&["check", &file]).status, 0);
    }
    if cfg!(feature = "report") {
        assert!(sandbox.read("front/front-amplitude.svg").contains("<svg"));
    }
    // The folder is replaced while its files are as they were written.
    let again = |layout: &str| sandbox.run(&["design", layout, "--front", "--amplitudes", "0.6", "-o", "front"]);
    assert_eq!(again("film.toml").status, 0);
    again("front/amplitude-0.6.toml").refuses("it holds front/amplitude-0.6.toml, an input, which would be lost");
    let found = sandbox.read("front/amplitude-0.6.toml");
    sandbox.write("front/amplitude-0.6.toml", &format!("{found}\n# mine"));
    again("film.toml").refuses("it holds amplitude-0.6.toml, which has been changed since this command wrote it");
    sandbox.write("front/amplitude-0.6.toml", &found);
    sandbox.write("front/amplitude-0.7.toml", "mine");
    again("film.toml").refuses("it holds amplitude-0.7.toml, which this command did not write");
    assert_eq!(sandbox.read("front/amplitude-0.7.toml"), "mine");
}

/// A film that is better as ordered, and worse as made and in amplitude, is on the front of films
/// as ordered only.
#[test]
fn front_of_films_that_are_made_has_their_percentiles() {
    let sandbox = Sandbox::new();
    let robust = format!("{QUICK}under = \"tolerance\"\n[tolerance]\npreset = \"workshop\"\nsamples = 100\n");
    sandbox.write("film.toml", &film(&robust));
    let said = sandbox.run(&["design", "film.toml", "--front", "--amplitudes", "0.6,0.8", "-o", "front"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    assert!(said.stdout.contains("films made: displacement, P95"), "{}", said.stdout);
    let front: serde_json::Value = serde_json::from_str(&sandbox.read("front/front.json")).expect("JSON");
    let films = front["films"].as_array().expect("films");
    for film in films {
        let p95 = film["made"]["after"]["displacement_rmse_mm"]["x"]["p95"]["value"].as_f64().expect("a number");
        let row = said.stdout.lines().find(|line| line.contains(&format!("{p95:.6}")));
        assert!(row.is_some(), "{p95} is not in {}", said.stdout);
        // Errors of manufacture are larger than those of the film as ordered.
        let ordered = film["after"]["displacement_rmse_mm"]["x"].as_f64().expect("a number");
        assert!(p95 > ordered, "{film}");
        let layout = sandbox.read(&format!("front/{}", film["file"].as_str().expect("a name")));
        assert!(layout.contains(&format!("as made P95 {p95:.3e}")), "{layout}");
        // The columns of the figure.
        if cfg!(feature = "report") {
            let table = sandbox.read("front/front-amplitude.csv");
            assert!(table.starts_with("amplitude,") && table.contains(",made_p95_displacement_rmse_x_mm,"), "{table}");
            assert!(table.contains(&p95.to_string()), "{table}");
        }
    }
    let merits = |film: &serde_json::Value| {
        let axes =
            ["x", "y", "z"].map(|axis| film["made"]["after"]["displacement_rmse_mm"][axis]["p95"]["value"].as_f64());
        let squares: f64 = axes.iter().map(|axis| axis.expect("a number").powi(2)).sum();
        (squares, film["after"]["amplitude"].as_f64().expect("a number"))
    };
    for (index, one) in films.iter().enumerate() {
        for other in films.iter().skip(index + 1) {
            let ((a, b), (c, d)) = (merits(one), merits(other));
            assert!((a < c) == (b < d), "{:?} and {:?}", (a, b), (c, d));
        }
    }
}

#[test]
fn front_deletes_neither_its_input_nor_files_with_the_names_of_a_front() {
    let sandbox = Sandbox::new();
    for name in ["amplitude-mine.toml", "parts-of-my-film.toml", "front.json", "front-of-house.png"] {
        std::fs::create_dir(sandbox.path("films")).unwrap();
        sandbox.write(&format!("films/{name}"), &film(QUICK));
        sandbox.write("film.toml", &film(QUICK));
        let front = |layout: &str, folder: &str| {
            sandbox.run(&["design", layout, "--front", "--amplitudes", "0.6", "-o", folder])
        };
        front("film.toml", "films").refuses(&format!("it holds {name}, which this command did not write"));
        front(&format!("./films/{name}"), "films/.").refuses("an input, which would be lost: choose another folder");
        assert_eq!(sandbox.read(&format!("films/{name}")), film(QUICK));
        std::fs::remove_dir_all(sandbox.path("films")).unwrap();
    }
}

/// The first Ctrl-C ends the search, and the program writes its result. Before, a search that is
/// not on a terminal says how long it takes, and every ten seconds how far it is.
#[cfg(unix)]
#[test]
fn long_search_is_announced_and_logged_and_interrupted_with_its_best_film() {
    let sandbox = Sandbox::new();
    let mut program = long_search(&sandbox);
    let mut said = String::new();
    let mut lines = std::io::BufReader::new(program.stderr.take().expect("a pipe"));
    let begun = std::time::Instant::now();
    while !said.contains(" s: ") {
        let length = std::io::BufRead::read_line(&mut lines, &mut said).expect("UTF-8");
        assert!(length > 0, "the search ended: {said}");
    }
    assert!(begun.elapsed() >= std::time::Duration::from_secs(9), "{said}");
    let announced = "56 tiles, 280 free parameters, 10000 starts: about ";
    assert!(said.starts_with(&format!("magsplice: {announced}")), "{said}");
    assert!(said.contains(", estimated from the first step, which took "), "{said}");
    assert!(
        said.contains("best error ") && said.contains("searching: ") && said.contains(" of 10000 starts"),
        "{said}"
    );
    send_interrupt(&program);
    assert_eq!(program.wait().expect("it ends").code(), Some(130));
    std::io::Read::read_to_string(&mut lines, &mut said).expect("UTF-8");
    assert!(said.contains("interrupted: this is the best film found so far"), "{said}");
    assert_eq!(sandbox.run(&["check", "better.toml"]).status, 0);
    assert!(sandbox.read("better.toml").contains("; interrupted, the best film found until then"));
    assert_eq!(sandbox.files(), ["better.toml", "film.toml"]);
}

/// The second Ctrl-C ends the program at once, and nothing is written.
#[cfg(unix)]
#[test]
fn second_interruption_ends_at_once_without_a_file() {
    let sandbox = Sandbox::new();
    let mut program = long_search(&sandbox);
    // The temporary file appears when the search begins.
    while sandbox.files().len() < 2 {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    std::thread::sleep(std::time::Duration::from_millis(500));
    // A second signal that comes before the handler has seen the first is lost.
    while program.try_wait().expect("it runs").is_none() {
        send_interrupt(&program);
        std::thread::sleep(std::time::Duration::from_millis(3));
    }
    assert_eq!(program.wait().expect("it ends").code(), Some(130));
    assert_eq!(sandbox.files(), ["film.toml"]);
}

/// A search of ten thousand starts with 280 free parameters, which takes hours.
#[cfg(unix)]
fn long_search(sandbox: &Sandbox) -> std::process::Child {
    let design = "vary = [\"size\", \"position\", \"direction\"]\nsmallest_cut_mm = 0.8\nstarts = 10000\n";
    sandbox.write("film.toml", &film(design));
    std::process::Command::new(env!("CARGO_BIN_EXE_magsplice"))
        .args(["design", "film.toml", "-o", "better.toml"])
        .current_dir(sandbox.path("."))
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("it starts")
}

#[cfg(unix)]
fn send_interrupt(program: &std::process::Child) {
    let sent = std::process::Command::new("kill").args(["-INT", &program.id().to_string()]).status();
    assert!(sent.expect("kill runs").success());
}

#[test]
fn design_warns_if_the_field_leaves_the_range_of_the_sensor() {
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", &film(QUICK).replace("part = \"MLX90393\"", "range_mt = 5"));
    let said = sandbox.run(&["design", "film.toml", "-o", "better.toml"]);
    assert!(said.stdout.contains("\nwarning: the field leaves the range of the sensor at "), "{}", said.stdout);
}

//! `tolerance`: samples of films as made, their parts, and runs that are continued.

use std::fs;
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use crate::{Sandbox, shipped};

/// The published film with errors of its tiles, as `film.toml`.
fn film(sandbox: &Sandbox, tolerance: &str) {
    let text = fs::read_to_string(shipped("published-film")).expect("readable");
    sandbox.write("film.toml", &format!("{text}\n[tolerance]\n{tolerance}\n"));
}

const WORKSHOP: &str = "preset = \"workshop\"";

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

/// The mean of the uniformity RMSE with 0.05 mm in x and y is known to be 0.0646, 0.0646 and 0.041.
/// Of 400 samples it is known to four deviations of 0.0013 over the root of 400, and to the
/// rounding.
#[test]
fn tolerance_gives_the_known_errors_of_the_published_film() {
    let sandbox = Sandbox::new();
    film(&sandbox, "position_mm = [0.05, 0.05, 0]");
    let said = sandbox.run(&["tolerance", "film.toml", "--samples", "400", "--format", "json"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let result = json(&said.stdout);
    assert_eq!((result["count"].as_u64(), result["seed"].as_u64()), (Some(400), Some(1)));
    for (name, known) in [("r_x", 0.0646), ("r_y", 0.0646), ("s_z", 0.041)] {
        let statistics = &result["uniformity_rmse"][name];
        let number = |key: &str| statistics[key]["value"].as_f64().expect("a number");
        assert!((number("mean") - known).abs() < 3e-4 + 5e-4, "{name}: {statistics}");
        assert!(number("p1") < number("p5") && number("p5") < number("p50") && number("p50") < number("p95"));
        assert!(number("p95") < number("p99"), "{statistics}");
    }
    for axis in ["x", "y", "z"] {
        let p95 = &result["displacement_rmse_mm"][axis]["p95"];
        let [low, value, high] =
            [&p95["interval"][0], &p95["value"], &p95["interval"][1]].map(serde_json::Value::as_f64);
        assert!(low < value && value < high && low.is_some(), "{axis}: {p95}");
    }
    let text = sandbox.run(&["tolerance", "film.toml", "--samples", "400"]).stdout;
    assert!(text.contains("400 samples, seed 1") && text.contains("errors of position 0.05, 0.05, 0 mm"), "{text}");
    let row = text.lines().find(|line| line.starts_with("uniformity RMSE of R_x")).expect("a row");
    assert!(row.contains(" 0.0629 "), "{row}");
    assert!(text.lines().all(|line| line.len() <= 100), "{text}");
}

#[test]
fn parts_are_merged_to_the_bits_of_one_run() {
    let sandbox = Sandbox::new();
    film(&sandbox, WORKSHOP);
    let run = |arguments: &[&str]| {
        let said = sandbox.run(&[&["tolerance"], arguments, &["--format", "json"]].concat());
        assert_eq!((said.status, said.stderr.as_str()), (0, ""), "{arguments:?}");
        said.stdout
    };
    let whole = run(&["film.toml", "--samples", "50", "--save", "whole.csv", "--threads", "1"]);
    for (first, count, name) in [("0", "17", "a.csv"), ("17", "3", "b.csv"), ("20", "30", "c.csv")] {
        run(&["film.toml", "--samples", "50", "--first", first, "--count", count, "--save", name]);
    }
    let merged = run(&["merge", "film.toml", "c.csv", "a.csv", "b.csv", "--save", "merged.csv"]);
    assert_eq!(merged, whole);
    assert_eq!(sandbox.read("merged.csv"), sandbox.read("whole.csv"));
    run(&["merge", "film.toml", "whole.csv", "--save", "merged.npz"]);
    run(&["film.toml", "--samples", "50", "--save", "whole.npz"]);
    assert_eq!(fs::read(sandbox.path("merged.npz")).ok(), fs::read(sandbox.path("whole.npz")).ok());
    // A part tells its own statistics.
    let part = json(&run(&["merge", "film.toml", "b.csv"]));
    assert_eq!((part["first"].as_u64(), part["count"].as_u64()), (Some(17), Some(3)));
    assert!(!sandbox.files().iter().any(|name| name.ends_with(".partial")), "{:?}", sandbox.files());

    let merge = |parts: &[&str]| sandbox.run(&[&["tolerance", "merge", "film.toml"], parts].concat());
    merge(&["a.csv", "c.csv"]).refuses("c.csv: begins with sample 20: samples 17 to 19 are in no part");
    merge(&["a.csv", "b.csv", "a.csv"]).refuses("a.csv: begins with sample 0, which another part has too");
    run(&["film.toml", "--samples", "50", "--first", "17", "--count", "3", "--seed", "2", "--save", "d.csv"]);
    merge(&["a.csv", "d.csv"]).refuses("d.csv: has seed 2, another part has seed 1");
    merge(&["film.toml"]).refuses("film.toml: is not a file of samples");
    sandbox.write("cut.csv", sandbox.read("c.csv").trim_end());
    merge(&["cut.csv"]).refuses("cut.csv: has 29 of its 30 samples: its run has not ended");
    let swapped = sandbox.read("b.csv").replace("\n18,", "\n19,");
    sandbox.write("earlier.csv", &sandbox.read("b.csv").replacen("tolerance 2:", "tolerance:", 1));
    merge(&["earlier.csv"]).refuses("earlier.csv: is of an earlier version of magsplice");
    sandbox.write("swapped.csv", &swapped);
    merge(&["swapped.csv"]).refuses("swapped.csv: line 4: sample 19, must be sample 18");
    film(&sandbox, "preset = \"jig\"");
    merge(&["a.csv"])
        .refuses("a.csv: its samples have another film, other errors or other options of --sorted than film.toml");
}

#[test]
fn a_run_killed_twenty_times_gives_the_bytes_of_one_never_killed() {
    let sandbox = Sandbox::new();
    film(&sandbox, WORKSHOP);
    let arguments = ["tolerance", "film.toml", "--samples", "3000", "--format", "json", "--save"];
    let whole = sandbox.run(&[&arguments[..], &["whole.csv"]].concat());
    assert_eq!(whole.status, 0, "{}", whole.stderr);
    let killed = [&arguments[..], &["killed.csv", "--resume"]].concat();
    let (mut kills, mut random) = (0, 1_u64);
    for _ in 0..20 {
        let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_magsplice"));
        program.args(&killed).current_dir(sandbox.path(""));
        let mut child = program.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it starts");
        // Times of 0 to 63 ms, in an order without a pattern.
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        sleep(Duration::from_millis(random >> 58));
        // SIGKILL on Unix.
        kills += u32::from(child.kill().is_ok() && !child.wait().expect("it ends").success());
    }
    assert!(kills >= 5, "the program ended by itself in {} of 20 runs", 20 - kills);
    let last = sandbox.run(&killed);
    assert_eq!((last.status, &last.stdout), (0, &whole.stdout), "{}", last.stderr);
    assert_eq!(sandbox.read("killed.csv"), sandbox.read("whole.csv"));
    let partial = |name: &String| name.ends_with(".partial");
    assert!(!sandbox.files().iter().any(partial), "{:?}", sandbox.files());
}

#[test]
fn an_interrupted_run_tells_its_result_and_is_continued_only_on_request() {
    let sandbox = Sandbox::new();
    film(&sandbox, WORKSHOP);
    let run = |arguments: &[&str]| sandbox.run(&[&["tolerance", "film.toml"], arguments].concat());
    assert_eq!(run(&["--samples", "40", "--save", "whole.csv"]).status, 0);
    let whole = sandbox.read("whole.csv");
    // What a run leaves that was killed while it wrote sample 20.
    let until = whole.find("\n20,").expect("sample 20") + 5;
    let left = |text: &str| sandbox.write("s.csv.partial", text);
    left(&whole[..until]);
    run(&["--samples", "40", "--save", "s.csv"])
        .refuses("s.csv.partial: holds 20 samples of an earlier run: give --resume to continue it, or remove the file");
    run(&["--samples", "50", "--save", "s.csv", "--resume"])
        .refuses("s.csv.partial: is of another run: it has seed 1, first 0, count 40");
    run(&["--samples", "40", "--seed", "3", "--save", "s.csv", "--resume"]).refuses("is of another run");
    let said = run(&["--samples", "40", "--save", "s.csv", "--resume"]);
    assert_eq!((said.status, sandbox.read("s.csv")), (0, whole.clone()), "{}", said.stderr);
    // Killed before its first line was whole; and somebody's file of the same name.
    left("# magsplice tol");
    assert_eq!(run(&["--samples", "40", "--save", "s.csv"]).status, 0);
    left("my notes\n");
    run(&["--samples", "40", "--save", "s.csv", "--resume"]).refuses("s.csv.partial: is not a file of samples");
    assert_eq!(sandbox.read("s.csv.partial"), "my notes\n");
    run(&["--resume"]).refuses_arguments("--save");
}

#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_gives_the_result_so_far() {
    let sandbox = Sandbox::new();
    film(&sandbox, WORKSHOP);
    let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_magsplice"));
    program.args(["tolerance", "film.toml", "--samples", "1000000", "--format", "json", "--save", "s.csv"]);
    program.current_dir(sandbox.path("")).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = program.spawn().expect("it starts");
    let partial = sandbox.path("s.csv.partial");
    while fs::metadata(&partial).map_or(0, |file| file.len()) < 1000 {
        sleep(Duration::from_millis(5));
    }
    let sent = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.expect("kill runs").success());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(130));
    let count = json(&String::from_utf8_lossy(&output.stdout))["count"].as_u64().expect("a count");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        told.contains(&format!("interrupted after {count} of 1000000 samples, which are kept in s.csv.partial")),
        "{told}"
    );
    assert_eq!(sandbox.read("s.csv.partial").lines().count() as u64, count + 2);
    assert!(!sandbox.files().contains(&"s.csv".to_owned()));
}

#[test]
fn tolerance_says_what_it_needs() {
    let sandbox = Sandbox::new();
    let bare = sandbox.run(&["tolerance", &shipped("published-film")]);
    bare.refuses("the layout has no [tolerance] table with the errors of films as made");
    film(&sandbox, WORKSHOP);
    let run = |arguments: &[&str]| sandbox.run(&[&["tolerance", "film.toml"], arguments].concat());
    run(&["--samples", "10", "--first", "10"]).refuses("--first 10 is beyond the last sample, of 10 samples");
    run(&["--samples", "10", "--first", "5", "--count", "6"]).refuses("ends beyond the last sample");
    run(&["--samples", "0"]).refuses_arguments("must be a whole number from 1 to 10000000");
    run(&["--save", "s.txt"]).refuses("s.txt: no format has the ending .txt");
    run(&["--save", "film.toml"]).refuses("film.toml: no format has the ending .toml");
    film(&sandbox, "size_mm = { normal = 0.3 }");
    let said = run(&["--samples", "2000"]);
    said.refuses("a tile with these errors is invalid");
    assert!(said.stderr.contains("film.toml: sample "), "{}", said.stderr);
}

/// The preset takes the place of the whole table, of its groups too.
#[test]
fn preset_stands_for_the_table_of_the_layout() {
    let sandbox = Sandbox::new();
    let result = |arguments: &[&str]| {
        let said = sandbox.run(&[arguments, &["--format", "json", "--samples", "40"]].concat());
        assert_eq!(said.status, 0, "{}", said.stderr);
        let mut result = json(&said.stdout);
        // The hash is that of the file.
        result["sha256"].take();
        result
    };
    for verb in ["tolerance", "budget"] {
        film(&sandbox, "preset = \"jig\"");
        let by_table = result(&[verb, "film.toml"]);
        assert_eq!(result(&[verb, &shipped("published-film"), "--preset", "jig"]), by_table);
        film(&sandbox, "preset = \"by-hand\"\nsamples = 40\n[[tolerance.group]]\ntiles = [\"*\"]\nposition_mm = 0.1");
        assert_eq!(result(&[verb, "film.toml", "--preset", "jig"]), by_table);
        assert_ne!(result(&[verb, "film.toml"]), by_table);
    }
    let part = |options: &[&str]| {
        let said = sandbox.run(&[&["tolerance", "film.toml", "--samples", "40", "--save"], options].concat());
        assert_eq!(said.status, 0, "{}", said.stderr);
    };
    part(&["a.csv", "--preset", "jig", "--count", "30"]);
    part(&["b.csv", "--preset", "jig", "--first", "30"]);
    let merged = sandbox.run(&["tolerance", "merge", "film.toml", "a.csv", "b.csv", "--preset", "jig"]);
    assert_eq!(merged.status, 0, "{}", merged.stderr);
    let other = sandbox.run(&["tolerance", "merge", "film.toml", "a.csv", "b.csv"]);
    other.refuses("its samples have another film, other errors or other options of --sorted than film.toml");
}

/// Tiles that touch overlap as made. With a gap of six deviations of their distance they do not.
#[test]
fn overlaps_of_films_as_made_are_stated() {
    let sandbox = Sandbox::new();
    film(&sandbox, "position_mm = 0.02");
    let run =
        |options: &[&str]| sandbox.run(&[&["tolerance", "film.toml", "--samples", "30"], options].concat()).stdout;
    let depth_mm = json(&run(&["--format", "json"]))["overlap_mm"].as_f64().expect("a number");
    assert!(depth_mm > 0.02 && depth_mm < 0.02 * 2_f64.sqrt() * 6.0, "{depth_mm}");
    let text = run(&[]);
    assert!(text.contains(&format!("overlap by up to {depth_mm:.2} mm")), "{text}");
    film(&sandbox, "position_mm = 1e-12");
    assert_eq!(json(&run(&["--format", "json"]))["overlap_mm"], 0.0);
}

/// A bound at the median of x is kept by half of the films, whatever the others.
#[test]
fn yield_counts_the_films_that_keep_the_bounds_of_made_films() {
    let sandbox = Sandbox::new();
    film(&sandbox, WORKSHOP);
    let run =
        |options: &[&str]| sandbox.run(&[&["tolerance", "film.toml", "--samples", "400"], options].concat()).stdout;
    let median =
        json(&run(&["--format", "json"]))["displacement_rmse_mm"]["x"]["p50"]["value"].as_f64().expect("a number");
    film(&sandbox, &format!("{WORKSHOP}\n[expect.made]\ndisplacement_rmse_mm = {{ x = {median}, z = 1.0 }}"));
    assert_eq!(json(&run(&["--format", "json"]))["yield_made"]["value"], 0.5);
    let text = run(&[]);
    assert!(text.contains("yield: 50.0 % of the films meet all bounds of [expect.made] (45."), "{text}");
}

/// The bounds of `[expect]` are those of the perfect film, which films as made exceed.
#[test]
fn films_as_made_are_not_compared_with_the_bounds_of_the_film_as_ordered() {
    let sandbox = Sandbox::new();
    film(&sandbox, WORKSHOP);
    let run = |options: &[&str]| sandbox.run(&[&["tolerance", "film.toml", "--samples", "2"], options].concat()).stdout;
    let result = json(&run(&["--format", "json"]));
    let keys: Vec<&str> = result.as_object().expect("an object").keys().map(String::as_str).collect();
    assert!(keys.iter().all(|key| !key.contains("yield") || *key == "yield_made"), "{keys:?}");
    assert_eq!(result["yield_made"], serde_json::Value::Null);
    let text = run(&[]);
    assert!(text.contains("yield: none, because the layout has no [expect.made]"), "{text}");
    assert!(!text.contains("[expect]"), "{text}");
}

/// The P95 along x of the published film in a workshop is known to be 0.268 mm, to its rounding and
/// the error of 400 samples, about 0.002.
#[test]
fn check_fails_only_where_samples_exclude_the_percentile() {
    let sandbox = Sandbox::new();
    let with = |made: &str| {
        let text = fs::read_to_string(shipped("published-film")).expect("readable");
        let text = text.split("[expect").next().expect("a beginning").to_owned()
            + "[[lattice]]"
            + text.split_once("[[lattice]]").expect("tiles").1;
        sandbox.write("film.toml", &format!("{text}\n[tolerance]\n{WORKSHOP}\nsamples = 400\n[expect.made]\n{made}\n"));
        sandbox.run(&["check", "film.toml"])
    };
    let kept = with("displacement_rmse_mm = { x = 0.272 }\namplitude = { min = 0.5 }");
    assert_eq!(kept.status, 0, "{}", kept.stdout);
    let line = kept.stdout.lines().find(|line| line.contains("made.displacement_rmse_mm.x")).expect("a line");
    assert!(line.contains("at most 0.272") && line.contains("P95 of 400 films is 0.26"), "{line}");
    assert!(kept.stdout.contains("P5 of 400 films is 0.8"), "{}", kept.stdout);
    let broken = with("displacement_rmse_mm = { x = 0.255 }");
    assert_eq!(broken.status, 1, "{}", broken.stdout);
    assert!(broken.stdout.contains("FAILED") && broken.stdout.contains("made.displacement_rmse_mm.x"));
    // Half of all builds would fail at the percentile itself, and one in twenty at a confidence of
    // 95 %.
    let text = sandbox.run(&["check", "film.toml", "--format", "json"]).stdout;
    let result = json(&text);
    let percentile = &result["layouts"][0]["expectations"][0]["percentile"];
    let p95 = percentile["value"].as_f64().expect("a number");
    assert!((p95 - 0.268).abs() < 0.004 && percentile["samples"] == 400, "{percentile}");
    let at_percentile = with(&format!("displacement_rmse_mm = {{ x = {p95} }}"));
    assert_eq!(at_percentile.status, 0, "{}", at_percentile.stdout);
    let few = with("displacement_rmse_mm = { x = 0.3 }\npercentile = 5\nsamples = 40");
    assert!(few.stdout.contains("40 samples are too few to test the percentile of [expect.made]"), "{}", few.stdout);
}

/// The known shares of designed-displacement: direction 46 %, x and y 21 %, size 12 %, rotation 10
/// %, z 9 %, strength 2 % of an independent computation with 400 samples of each cause. Those of
/// P95 differ by up to a quarter of a share from those of mean squares.
#[test]
fn budget_divides_the_error_into_its_causes() {
    let sandbox = Sandbox::new();
    let text = fs::read_to_string(shipped("designed-displacement")).expect("readable");
    let tolerance = "[tolerance]\npreset = \"workshop\"\ndirection_deg = 1.0\nsize_mm = 0.02\n";
    sandbox.write("film.toml", &format!("{text}\n{tolerance}"));
    let said = sandbox.run(&["budget", "film.toml", "--format", "json"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let result = json(&said.stdout);
    assert_eq!(result["is_first_order"], true, "{result}");
    let parts = result["parts"].as_array().expect("parts");
    let share = |name: &str| {
        let part = parts.iter().find(|part| part["name"] == name).unwrap_or_else(|| panic!("{name} is in {parts:?}"));
        part["share"]["x"].as_f64().expect("a number")
    };
    for (name, known) in [
        ("tile directions of J", 0.46),
        ("tile positions, x and y", 0.21),
        ("tile sizes", 0.12),
        ("tile rotations", 0.10),
        ("tile positions, z", 0.09),
        ("tile strengths", 0.02),
    ] {
        assert!((share(name) - known).abs() < 0.055, "{name}: {}, not {known}", share(name));
    }
    for axis in ["x", "y", "z"] {
        let sum: f64 = parts.iter().map(|part| part["mean_square_mm2"][axis].as_f64().expect("a number")).sum();
        let total = result["total_mm2"][axis].as_f64().expect("a number");
        assert!((sum / total - 1.0).abs() < 1e-9, "{axis}: {sum}, not {total}");
    }
    assert_eq!(result["worth_halving"][0]["name"], "tile directions of J");
    // The end of this film compensates its pattern, that of the published film adds to it.
    assert!(share("film as ordered") < 1e-3 && result["endless_pattern_mm2"]["x"].as_f64() > Some(1e-6), "{result}");
    let published = sandbox.run(&["budget", &shipped("published-film"), "--preset", "workshop", "--format", "json"]);
    let published = &json(&published.stdout)["parts"];
    let names = [&published[0]["name"], &published[1]["name"]];
    assert_eq!(names, ["splicing pattern", "end of the film"]);
    let text = sandbox.run(&["budget", "film.toml"]).stdout;
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    for said in [
        "the same splicing pattern, repeated endlessly, would have an error of 0.0032,",
        "causes most worth halving",
        "the first order holds within 5 %",
    ] {
        assert!(words.contains(said), "{text}");
    }
    assert!(text.lines().all(|line| line.len() <= 100), "{text}");

    // Errors twenty times as large: samples of each cause divide the total.
    let large = "[tolerance]\nposition_mm = 0.5\nrotation_deg = 10\n";
    sandbox.write(
        "film.toml",
        &format!("{}\n{large}", fs::read_to_string(shipped("designed-displacement")).expect("readable")),
    );
    let said = sandbox.run(&["budget", "film.toml", "--samples", "100"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    assert!(said.stdout.contains("the first order does not hold within 5 %"), "{}", said.stdout);
    assert!(said.stdout.contains("causes together"), "{}", said.stdout);
    #[cfg(feature = "report")]
    {
        let said = sandbox.run(&["budget", "film.toml", "--figure", "budget.svg"]);
        assert_eq!(said.status, 0, "{}", said.stderr);
        assert!(sandbox.read("budget.svg").contains("tile rotations"));
        sandbox
            .run(&["budget", "film.toml", "--figure", "b.tiff"])
            .refuses("b.tiff: no format has the ending .tiff: use one of .svg, .png, .pdf, such as b.svg");
    }
}

/// Tables of `[tolerance]` that `--preset` replaces are named.
#[test]
fn presets_name_the_tables_that_they_replace() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("[tolerance]\nsamples = 10\n[tolerance.sensor]\noffset_ut = 30\n");
    let with = |options: &[&str]| sandbox.run(&[&["tolerance", &film][..], options].concat()).stderr;
    assert!(with(&["--preset", "workshop"]).contains("--preset replaces [tolerance] with its tables of groups"));
    assert!(!with(&[]).contains("--preset"));
    let plain = sandbox.published_with("[tolerance]\nsamples = 10\nposition_mm = 0.1\n");
    let said = sandbox.run(&["tolerance", &plain, "--preset", "workshop"]);
    assert!(!said.stderr.contains("--preset replaces"), "{}", said.stderr);
}

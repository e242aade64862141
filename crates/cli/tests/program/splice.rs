//! `splice`.

use crate::Sandbox;

#[test]
fn splice_finds_a_film() {
    let sandbox = Sandbox::new();
    let said = sandbox.run(&["splice", "--wavelength", "6", "--film", "12x12", "--starts", "1", "-o", "film.toml"]);
    assert_eq!(said.status, 0, "{}{}", said.stdout, said.stderr);
    let checked = sandbox.run(&["check", "film.toml"]);
    assert_eq!(checked.status, 0, "{}", checked.stdout);
    // The layout is short: one line for each of nine tiles, whose images are the other 47, and
    // angles with as many digits as were asked for.
    let text = sandbox.read("film.toml");
    let lines: Vec<&str> = text.lines().filter(|line| line.contains("position_mm")).collect();
    assert!((9..=20).contains(&lines.len()) && text.lines().count() < 90, "{text}");
    for line in lines {
        assert!(!line.contains("polarization_t") && line.contains("direction_deg = "), "{line}");
        let (_, angle) = line.split_once("direction_deg = ").expect("an angle");
        let angle = angle.split([',', ' ']).next().expect("a number");
        assert!(angle.split_once('.').is_some_and(|(_, decimals)| decimals.len() <= 2), "{line}");
    }
    assert!(text.contains("mirror = { axes = [\"x\", \"y\"] }"), "{text}");
    assert!(!text.contains("sha256") && text.contains("from the start pattern (Dai 2024, Fig. 5) for "), "{text}");
    assert!(said.stdout.contains(" tiles, from which the four-fold symmetry makes all "), "{}", said.stdout);
    assert!(said.stdout.contains("; 1 of 1 start found this film or one as good\n"), "{}", said.stdout);
    assert!(said.stdout.contains("start pattern        after"), "{}", said.stdout);
    let found = sandbox.run(&["decouple", "film.toml", "--format", "json"]);
    let found: serde_json::Value = serde_json::from_str(&found.stdout).expect("JSON");
    assert!(found["displacement_rmse_mm"]["x"].as_f64().expect("a number") < 0.002, "{found}");
    sandbox
        .run(&["splice", "--wavelength", "6", "--film", "3x12"])
        .refuses("film: 3 mm along x, must be at least 5.0000 mm");
    sandbox
        .run(&["splice", "--wavelength", "6", "--film", "12"])
        .refuses_arguments("two lengths with an x between them");
}

/// A film for five sensors, whose error is that of the film below them.
#[test]
fn splice_finds_a_film_for_a_head() {
    let sandbox = Sandbox::new();
    let request = ["splice", "--wavelength", "6", "--film", "12x12", "--starts", "1", "-o", "film.toml"];
    let splice = |options: &[&str]| sandbox.run(&[&request[..], options].concat());
    let said = splice(&["--head", "cross", "--spacing", "3mm"]);
    assert_eq!(said.status, 0, "{}{}", said.stdout, said.stderr);
    let text = sandbox.read("film.toml");
    assert!(text.contains("head = \"cross\"") && text.contains("spacing_mm = 3.0"), "{text}");
    assert_eq!(sandbox.run(&["check", "film.toml"]).status, 0);
    let found = sandbox.run(&["decouple", "film.toml", "--format", "json"]);
    let found: serde_json::Value = serde_json::from_str(&found.stdout).expect("JSON");
    assert!(found["displacement_rmse_mm"]["x"].as_f64().expect("a number") < 0.002, "{found}");
    splice(&["--head", "pair-z"]).refuses("head = \"pair-z\" has no distance of its sensors: give spacing_mm");
    splice(&["--spacing", "3"]).refuses_arguments("--head <BOARD>");
    splice(&["--head", "ring"]).refuses_arguments("pair-z, pair-xy, cross, reskin");
}

/// A film whose errors are above a tenth of the travel measures next to nothing.
#[test]
fn splice_reports_a_useless_film_and_the_limit_in_its_way() {
    let sandbox = Sandbox::new();
    let request = ["splice", "--wavelength", "8", "--film", "8x8", "--starts", "1", "-o", "film.toml"];
    let splice = |options: &[&str]| sandbox.run(&[&request[..], options].concat());
    let useless = splice(&["--smallest-cut", "2"]);
    assert_eq!(useless.status, 1, "{}", useless.stderr);
    for part in [
        "\nnot reached: RMSE of displacement: 0.188 mm, 12 % of the travel of 1.6 mm along z, must be at most 10 %\n",
        "\nthe smallest cut is too long: --smallest-cut 0.64 gives ",
        "\nthe film is too small for the wavelength and the range: --film 12x12 gives ",
        "\nnot enough alone: --starts 32, ",
    ] {
        assert!(useless.stdout.contains(part), "{part:?} is not in {}", useless.stdout);
    }
    // The advice is true.
    let better = splice(&["--smallest-cut", "0.64", "--format", "json"]);
    assert_eq!(better.status, 0, "{}", better.stderr);
    let found: serde_json::Value = serde_json::from_str(&better.stdout).expect("JSON");
    assert_eq!((found["short_of"].as_array().map(Vec::len), found.get("trials")), (Some(0), None));
}

#[test]
fn splice_ends_with_the_film_as_made_and_its_sensor() {
    let sandbox = Sandbox::new();
    let request = ["splice", "--wavelength", "8", "--film", "7x7", "--starts", "1", "-o", "film.toml"];
    let splice = |options: &[&str]| {
        let said = sandbox.run(&[&request[..], options].concat());
        assert_eq!(said.status, 0, "{}", said.stderr);
        said.stdout
    };
    let assumed = splice(&[]);
    for part in [
        "films as made, mm; 200 samples, seed 1, errors of the preset workshop\n",
        "\n  after, P95 ",
        "\n`magsplice tolerance film.toml --preset workshop` evaluates films as made\n",
    ] {
        assert!(assumed.contains(part), "{part:?} is not in {assumed}");
    }
    let written = sandbox.read("film.toml");
    assert!(!written.contains("[tolerance]") && !written.contains("[expect.made"), "{written}");

    let text = splice(&["--preset", "jig", "--sensor", "mmc5983ma"]);
    assert!(text.contains("films as made, mm; 1000 samples, seed 1\n"), "{text}");
    assert!(text.contains("\n`magsplice tolerance film.toml` evaluates films as made\n"), "{text}");
    assert!(text.contains("\nwarning: the field leaves the range of the sensor at 401 of 405 points: B_z reaches 6.0775 mT, the range is 0.8 mT; "), "{text}");
    let written = sandbox.read("film.toml");
    for table in ["[tolerance]", "[expect.made", "[sensor]\npart = \"MMC5983MA\""] {
        assert!(written.contains(table), "{table:?} is not in {written}");
    }
    // The file has the tiles in the order in which they were sampled.
    let p95_of = |figures: &serde_json::Value| figures["displacement_rmse_mm"]["z"]["p95"].clone();
    let json = |text: &str| serde_json::from_str::<serde_json::Value>(text).expect("JSON");
    let spliced = json(&splice(&["--preset", "jig", "--format", "json"]));
    let sampled = json(&sandbox.run(&["tolerance", "film.toml", "--format", "json"]).stdout);
    assert_eq!(p95_of(&spliced["made"]["after"]), p95_of(&sampled));
    let found: serde_json::Value =
        serde_json::from_str(&splice(&["--sensor", "MMC5983MA", "--format", "json"])).expect("JSON");
    assert_eq!((&found["out_of_range"]["points"], &found["out_of_range"]["axis"]), (&401.into(), &"z".into()));
    assert_eq!((&found["made"]["preset"], found["made"].get("before")), (&"workshop".into(), None));
    let of_large = splice(&["--sensor", "MLX90393", "--format", "json"]);
    assert!(!of_large.contains("out_of_range"), "{of_large}");
}

/// `--under tolerance` is the search for films as made: with coarse steps it finds a better one.
#[test]
fn splice_searches_for_films_as_made() {
    let sandbox = Sandbox::new();
    let request = ["splice", "--wavelength", "10", "--film", "15x15", "--starts", "2", "--resolution", "0.5"];
    let p95 = |options: &[&str]| {
        let said = sandbox
            .run(&[&request[..], &["--preset", "by-hand", "--format", "json", "-o", "film.toml"], options].concat());
        let found: serde_json::Value = serde_json::from_str(&said.stdout).expect("JSON");
        found["made"]["after"]["displacement_rmse_mm"]["x"]["p95"]["value"].as_f64().expect("a number")
    };
    assert!(p95(&["--under", "tolerance"]) < p95(&[]));
    // Rounding keeps the gap, or the search begins again with room for it.
    let hand =
        ["splice", "--wavelength", "10", "--film", "20x20", "--distance", "3..5", "--preset", "by-hand", "--under"];
    let coarse = ["tolerance", "--smallest-cut", "2", "--resolution", "0.5", "--resolution-deg", "45", "--gap", "0.2"];
    let said = sandbox.run(&[&hand[..], &coarse, &["--starts", "2", "-o", "hand.toml"]].concat());
    assert_eq!(said.status, 0, "{}", said.stderr);
    let tiles = sandbox.run(&["tiles", "hand.toml", "--format", "json"]);
    assert!(least_gap_mm(&tiles.stdout) >= 0.2 - 1e-9, "{}", tiles.stdout);
    let said = sandbox.run(&[&request[..], &["--preset", "by-hand", "--name", "pad", "-o", "film.toml"]].concat());
    assert!(said.stdout.contains("as ordered: --under tolerance searches"), "{}", said.stdout);
    assert!(sandbox.read("film.toml").contains("name = \"pad\""), "{}", sandbox.read("film.toml"));
    sandbox.run(&[&request[..], &["--under", "tolerance"]].concat()).refuses_arguments("--preset <PRESET>");
}

/// The least distance of two tiles of a flat film along the axis on which they are further apart.
fn least_gap_mm(tiles: &str) -> f64 {
    let layout: serde_json::Value = serde_json::from_str(tiles).expect("JSON");
    let tiles: Vec<[[f64; 2]; 2]> = layout["tile"]
        .as_array()
        .expect("tiles")
        .iter()
        .map(|tile| {
            let number = |key: &str, axis: usize| tile[key][axis].as_f64().expect("a number");
            [0, 1].map(|axis| [number("position_mm", axis), 0.5 * number("size_mm", axis)])
        })
        .collect();
    let apart = |a: &[[f64; 2]; 2], b: &[[f64; 2]; 2]| {
        let axes = [0, 1].map(|axis| (a[axis][0] - b[axis][0]).abs() - a[axis][1] - b[axis][1]);
        axes[0].max(axes[1])
    };
    let pairs = tiles.iter().enumerate().flat_map(|(n, a)| tiles[..n].iter().map(move |b| apart(a, b)));
    pairs.fold(f64::INFINITY, f64::min)
}

//! Numbers in the wrong unit, films in the wrong place, and grids too coarse: refused where they
//! cannot be meant, remarked on by `check` and warned of by other verbs where they can.

use serde_json::Value;

use crate::{Sandbox, shipped};

const HEAD: &str = "format = 1\nname = \"film\"\n";
const IDEAL: &str = "[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.12\n";
const VOLUME: &str = "[volume]\nx_mm = [-2, 2]\ny_mm = [-2, 2]\nz_mm = [-5, -3]\nstep_mm = 1\n";
const TILE: &str = "[[tile]]\nname = \"a\"\nposition_mm = [2.5, 2.5, 0.5]\nsize_mm = [3.3, 3.3, 1]\nstrength_t = 0.12\n\
                    direction = [1, 1, 0]\nmirror = { axes = [\"x\", \"y\"] }\n";

fn film() -> String {
    format!("{HEAD}{IDEAL}{VOLUME}{TILE}")
}

/// The findings of `check` about a layout with this text, and its exit status.
fn findings(text: &str) -> (i32, Vec<String>) {
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", text);
    let said = sandbox.run(&["check", "film.toml", "--format", "json"]);
    let json: Value = serde_json::from_str(&said.stdout).unwrap_or_else(|_| panic!("{}", said.stderr));
    let findings = json["layouts"][0]["findings"].as_array().expect("a list");
    (said.status, findings.iter().map(|finding| finding.as_str().expect("a text").to_owned()).collect())
}

/// Asserts that the only finding about a layout contains `message`, and that `verb` warns of it.
#[track_caller]
fn remarked(text: &str, verb: &str, message: &str) {
    let (status, found) = findings(text);
    assert!(status == 1 && found.len() == 1 && found[0].contains(message), "{message:?} is not in {found:?}");
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", text);
    let warned = format!("magsplice: warning: film.toml: {}\n", found[0]);
    let said = sandbox.run(&[verb, "film.toml"]);
    assert!(said.stderr.starts_with(&warned), "{verb}: {}", said.stderr);
    assert!(!sandbox.run(&[verb, "film.toml", "--quiet"]).stderr.contains("warning"));
}

#[track_caller]
fn refused(text: &str, message: &str) {
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", text);
    for verb in ["check", "field"] {
        sandbox.run(&[verb, "film.toml"]).refuses(message);
    }
}

#[test]
fn a_usual_film_has_no_findings() {
    assert_eq!(findings(&film()), (0, Vec::new()));
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", &film());
    for verb in ["field", "compare", "decouple", "tiles"] {
        let said = sandbox.run(&[verb, "film.toml"]);
        assert_eq!((said.status, said.stderr.as_str()), (0, ""), "{verb}");
    }
}

#[test]
fn polarizations_that_no_material_has_are_refused_with_the_unit_that_was_meant() {
    let film = film();
    let tile = |keys: &str| film.replace("strength_t = 0.12\ndirection = [1, 1, 0]", keys);
    let lattice = |keys: &str| {
        format!(
            "{HEAD}[[lattice]]\nstart_mm = [0, 0, 0]\nheight_mm = 1\n{keys}\nx = [{{ widths_mm = [1], pattern = [1] }}]\n"
        )
    };
    for (text, message) in [
        (
            tile("strength_t = 120\ndirection = [1, 1, 0]"),
            "strength_t = 120, must be at most 2.5 T, more than any material has; did you mean 0.12 T, which is 120 mT?",
        ),
        (
            tile("polarization_t = [0, -1200, 0]"),
            "polarization_t = [0.0, -1200.0, 0.0], must be at most 2.5 T, more than any material has; did you mean 1.2 T, which is 1200 mT?",
        ),
        (tile("polarization_t = [2, 2, 0]"), "has a magnitude of 2.8284 T, must be at most 2.5 T"),
        (tile("polarization_t = [955000, 0, 0]"), "; did you mean J = mu0 M = 1.2 T, for M = 955000 A/m?"),
        (tile("polarization_t = [12000, 0, 0]"), "; did you mean 1.2 T, which is 12000 G?"),
        (film.replace("amplitude_t = 0.12", "amplitude_t = 120"), "ideal: amplitude_t = 120, must be at most 2.5 T"),
        (format!("{film}[kind.k]\nsize_mm = [1, 1, 1]\nstrength_t = 120\n"), "kind \"k\": strength_t = 120, must be"),
        (lattice("strength_t = 120"), "lattice \"lattice-1\": strength_t = 120, must be at most 2.5 T"),
        (
            lattice("component_t = 120"),
            "component_t = 120 times the pattern is up to 169.7056 T, must be at most 2.5 T",
        ),
        (
            format!(
                "{film}[design]\nvary = [\"strength\"]\nstrength_t = {{ min = 0, max = 120 }}\nstock_strengths_t = [60]\n"
            ),
            "design: strength_t.max = 120, must be at most 2.5 T",
        ),
        (
            format!(
                "{film}[design]\nvary = [\"strength\"]\nstrength_t = {{ min = 0, max = 1 }}\nstock_strengths_t = [60]\n"
            ),
            "stock_strengths_t[0] = 60, must be at most 2.5 T",
        ),
    ] {
        refused(&text, message);
    }
    // A material may have it, but no permanent magnet.
    let strong = tile("strength_t = 2.2\ndirection = [1, 0, 0]")
        .replace("mirror", "# mirror")
        .replace("[3.3, 3.3, 1]", "[9, 9, 1]");
    remarked(&strong, "field", "tile \"a\": a polarization of 2.2 T is above 2 T, more than any permanent magnet has");
    assert_eq!(findings(&tile("strength_t = 2.0\ndirection = [1, 1, 0]")).0, 0);
    let ideal = film.replace("amplitude_t = 0.12", "amplitude_t = -2.2");
    remarked(&ideal, "decouple", "ideal: an amplitude_t of -2.2 T is above 2 T");
}

#[test]
fn films_to_splice_have_possible_magnets_and_lengths() {
    let sandbox = Sandbox::new();
    let splice = |arguments: &[&str]| sandbox.run(&[&["splice"], arguments].concat());
    let usual = ["--wavelength", "8", "--film", "16x16"];
    let with = |arguments: &[&'static str]| splice(&[&usual[..], arguments].concat());
    with(&["--remanence", "120"])
        .refuses("remanence: 120 T, must be at most 2 T, more than any permanent magnet has; did you mean 0.12 T, which is 120 mT?");
    splice(&["--wavelength", "0.008", "--film", "0.016x0.016"])
        .refuses("wavelength: 0.008 mm, must be at least 0.1 mm: with less, tiles are no larger than the resolution of machine tools; did you mean 8 mm, which is 0.008 m?");
    with(&["--thickness", "0.001"])
        .refuses("thickness: 0.001 mm, must be at least a thousandth of the wavelength, 8 mm; did you mean 1 mm, which is 0.001 m?");
    with(&["--range", "0.004x0.004"]).refuses("range, along x: 0.004 mm, must be at least a thousandth");
    // The same number with its unit is no mistake.
    with(&["--thickness", "0.001m", "--distance", "0.003..0.004"])
        .refuses("splice: distance, the nearest: 0.003 mm, must be at least a thousandth of the wavelength, 8 mm; did you mean 3 mm, which is 0.003 m?\n");
    with(&["--distance", "0.003..0.004"]).refuses("distance, the nearest: 0.003 mm, must be at least a thousandth");
    splice(&["--wavelength", "10", "--film", "0.02x0.02"]).refuses(
        "splice: film: 0.02 mm along x, must be at least 8.3333 mm, 5/6 of the wavelength, to contain the crests of the \
         polarization next to the middle; did you mean 20 mm, which is 0.02 m?\nsplice: film: 0.02 mm along y",
    );
    with(&["--thickness", "9000"])
        .refuses("thickness: 9000 mm, must be at most a thousand times the wavelength, 8 mm; did you mean 9 mm, which is 9000 um?");
    // The defaults that follow from the wavelength have no faults of their own.
    splice(&["--wavelength", "-8", "--film", "16x16"])
        .refuses("magsplice: splice: wavelength: -8 mm, must be a finite number greater than 0\n");
    assert_eq!(splice(&["--wavelength", "-8", "--film", "16x16"]).stderr.lines().count(), 1);
    with(&["--amplitude", "65"]).refuses("amplitude: 65, must be at most 2");
    assert_eq!(sandbox.files(), [""; 0]);
}

#[test]
fn lengths_in_metres_are_remarked_on() {
    let film = film();
    let tile = "position_mm = [2.5, 2.5, 0.5]\nsize_mm = [3.3, 3.3, 1]";
    let small = film.replace(tile, "position_mm = [0.0025, 0.0025, 0.0005]\nsize_mm = [0.0033, 0.0033, 0.001]");
    let (status, found) = findings(&small);
    assert_eq!(status, 1);
    assert!(found[0].contains("the film measures 0.0083 mm along x, and the working volume 4 mm along x"), "{found:?}");
    assert!(
        found[1].contains("a small fraction of the wavelength of [ideal], 10 mm: are its tiles in m, not mm?"),
        "{found:?}"
    );
    remarked(&small.replace(IDEAL, ""), "field", "are the tiles in m, not mm?");
    let (_, alone) = findings(&small.replace(IDEAL, "").replace(VOLUME, ""));
    assert_eq!(alone, ["the film measures 0.0083 mm along x, less than 0.1 mm: are the tiles in m, not mm?"]);
    let volume = "[volume]\nx_mm = [-0.002, 0.002]\ny_mm = [-0.002, 0.002]\nz_mm = [-0.005, -0.003]\nstep_mm = 0.001\n";
    remarked(&film.replace(VOLUME, volume), "decouple", "is the volume in m, not mm?");
    remarked(
        &film.replace("thickness_mm = 1\n", "thickness_mm = 0.001\n"),
        "compare",
        "less than a thousandth of the wavelength",
    );
}

#[test]
fn a_volume_that_nearly_touches_the_film_is_remarked_on() {
    let metres = film().replace("[-5, -3]\nstep_mm = 1", "[-0.003, -0.002]\nstep_mm = [1, 1, 0.001]");
    let message = "volume: z_mm = [-0.003, -0.002] begins 0.002 mm from the film, nearer than a hundredth of the \
                   wavelength, 10 mm; did you mean -3 .. -2 mm, which is -0.003 .. -0.002 m?";
    for verb in ["field", "decouple"] {
        remarked(&metres, verb, message);
    }
    // One end alone is not in metres, and 0.1 mm is a hundredth of the wavelength.
    let near = film().replace("[-5, -3]\nstep_mm = 1", "[-3.099, -0.099]\nstep_mm = 1");
    let (_, found) = findings(&near);
    assert!(found.len() == 1 && found[0].ends_with("wavelength, 10 mm"), "{found:?}");
    assert_eq!(findings(&near.replace("[-3.099, -0.099]", "[-3.1, -0.1]")).0, 0);
}

#[test]
fn steps_in_metres_and_ends_without_round_off_are_shown() {
    refused(
        &film().replace("step_mm = 1", "step_mm = 0.00025"),
        "mm along each axis; did you mean 0.25 mm, which is 0.00025 m?",
    );
    let coarse = film().replace("x_mm = [-2, 2]", "x_mm = [-0.4, 0.4]").replace("step_mm = 1", "step_mm = [0.3, 1, 1]");
    remarked(&coarse, "field", "x_mm = [-0.4, 0.4]; the last points are at 0.2");
}

#[test]
fn an_ideal_film_stands_on_z_0_with_the_sensor_below() {
    let film = film();
    let below = film.replace("[2.5, 2.5, 0.5]", "[2.5, 2.5, -0.5]");
    let message = "the film is at z = -1 .. 0 mm, and the ideal film fills 0 <= z <= 1 mm with the sensor below, at z < 0: \
                   move the tiles and the volume by 1 mm along z";
    for verb in ["compare", "decouple"] {
        remarked(&below, verb, message);
    }
    // The field by itself needs no ideal film.
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", &below);
    assert_eq!(sandbox.run(&["field", "film.toml"]).stderr, "");
    let over = below.replace("z_mm = [-5, -3]", "z_mm = [3, 5]");
    let (status, found) = findings(&over);
    assert_eq!((status, found.len()), (1, 2), "{found:?}");
    assert!(found[0].contains("turn the film and the volume over") && found[1].contains("z_mm = [3, 5] is not below"));
}

#[test]
fn a_step_that_misses_the_end_is_warned_of_where_the_volume_is_used() {
    let coarse = film().replace("step_mm = 1", "step_mm = [1.5, 1, 1]");
    for verb in ["field", "compare", "decouple"] {
        remarked(&coarse, verb, "volume: a step of 1.5 mm does not divide x_mm = [-2, 2]; the last points are at 1");
    }
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", &coarse);
    sandbox.write("p.csv", "x_mm,y_mm,z_mm\n0,0,-4\n");
    for arguments in [&["tiles", "film.toml"][..], &["field", "film.toml", "--points", "p.csv"]] {
        let said = sandbox.run(arguments);
        assert_eq!((said.status, said.stderr.as_str()), (0, ""), "{arguments:?}");
    }
    #[cfg(feature = "report")]
    assert!(
        sandbox.run(&["report", "film.toml", "-o", "report"]).stderr.contains("warning: film.toml: volume: a step")
    );
}

#[test]
fn uniformity_of_single_points_has_no_value() {
    let sandbox = Sandbox::new();
    let expect = "[expect]\nuniformity_rmse = { r_x = 0.1, r_y = 0.1, s_z = 0.1 }\n";
    // One point along y and z, five along x: planes normal to x have one point, others five.
    let line = format!(
        "{}{expect}",
        film()
            .replace("step_mm = 1", "step_mm = [1, 4, 2]")
            .replace("[-2, 2]\nz", "[0, 3]\nz")
            .replace("[-5, -3]", "[-5, -4]")
    );
    sandbox.write("film.toml", &line);
    let (_, found) = findings(&line);
    let one = "the grid has 5 x 1 x 1 points, only one in each plane normal to x: the uniformity RMSE";
    assert!(found.iter().any(|finding| finding.contains(one)), "{found:?}");
    let said = sandbox.run(&["decouple", "film.toml"]);
    let row: Vec<&str> = said.stdout.lines().filter(|line| line.contains("uniformity RMSE")).collect();
    assert!(row[0].contains("one point") && row[0].matches("one point").count() == 1, "{row:?}");
    let json: Value =
        serde_json::from_str(&sandbox.run(&["decouple", "film.toml", "--format", "json"]).stdout).unwrap();
    assert!(json["uniformity_rmse"]["r_x"].is_null() && json["uniformity_rmse"]["s_z"].is_number(), "{json}");
    let said = sandbox.run(&["check", "film.toml"]);
    assert_eq!(said.status, 2);
    let reason = "ERROR    uniformity_rmse.r_x  film.toml: the grid has one point in each plane normal to x";
    assert!(said.stdout.contains(reason), "{}", said.stdout);
    assert!(!said.stdout.contains("ERROR    uniformity_rmse.r_y"), "{}", said.stdout);
    sandbox.write("design.toml", &format!("{line}[design]\nvary = [\"direction\"]\n"));
    sandbox.run(&["check", "design.toml"]).refuses("goal = \"uniformity\" needs at least two points in each plane");
}

#[test]
fn relative_tolerances_of_a_tenth_and_more_are_refused() {
    let sandbox = Sandbox::new();
    for (tolerance, message) in [
        ("10", "10 is 1000 % of |B|, must be a fraction below 0.1; a field has a unit, as in 10nT"),
        ("0.1", "0.1 is 10 % of |B|"),
    ] {
        for verb in ["field", "plan"] {
            sandbox.run(&[verb, &shipped("published-film"), "--within", tolerance]).refuses_arguments(message);
        }
    }
    assert_eq!(sandbox.run(&["field", &shipped("published-film"), "--within", "0.09"]).status, 0);
    let expect = |within: &str| format!("{}[expect]\nfield = {{ file = \"b.csv\", within = {within} }}\n", film());
    refused(&expect("10"), "field.within = 10, must be less than 2, a fraction of |B|");
    let (_, found) = findings(&expect("0.5"));
    assert!(found[0].contains("field.within = 0.5 is a fraction of |B|, 50 %"), "{found:?}");
}

#[test]
fn a_negative_amplitude_is_explained() {
    let sandbox = Sandbox::new();
    let reversed = film().replace("[1, 1, 0]", "[-1, -1, 0]");
    sandbox.write("film.toml", &format!("{reversed}[expect]\namplitude = {{ min = 0.1 }}\n"));
    for (verb, amplitude) in [("compare", "/amplitude"), ("decouple", "/comparison/amplitude")] {
        let said = sandbox.run(&[verb, "film.toml"]);
        let text = said.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains("The film is reversed (every J points the other way), or shifted by half a wavelength"));
        assert!(said.stdout.lines().all(|line| line.len() <= 80), "{}", said.stdout);
        let said = sandbox.run(&[verb, "film.toml", "--format", "json"]);
        let json: Value = serde_json::from_str(&said.stdout).expect("JSON");
        assert!(json.pointer(amplitude).and_then(Value::as_f64).expect("a number") < 0.0);
        assert!(json["remark"].as_str().expect("a text").starts_with("the amplitude is negative"));
    }
    let said = sandbox.run(&["check", "film.toml"]);
    assert!(said.status == 1 && said.stdout.contains("the film is reversed or shifted by half a wavelength"));
    sandbox.write("usual.toml", &film());
    assert!(!sandbox.run(&["compare", "usual.toml"]).stdout.contains("reversed"));
    let said = sandbox.run(&["compare", "usual.toml", "--format", "json"]);
    assert!(serde_json::from_str::<Value>(&said.stdout).expect("JSON").get("remark").is_none());
}

/// A film with its corner at the origin, and a reference point beside the axis.
#[test]
fn volumes_beside_the_film_are_remarked_on() {
    let corner =
        film().replace("[2.5, 2.5, 0.5]", "[6.5, 6.5, 0.5]").replace("mirror = { axes = [\"x\", \"y\"] }\n", "");
    let message = "volume: x_mm = [-2, 2] reaches beyond the film, which fills 4.85 to 8.15 mm";
    remarked(&corner, "decouple", message);
    let beside = film().replace("step_mm = 1\n", "step_mm = 1\nreference_mm = [1, 0, -5]\n");
    remarked(&beside, "decouple", "volume: reference_mm = [1, 0, ...] is not on the axis of the film");
    // Half a wavelength beside it, R_x and R_y are 0 too.
    let other_crest = film().replace("step_mm = 1\n", "step_mm = 1\nreference_mm = [5, 0, -5]\n");
    assert_eq!(findings(&other_crest).1, [""; 0]);
}

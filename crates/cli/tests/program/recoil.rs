//! Tiles with a recoil permeability, in every verb that evaluates a film.

use serde_json::Value;

use crate::Sandbox;

/// Two squares above a working volume. `material` are the lines of `[material]`.
fn film(material: &str) -> String {
    format!(
        "format = 1\nname = \"squares\"\n\
         [ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.12\n\
         [volume]\nx_mm = [-1, 1]\ny_mm = [-1, 1]\nz_mm = [-4, -3]\nstep_mm = 1\nreference_mm = [0, 0, -4]\n\
         [[tile]]\nname = \"right\"\nposition_mm = [2.5, 0, 0.5]\nsize_mm = [3, 6, 1]\npolarization_t = [0.12, 0, 0]\n\
         mirror = {{ axes = [\"x\"] }}\n{material}"
    )
}

const MATERIAL: &str = "[material]\nrecoil_permeability = 1.2\n";

fn sandbox(material: &str) -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("rigid.toml", &film(""));
    sandbox.write("film.toml", &film(material));
    sandbox
}

fn stdout(sandbox: &Sandbox, args: &[&str]) -> String {
    let said = sandbox.run(args);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""), "{args:?}");
    said.stdout
}

fn json(sandbox: &Sandbox, args: &[&str]) -> Value {
    serde_json::from_str(&stdout(sandbox, args)).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}, not a number"))
}

/// Lines of text without the hash of the layout.
fn without_hash(text: &str) -> String {
    text.lines().filter(|line| !line.contains("sha256")).collect::<Vec<_>>().join("\n")
}

#[test]
fn unit_permeability_changes_no_byte() {
    let sandbox = sandbox("[material]\nrecoil_permeability = 1\nknee_field_t = 0.5\n");
    for verb in [
        &["field"][..],
        &["compare"],
        &["decouple"],
        &["plan", "--within", "1e-6"],
        &["forces"],
        &["decouple", "--format", "csv"],
    ] {
        let of = |layout: &str| {
            let mut args = vec![verb[0], layout];
            args.extend(&verb[1..]);
            without_hash(&stdout(&sandbox, &args))
        };
        assert_eq!(of("film.toml"), of("rigid.toml"), "{verb:?}");
    }
}

#[test]
fn decouple_states_what_recoil_changes_and_how_well_it_is_known() {
    let sandbox = sandbox(&format!("{MATERIAL}knee_field_t = 0.02\n"));
    let (rigid, with) = (
        json(&sandbox, &["decouple", "rigid.toml", "--format", "json"]),
        json(&sandbox, &["decouple", "film.toml", "--format", "json", "-q"]),
    );
    assert!(rigid.get("recoil").is_none());
    let recoil = &with["recoil"];
    let figures = |of: &str, key: &str| number(&recoil["figures"][of][key]);
    // The figures are those of the whole command: the volume has few points.
    assert!((figures("with_recoil", "amplitude") - number(&with["comparison"]["amplitude"])).abs() < 1e-12, "{recoil}");
    assert!((figures("without", "amplitude") - number(&rigid["comparison"]["amplitude"])).abs() < 1e-12, "{recoil}");
    let change = figures("with_recoil", "amplitude") / figures("without", "amplitude") - 1.0;
    assert!(change < -0.02 && change > -0.1, "{change}");
    assert!(figures("errors", "amplitude") < 0.3 * change.abs(), "{recoil}");
    assert!(number(&recoil["error_t"]) <= 0.3 * 1.5 * number(&recoil["change_t"]), "{recoil}");
    assert!(number(&recoil["largest_weakening"]) > 0.02);
    let text = stdout(&sandbox, &["decouple", "film.toml", "-q"]);
    for part in
        ["recoil: 108 cells at level 3, B changes by up to", "tiles weaken by", "beyond the knee at mu0 H = -0.02 T"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    sandbox.write("strong.toml", &film(&format!("{MATERIAL}knee_field_t = 0.5\n")));
    let text = stdout(&sandbox, &["decouple", "strong.toml"]);
    assert!(text.contains("no cell is beyond the knee at mu0 H = -0.5 T"), "{text}");
}

/// The estimate is of the first order: it has the sign and the size of what is computed.
#[test]
fn plan_and_check_estimate_what_recoil_changes() {
    let sandbox = sandbox(MATERIAL);
    let plan = json(&sandbox, &["plan", "rigid.toml", "--format", "json"]);
    let estimates = plan["recoil_estimates"].as_array().expect("a list");
    assert_eq!(estimates.iter().map(|of| number(&of["recoil_permeability"])).collect::<Vec<_>>(), [1.05, 1.2]);
    let stated = json(&sandbox, &["plan", "film.toml", "--format", "json"]);
    let estimates_of_film = stated["recoil_estimates"].as_array().expect("a list");
    assert_eq!(estimates_of_film.len(), 1);
    assert!(estimates_of_film[0]["recoil_permeability"].is_null());
    assert_eq!(estimates_of_film[0]["with_recoil"], estimates[1]["with_recoil"]);
    let computed = json(&sandbox, &["decouple", "film.toml", "--format", "json"]);
    let change = |with: &Value, without: &Value| number(&with["amplitude"]) - number(&without["amplitude"]);
    let estimated = change(&estimates[1]["with_recoil"], &estimates[1]["without"]);
    let figures = &computed["recoil"]["figures"];
    let computed = change(&figures["with_recoil"], &figures["without"]);
    assert!((estimated / computed - 1.0).abs() < 0.5, "{estimated} {computed}");

    sandbox.write("expected.toml", &film("[expect]\namplitude = { min = 0.1 }\n"));
    let text = stdout(&sandbox, &["check", "expected.toml"]);
    assert!(!text.contains("recoil"), "a film without a permeability: {text}");
    sandbox.write("stated.toml", &film(&format!("{MATERIAL}[expect]\namplitude = {{ min = 0.1 }}\n")));
    let text = stdout(&sandbox, &["check", "stated.toml"]);
    assert!(text.contains("recoil") && text.contains("as stated: amplitude -"), "{text}");
    let check = json(&sandbox, &["check", "stated.toml", "--format", "json"]);
    assert_eq!(check["layouts"][0]["recoil_estimates"].as_array().map(Vec::len), Some(1), "{check}");
}

/// B is that of the cells, also inside the tiles; J inside is weaker than that of the layout.
#[test]
fn field_is_that_of_the_weakened_tiles() {
    let sandbox = sandbox(MATERIAL);
    sandbox.write("points.csv", "x_mm,y_mm,z_mm\n0,0,-3.5\n2.61,0.13,0.47\n");
    let field = |layout: &str, quantity: &str| -> Vec<Vec<f64>> {
        let csv = stdout(&sandbox, &["field", layout, "--points", "points.csv", "--quantity", quantity]);
        let rows = csv.lines().filter(|line| !line.starts_with('#') && !line.starts_with('x'));
        rows.map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect()).collect()
    };
    let (rigid, with) = (field("rigid.toml", "b"), field("film.toml", "b"));
    let outside = with[0][5] / rigid[0][5];
    assert!(outside < 0.98 && outside > 0.9, "{outside}");
    let (rigid, with) = (field("rigid.toml", "j"), field("film.toml", "j"));
    assert_eq!(rigid[1][3], 0.12);
    assert!(with[1][3] < 0.119 && with[1][3] > 0.11, "{with:?}");
    let (b, h, j) = (field("film.toml", "b"), field("film.toml", "h"), field("film.toml", "j"));
    for axis in 3..6 {
        assert!((b[1][axis] - 4e-7 * std::f64::consts::PI * h[1][axis] - j[1][axis]).abs() < 1e-9);
    }
    // An edge of a cell is reported as that of its tile.
    sandbox.write("edge.csv", "x_mm,y_mm,z_mm\n4,3,0.2\n");
    let said = sandbox.run(&["field", "film.toml", "--points", "edge.csv"]);
    assert!(said.status != 0 && said.stderr.contains("exposed edge of tile \"right\""), "{}", said.stderr);
}

#[test]
fn errors_that_cannot_be_kept_are_refused() {
    // So permeable a film is divided into few cells only.
    let sandbox = sandbox("[material]\nrecoil_permeability = 200\nrecoil_error = 5e-4\n");
    let said = sandbox.run(&["decouple", "film.toml"]);
    assert!(said.status != 0, "{}", said.stdout);
    assert!(said.stderr.contains("raise recoil_error in [material]"), "{}", said.stderr);
    assert!(said.stderr.contains("recoil_permeability = 200, must be at most 100"), "{}", said.stderr);
}

/// The nominal film of a tolerance study is the film of `decouple`, and temperature takes the
/// coefficient of the material.
#[test]
fn films_that_are_made_have_recoil() {
    let tolerance = "[tolerance]\nstrength = 0.01\nposition_mm = 0.02\nsamples = 40\n\
                     [tolerance.temperature]\nchange_k = { fixed = 10 }\n";
    let sandbox = sandbox(&format!("{MATERIAL}strength_per_k = -0.001\n{tolerance}"));
    let made = json(&sandbox, &["tolerance", "film.toml", "--format", "json"]);
    let computed = json(&sandbox, &["decouple", "film.toml", "--format", "json"]);
    let amplitude = number(&computed["comparison"]["amplitude"]);
    let nominal = number(&made["amplitude"]["nominal"]);
    assert!((nominal - amplitude).abs() < 1e-9 * amplitude, "{nominal} {amplitude}");
    let text = stdout(&sandbox, &["budget", "film.toml"]);
    assert!(text.contains("strength"), "{text}");
}

/// Squares along x that attract each other are held by less force than rigid ones.
#[test]
fn forces_are_those_of_the_weakened_tiles() {
    let sandbox = sandbox(MATERIAL);
    let force = |layout: &str| {
        let result = json(&sandbox, &["forces", layout, "--format", "json"]);
        number(&result["tiles"][0]["force_n"][0])
    };
    let ratio = force("film.toml") / force("rigid.toml");
    assert!(ratio < 0.97 && ratio > 0.8, "{ratio}");
}

#[cfg(feature = "report")]
#[test]
fn report_maps_how_far_tiles_weaken_and_turn() {
    let sandbox = sandbox(MATERIAL);
    let said = sandbox.run(&["report", "film.toml", "-o", "report"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let csv = sandbox.read("report/recoil.csv");
    assert!(csv.starts_with("name,x_mm,y_mm,z_mm,weakening_percent,turn_deg,"), "{csv}");
    assert_eq!(csv.lines().count(), 3);
    assert!(sandbox.read("report/recoil.svg").contains("<svg"));
}

/// The film that is designed with recoil has the errors that `decouple` finds, and smaller ones
/// than a film that was designed without.
#[test]
fn design_counts_recoil() {
    let brief = "[design]\nvary = [\"size\", \"position\"]\nsymmetry = \"mirror\"\nstarts = 1\noutline_mm = { x = [-6, 6], \
                 y = [-6, 6] }\n";
    let sandbox = sandbox(&format!("{MATERIAL}{brief}"));
    sandbox.write("rigid.toml", &film(brief));
    let error = |layout: &str| {
        let result = json(&sandbox, &["decouple", layout, "--format", "json"]);
        let of = |key: &str| number(&result["uniformity_rmse"][key]);
        [of("r_x"), of("r_y"), of("s_z")].map(|rmse| rmse * rmse).iter().sum::<f64>().sqrt()
    };
    for (layout, designed) in [("film.toml", "designed.toml"), ("rigid.toml", "without.toml")] {
        let said = sandbox.run(&["design", layout, "-o", designed, "--format", "json"]);
        assert_eq!(said.status, 0, "{}", said.stderr);
        let result: Value = serde_json::from_str(&said.stdout).expect("JSON");
        let of = |key: &str| number(&result["after"]["uniformity_rmse"][key]);
        let found = [of("r_x"), of("r_y"), of("s_z")].map(|rmse| rmse * rmse).iter().sum::<f64>().sqrt();
        let again = error(designed);
        assert!((found - again).abs() <= 1e-9 * again, "{found} {again}");
    }
    // The film that was designed without, made of a material with recoil.
    let made = sandbox.read("without.toml") + MATERIAL;
    sandbox.write("made.toml", &made);
    let (with, without) = (error("designed.toml"), error("made.toml"));
    assert!(with < without, "{with} {without}");
}

/// Every verb that evaluates the film tells of the part beyond the knee, unless it is quiet.
#[test]
fn cells_beyond_the_knee_are_told() {
    let sandbox = sandbox(&format!("{MATERIAL}knee_field_t = 0.02\n[expect]\namplitude = {{ min = 0.01 }}\n"));
    let warning = "magsplice: warning: film.toml: ";
    for verb in [
        &["compare", "film.toml"][..],
        &["check", "film.toml"],
        &["tolerance", "film.toml", "--preset", "jig", "--samples", "2"],
        &["report", "film.toml", "-o", "report"],
        &["forces", "film.toml"],
    ] {
        let said = sandbox.run(verb);
        assert_eq!(said.status, 0, "{verb:?} {}", said.stderr);
        let told =
            said.stderr.lines().filter(|line| line.starts_with(warning) && line.contains(" beyond the knee at "));
        assert_eq!(told.count(), 1, "{verb:?} {}", said.stderr);
        let quiet = sandbox.run(&[verb, &["--quiet"]].concat());
        assert!(!quiet.stderr.contains("knee"), "{verb:?} {}", quiet.stderr);
    }
}

/// The volume touches edges of both tiles: there B is refused as without recoil, and left out of
/// the error.
#[test]
fn volume_that_touches_tiles_is_evaluated_outside_them() {
    let sandbox = Sandbox::new();
    let touching = film(MATERIAL).replace("z_mm = [-4, -3]", "z_mm = [-4, 0]");
    sandbox.write("touching.toml", &touching);
    assert!(stdout(&sandbox, &["plan", "touching.toml"]).contains("recoil: "));
    let refused = sandbox.run(&["field", "touching.toml"]);
    assert_eq!(refused.status, 2, "{}", refused.stdout);
    assert!(
        refused.stderr.contains("(1, -1, 0) mm of the working volume: the field is unbounded"),
        "{}",
        refused.stderr
    );
    let inside =
        film(MATERIAL).replace("x_mm = [-1, 1]", "x_mm = [2, 3]").replace("z_mm = [-4, -3]", "z_mm = [0.4, 0.6]");
    sandbox.write("inside.toml", &inside.replace("step_mm = 1", "step_mm = 0.2").replace("[0, 0, -4]", "[2, 0, 0.4]"));
    let said = sandbox.run(&["plan", "inside.toml"]);
    assert!(said.status == 0 && said.stdout.contains("recoil: "), "{}", said.stderr);
}

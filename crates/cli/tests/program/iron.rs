//! Layouts with flat iron.

use super::{Sandbox, shipped};

const TILE: &str = "format = 1\nname = \"plate\"\n[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.12\n\
                    [volume]\nx_mm = [-1, 1]\ny_mm = [-1, 1]\nz_mm = [-5, -3]\nstep_mm = 1\n";

fn tile(name: &str, z_mm: f64, j_t: [f64; 3]) -> String {
    format!(
        "[[tile]]\nname = \"{name}\"\nposition_mm = [1, 0.5, {z_mm}]\nsize_mm = [3, 2, 1]\npolarization_t = {j_t:?}\n"
    )
}

const PLANE: &str = "[[plane]]\npoint_mm = [0, 0, 1.25]\nnormal = [0, 0, -1]\nrelative_permeability = 3\n";

/// The field beside a plane is that of a layout with the image tile.
#[test]
fn planes_have_the_field_of_images() {
    let sandbox = Sandbox::new();
    let own = tile("a", 0.5, [0.2, 0.1, 0.4]);
    sandbox.write("plane.toml", &format!("{TILE}{PLANE}{own}"));
    sandbox.write("image.toml", &format!("{TILE}{own}{}", tile("image", 2.0, [-0.1, -0.05, 0.2])));
    for options in [&["--at", "0,0,-4"][..], &[], &["--within", "1e-6"]] {
        let field = |layout| {
            let said = sandbox.run(&[&["field", layout], options].concat());
            assert_eq!(said.status, 0, "{}", said.stderr);
            said.stdout.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(field("plane.toml"), field("image.toml"));
    }
    let loads = |layout| -> serde_json::Value {
        let said = sandbox.run(&["forces", layout, "--format", "json"]);
        serde_json::from_str(&said.stdout).expect("JSON")
    };
    assert_eq!(loads("plane.toml")["tiles"][0]["force_n"], loads("image.toml")["tiles"][0]["force_n"]);
    let said = sandbox.run(&["forces", "plane.toml"]);
    assert!(said.stdout.contains("about the origin: by the iron"), "{}", said.stdout);
    let at = ["field", "plane.toml", "--at", "0,0,1.25"];
    sandbox.run(&at).refuses("the point is on or behind plane 1, in iron");
    let said = sandbox.run(&["decouple", "plane.toml"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
}

/// What does not take iron into account says so, in place of numbers without it.
#[test]
fn work_without_iron_is_refused() {
    let sandbox = Sandbox::new();
    let more =
        "[tolerance]\nposition_mm = 0.05\n[design]\nvary = [\"strength\"]\nstrength_t = { min = 0.05, max = 0.5 }\n";
    let own = tile("a", 0.5, [0.2, 0.1, 0.4]);
    sandbox.write("film.toml", &format!("{TILE}{more}{PLANE}{own}"));
    sandbox.write("soft.toml", &format!("{TILE}{PLANE}[material]\nrecoil_permeability = 1.05\n{own}"));
    let scan = "x_mm,y_mm,z_mm,bx_t,by_t,bz_t\n";
    let rows: Vec<String> =
        (0..27).map(|n| format!("{},{},{},1e-3,{n}e-4,-1e-3\n", n % 3, n / 3 % 3, -3 - n / 9)).collect();
    sandbox.write("scan.csv", &(scan.to_owned() + &rows.concat()));
    sandbox.write("tiles.csv", "name,j_x_t,j_y_t,j_z_t\nm1,0.2,0.1,0.4\nm2,0.2,0.1,0.39\n");
    for arguments in [
        &["design", "film.toml", "-o", "better.toml"][..],
        &["diagnose", "film.toml", "--scan", "scan.csv", "--noise", "5uT"],
        &["assign", "film.toml", "--measured", "tiles.csv", "-o", "made.toml"],
        &["experiment", "film.toml", "--bend-radius", "100mm"],
        &["field", "soft.toml"],
    ] {
        sandbox.run(arguments).refuses("without the field of iron: leave out [[plane]]");
    }
    let near = "[tolerance.iron]\ndistance_mm = 1\n";
    let design = "[design]\ngoal = \"displacement\"\nvary = [\"strength\"]\nunder = \"tolerance\"\nstrength_t = { min = 0.05, max = 0.5 }\n";
    for key in ["distance_error_mm = { uniform = 0.1 }", "normal = [0.1, 0, -1]"] {
        sandbox.write("near.toml", &format!("{TILE}{design}{near}{key}\n{own}"));
        sandbox
            .run(&["design", "near.toml", "-o", "better.toml"])
            .refuses("films are designed for iron that is parallel to the film, at a distance without errors");
    }
    sandbox.write("soft.toml", &format!("{TILE}{near}[material]\nrecoil_permeability = 1.05\n{own}"));
    sandbox.run(&["tolerance", "soft.toml"]).refuses("leave out recoil_permeability or [tolerance.iron]");
    sandbox.run(&["export", "film.toml", "--to", "magpylib"]).refuses("magpylib has no field of iron");
    let published = std::fs::read_to_string(shipped("published-film")).expect("readable");
    sandbox.write("inside.toml", &format!("{published}\n[[plane]]\npoint_mm = [0, 0, 0.5]\nnormal = [0, 0, -1]\n"));
    sandbox.run(&["check", "inside.toml"]).refuses("reaches 5.000e-1 mm into the iron, must be before it");
}

/// Films as made beside iron: a sample without errors is the film of the layout, a sampled scan has
/// the field of its images, and the budget names the iron.
#[test]
fn films_as_made_have_their_images() {
    let sandbox = Sandbox::new();
    let published = std::fs::read_to_string(shipped("published-film")).expect("readable");
    let of = |name: &str, tables: &str| sandbox.write(name, &format!("{published}\n{tables}\n"));
    of("plate.toml", "[tolerance]\nsamples = 10\n[[plane]]\npoint_mm = [0, 0, 2]\nnormal = [0, 0, -1]");
    of("near.toml", "[tolerance]\nsamples = 10\n[tolerance.iron]\ndistance_mm = 1\nwhen = \"before\"");
    let json = |arguments: &[&str]| -> serde_json::Value {
        let said = sandbox.run(&[arguments, &["--format", "json"]].concat());
        assert_eq!(said.status, 0, "{}", said.stderr);
        serde_json::from_str(&said.stdout).expect("JSON")
    };
    let ordered = json(&["decouple", "plate.toml"]);
    for name in ["plate.toml", "near.toml"] {
        let made = json(&["tolerance", name]);
        for axis in ["x", "y", "z"] {
            let known = ordered["displacement_rmse_mm"][axis].as_f64().expect("a number");
            let found = made["displacement_rmse_mm"][axis]["mean"]["value"].as_f64().expect("a number");
            assert!((found - known).abs() < 1e-12, "{name}: {found}, not {known}");
        }
        let scan = format!("{name}.csv");
        assert_eq!(sandbox.run(&["tolerance", "sample", name, "--scan", &scan]).status, 0);
        // The noise of the sensor; the images have 110 uT at the reference point.
        let residual_t = json(&["scan", "plate.toml", &scan])["residual_t"].as_f64().expect("a number");
        assert!(residual_t < 3e-6, "{name}: {residual_t}");
    }
    let budget = sandbox.run(&["budget", "near.toml"]);
    assert!(budget.status == 0 && budget.stdout.contains("iron nearby"), "{}", budget.stderr);
    let behind = ["tolerance", "sample", "near.toml", "--points", "points.csv", "--scan", "s.csv"];
    sandbox.write("points.csv", "x_mm,y_mm,z_mm\n0,0,-4\n0,0,2.5\n");
    sandbox.run(&behind).refuses("in iron");
}

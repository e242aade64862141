//! Layouts with flat iron.

use std::fmt::Write;

use super::{Sandbox, rows, shipped};

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
    let own = tile("a", 0.5, [0.2, 0.1, 0.4]);
    sandbox.write("film.toml", &format!("{TILE}{PLANE}{own}"));
    let bent = ["experiment", "film.toml", "--bend-radius", "100mm"];
    sandbox.run(&bent).refuses("flat iron does not bend with the film: leave out the planes of iron or the bend");
    let near = "[tolerance.iron]\ndistance_mm = 1\n";
    let design = "[design]\ngoal = \"displacement\"\nvary = [\"strength\"]\nunder = \"tolerance\"\nstrength_t = { min = 0.05, max = 0.5 }\n";
    sandbox.write("near.toml", &format!("{TILE}{design}{near}normal = [0.1, 0, -1]\n{own}"));
    sandbox
        .run(&["design", "near.toml", "-o", "better.toml"])
        .refuses("films are designed for iron that is parallel to the film, apart from it");
    sandbox.write("soft.toml", &format!("{TILE}{near}[material]\nrecoil_permeability = 1.05\n{own}"));
    sandbox.run(&["tolerance", "soft.toml"]).refuses("leave out recoil_permeability or [tolerance.iron]");
    sandbox.run(&["export", "film.toml", "--to", "magpylib"]).refuses("magpylib has no field of iron");
    let published = std::fs::read_to_string(shipped("published-film")).expect("readable");
    sandbox.write("inside.toml", &format!("{published}\n[[plane]]\npoint_mm = [0, 0, 0.5]\nnormal = [0, 0, -1]\n"));
    sandbox
        .run(&["check", "inside.toml"])
        .refuses("reaches 0.5 mm into the iron, must be before it: move the plane or the tile");
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

/// The published film with a plate of iron 0.5 mm above it.
fn plated(sandbox: &Sandbox) {
    let published = std::fs::read_to_string(shipped("published-film")).expect("readable");
    sandbox.write("film.toml", &format!("{published}\n{PLATE}"));
}

const PLATE: &str = "[[plane]]\npoint_mm = [0, 0, 1.5]\nnormal = [0, 0, -1]\n";

/// A scan of a film before a plate with one tile 20 % too weak: its errors change its image too.
#[test]
fn faulty_tile_is_found_before_a_plate() {
    let sandbox = Sandbox::new();
    plated(&sandbox);
    let tile = "[[tile]]\nposition_mm = [-2.5, -2.5, 0.5]\nsize_mm = [3.3, 3.3, 1]\npolarization_t = [-0.0848528137, -0.0848528137, 0]\n";
    let volume = "[volume]\nx_mm = [-2, 2]\ny_mm = [-2, 2]\nz_mm = [-5, -3]\nstep_mm = 0.5\n";
    sandbox.write("one.toml", &format!("format = 1\nname = \"one\"\n{volume}{PLATE}{tile}"));
    let [film, one] = ["film.toml", "one.toml"].map(|layout| rows(&sandbox.run(&["field", layout]).stdout));
    let mut scan = "x_mm,y_mm,z_mm,bx_t,by_t,bz_t\n".to_owned();
    for (film, one) in film.iter().zip(&one) {
        let weak: Vec<String> = (0..3).map(|axis| format!("{:?}", film[3 + axis] - 0.2 * one[3 + axis])).collect();
        let _ = writeln!(scan, "{:?},{:?},{:?},{}", film[0], film[1], film[2], weak.join(","));
    }
    sandbox.write("scan.csv", &scan);
    let said = sandbox.run(&["diagnose", "film.toml", "--scan", "scan.csv", "--noise", "2uT"]);
    assert!(said.stdout.contains("1 error:\n  film-x4-y4: 20.00 % too weak"), "{}{}", said.stdout, said.stderr);
}

/// The error that `assign` and `design` report before iron is that of the film they write.
#[test]
fn assigned_and_designed_films_have_their_error_before_iron() {
    let sandbox = Sandbox::new();
    let number = |of: &serde_json::Value| of.as_f64().unwrap_or_else(|| panic!("{of} is no number"));
    let errors_mm = |layout: &str| {
        let said = sandbox.run(&["decouple", layout, "--format", "json"]);
        let found: serde_json::Value = serde_json::from_str(&said.stdout).expect("JSON");
        ["x", "y", "z"].map(|axis| number(&found["displacement_rmse_mm"][axis]))
    };
    let [one, other] = [(-1.7, "a"), (1.7, "b")].map(|(x, name)| {
        let j_t = if x < 0.0 { "[0.1, 0.1, 0]" } else { "[-0.1, 0.1, 0]" };
        format!(
            "[[tile]]\nname = \"{name}\"\nposition_mm = [{x}, 0, 0.5]\nsize_mm = [3, 3, 1]\npolarization_t = {j_t}\n"
        )
    });
    sandbox.write("pair.toml", &format!("{TILE}{PLANE}{one}{other}"));
    sandbox.write("tiles.csv", "tile,jx_t,jy_t,jz_t\nm1,0.11,0.1,0.01\nm2,0.1,0.09,-0.02\nm3,0.12,0.1,0\n");
    let assign = ["assign", "pair.toml", "--measured", "tiles.csv", "-o", "made.toml", "--format", "json"];
    let said = sandbox.run(&assign);
    assert_eq!(said.status, 0, "{}", said.stderr);
    let found: serde_json::Value = serde_json::from_str(&said.stdout).expect("JSON");
    let rms_mm = (errors_mm("made.toml").iter().map(|of| of * of).sum::<f64>() / 3.0).sqrt();
    assert!((number(&found["rms_mm"]) / rms_mm - 1.0).abs() < 1e-9, "{rms_mm} {found}");

    let design = "[design]\ngoal = \"displacement\"\nvary = [\"strength\"]\nstrength_t = { min = 0.02, max = 0.5 }\n";
    sandbox.write("brief.toml", &format!("{TILE}{design}{PLANE}{one}{other}"));
    let said = sandbox.run(&["design", "brief.toml", "-o", "better.toml", "--format", "json"]);
    // Two tiles decouple little, which is status 1.
    assert_eq!(said.status, 1, "{}", said.stderr);
    let found: serde_json::Value = serde_json::from_str(&said.stdout).expect("JSON");
    let after = &found["after"]["displacement_rmse_mm"];
    for (axis, written_mm) in ["x", "y", "z"].into_iter().zip(errors_mm("better.toml")) {
        assert!((number(&after[axis]) / written_mm - 1.0).abs() < 1e-6, "{axis}: {written_mm} {found}");
    }
    let symmetric = design.replace("[design]", "[design]\nsymmetry = \"mirror\"");
    let tilted = PLANE.replace("[0, 0, -1]", "[0.1, 0, -1]").replace("1.25", "3");
    sandbox.write(
        "tilted.toml",
        &format!(
            "{TILE}{symmetric}{tilted}{}",
            one.replace("[-1.7, 0,", "[0, 0,").replace("[0.1, 0.1, 0]", "[0, 0, 0.1]")
        ),
    );
    sandbox
        .run(&["design", "tilted.toml", "-o", "b.toml"])
        .refuses("is not parallel to the film and breaks its symmetry");
}

/// The film before a plate with recoil: the change is that of the layout with the images as
/// magnets, where these are as strong and as permeable.
#[test]
fn recoil_before_iron_is_that_of_the_images_as_magnets() {
    let sandbox = Sandbox::new();
    let material = "[material]\nrecoil_permeability = 1.2\nrecoil_error = 0.01\n";
    let iron = PLANE.replace("relative_permeability = 3\n", "");
    let own = tile("a", 0.5, [0.2, 0.1, 0.4]);
    sandbox.write("plane.toml", &format!("{TILE}{material}{iron}{own}"));
    sandbox.write("image.toml", &format!("{TILE}{material}{own}{}", tile("image", 2.0, [-0.2, -0.1, 0.4])));
    let b_t = |layout: &str| {
        let said = sandbox.run(&["field", layout, "--at", "0,0,-4", "--format", "csv"]);
        assert_eq!(said.status, 0, "{}", said.stderr);
        rows(&said.stdout)[0][3..6].to_vec()
    };
    // Without a volume the points around the tile count that are before the iron.
    sandbox.write("lone.toml", &format!("format = 1\nname = \"lone\"\n{material}{iron}{own}"));
    assert_eq!(b_t("lone.toml").len(), 3);
    // Both are known to a hundredth of the change by recoil, which is some per cent of B.
    for (with_plane, with_image) in b_t("plane.toml").into_iter().zip(b_t("image.toml")) {
        assert!((with_plane / with_image - 1.0).abs() < 1e-3, "{with_plane} {with_image}");
    }
}

/// Tiles of a film glued on iron reach into it in samples and in a diagnosis. Both are written with
/// the depth allowed, and `tolerance` reports the depth.
#[test]
fn films_as_made_on_iron_are_written() {
    let sandbox = Sandbox::new();
    let published = std::fs::read_to_string(shipped("published-film")).expect("readable");
    let plate = "[[plane]]\npoint_mm = [0, 0, 1]\nnormal = [0, 0, -1]\n";
    sandbox.write("film.toml", &format!("{published}\n{plate}[tolerance]\nposition_mm = 0.03\nsamples = 20\n"));
    let said = sandbox.run(&["tolerance", "film.toml"]);
    assert!(said.stdout.contains("tiles of the first samples reach up to 0.1"), "{}", said.stdout);
    let sample = ["tolerance", "sample", "film.toml", "--scan", "scan.csv", "-o", "made.toml"];
    let said = sandbox.run(&sample);
    assert_eq!(said.status, 0, "{}", said.stderr);
    assert_eq!(sandbox.run(&["field", "made.toml", "--at", "0,0,-4"]).status, 0);
    let said = sandbox.run(&["diagnose", "film.toml", "--scan", "scan.csv", "-o", "found.toml"]);
    assert_eq!(said.status, 0, "{}", said.stderr);
    assert!(sandbox.read("made.toml").contains("overlap_mm = 0."), "{}", &sandbox.read("made.toml")[..300]);
    let reversed = plate.replace("-1]", "1]");
    sandbox.write("reversed.toml", &format!("{published}\n{reversed}"));
    sandbox.run(&["check", "reversed.toml"]).refuses("all tiles are behind the plane: reverse normal");
}

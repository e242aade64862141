//! Working volumes without extent along some axes: planes, lines and points.

use serde_json::Value;

use crate::{Sandbox, shipped};

/// The published film over the volume `x_mm`, `y_mm`, `z_mm`.
fn film(sandbox: &Sandbox, [x, y, z]: [&str; 3], tables: &str) {
    let text = std::fs::read_to_string(shipped("published-film")).expect("a shipped film");
    let (head, rest) = text.split_once("[volume]").expect("a volume");
    let (_, tiles) = rest.split_once("\n[").expect("a table after the volume");
    let tiles = format!("[{tiles}");
    let (_, tiles) = tiles.split_once("\n[[").expect("tiles");
    let volume = format!("[volume]\nx_mm = {x}\ny_mm = {y}\nz_mm = {z}\nstep_mm = 0.5\n");
    sandbox.write("film.toml", &format!("{head}{volume}{tables}\n[[{tiles}"));
}

fn json(sandbox: &Sandbox, arguments: &[&str]) -> Value {
    let said = sandbox.run(arguments);
    assert_eq!(said.status, 0, "{arguments:?}: {}", said.stderr);
    serde_json::from_str(&said.stdout).unwrap_or_else(|error| panic!("{arguments:?}: {error}: {}", said.stdout))
}

const PLANE: [&str; 3] = ["[-2, 2]", "[-2, 2]", "[-4, -4]"];
const LINE: [&str; 3] = ["[-2, 2]", "[0, 0]", "[-4, -4]"];
const POINT: [&str; 3] = ["[0, 0]", "[0, 0]", "[-4, -4]"];

#[test]
fn planes_lines_and_points_are_volumes() {
    let sandbox = Sandbox::new();
    for (volume, points) in [(PLANE, 81), (LINE, 9), (POINT, 1), (["[0, 0]", "[-2, 2]", "[-5, -3]"], 45)] {
        film(&sandbox, volume, "[tolerance]\npreset = \"workshop\"\nsamples = 10\n");
        let field = sandbox.run(&["field", "film.toml"]);
        assert_eq!((field.status, field.stderr.as_str(), field.stdout.lines().count()), (0, "", points + 1));
        let found = json(&sandbox, &["decouple", "film.toml", "--format", "json"]);
        assert_eq!(found["points"], points);
        for (parameter, own) in [("r_x", 0), ("r_y", 1), ("s_z", 2)] {
            // A plane normal to the axis has points where another axis has an extent.
            let has_points =
                (0..3).any(|axis| axis != own && !volume[axis].starts_with("[0") && volume[axis] != "[-4, -4]");
            assert_eq!(found["uniformity_rmse"][parameter].is_number(), has_points, "{volume:?} {parameter}: {found}");
        }
        for verb in ["compare", "tolerance", "plan", "budget"] {
            let said = sandbox.run(&[verb, "film.toml"]);
            assert_eq!(said.status, 0, "{verb} {volume:?}: {}", said.stderr);
            assert!(!said.stdout.contains("NaN") && !said.stdout.contains("inf"), "{verb}: {}", said.stdout);
        }
        let checked = sandbox.run(&["check", "film.toml"]);
        assert_eq!(checked.status, 0, "{}", checked.stdout);
    }
}

/// The numbers of a plane are those of the plane in a thicker volume.
#[test]
fn clearance_of_a_plane_is_its_distance() {
    let sandbox = Sandbox::new();
    for (z, clearance) in [("[-4, -4]", 4.0), ("[0.25, 0.25]", -0.25)] {
        film(&sandbox, ["[-2, 2]", "[-2, 2]", z], "[expect]\nclearance_mm = { min = -1 }\n");
        let found = sandbox.run(&["check", "film.toml", "--format", "json"]);
        let found: Value = serde_json::from_str(&found.stdout).expect("JSON");
        let value = found["layouts"][0]["expectations"][0]["value"].as_f64().unwrap_or_else(|| panic!("{found}"));
        assert!((value - clearance).abs() < 1e-12, "{value}, not {clearance}");
    }
}

#[cfg(feature = "report")]
#[test]
fn reports_of_planes_have_every_figure() {
    let sandbox = Sandbox::new();
    film(&sandbox, PLANE, "");
    let said = sandbox.run(&["report", "film.toml", "-o", "plane", "-q"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    film(&sandbox, POINT, "");
    let said = sandbox.run(&["report", "film.toml", "-o", "point", "-q"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    for folder in ["plane", "point"] {
        for entry in std::fs::read_dir(sandbox.path(folder)).expect("a folder") {
            let path = entry.expect("an entry").path();
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            assert!(!text.contains("NaN,") && !text.contains("=\"NaN"), "{}", path.display());
        }
    }
}

/// Verbs that need an extent say so.
#[test]
fn verbs_that_need_an_extent_name_it() {
    let sandbox = Sandbox::new();
    sandbox.write("b.csv", "bx_mt,by_mt,bz_mt\n0,0,2\n");
    film(&sandbox, PLANE, "");
    let read = ["read", "b.csv", "--layout", "film.toml"];
    assert_eq!(sandbox.run(&read).status, 0);
    let header = ["export", "film.toml", "--to", "c-header", "-o", "film.h"];
    sandbox.run(&header).refuses("the volume has no extent along z");
    film(&sandbox, POINT, "");
    sandbox.run(&read).refuses("[volume] is a point");
    film(&sandbox, ["[2, -2]", "[0, 0]", "[0, 0]"], "");
    sandbox.run(&["field", "film.toml"]).refuses("x_mm = [2, -2] is inverted");
}

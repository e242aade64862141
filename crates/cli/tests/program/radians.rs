//! Angles in radians under keys in degrees are findings of `check`, and warnings of other verbs.

use serde_json::Value;

use crate::Sandbox;

const HEAD: &str = "format = 1\nname = \"film\"\n";
const TILE: &str =
    "[[tile]]\nname = \"a\"\nposition_mm = [2.5, 2.5, 0.5]\nsize_mm = [3.3, 3.3, 1]\nstrength_t = 0.12\n";

/// The findings of `check` about a tile with these keys.
fn findings(keys: &str) -> Vec<String> {
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", &format!("{HEAD}{TILE}{keys}\n"));
    let said = sandbox.run(&["check", "film.toml", "--format", "json"]);
    let json: Value = serde_json::from_str(&said.stdout).unwrap_or_else(|_| panic!("{}", said.stderr));
    let findings = json["layouts"][0]["findings"].as_array().unwrap_or_else(|| panic!("{json}"));
    assert_eq!(said.status, i32::from(!findings.is_empty()), "{}", said.stdout);
    findings.iter().map(|finding| finding.as_str().expect("a text").to_owned()).collect()
}

#[test]
fn fractions_of_pi_are_findings_wherever_an_angle_is_read() {
    for (keys, found) in [
        ("direction_deg = 0.7854", "tile \"a\": direction_deg = 0.7854 is pi/4 in radians: did you mean 45 degrees?"),
        ("direction_deg = -1.5708", "direction_deg = -1.5708 is -pi/2 in radians: did you mean -90 degrees?"),
        ("direction_deg = 30\ntilt_deg = 0.5236", "tilt_deg = 0.5236 is pi/6 in radians: did you mean 30 degrees?"),
        (
            "direction_deg = 30\nrotation = { axis = [0, 0, 1], angle_deg = 3.1416 }",
            "rotation.angle_deg = 3.1416 is pi in radians: did you mean 180 degrees?",
        ),
        (
            "direction_deg = 30\nrotation = { euler_deg = [10, 1.0472, 20], order = \"xyz\" }",
            "rotation.euler_deg[1] = 1.0472 is pi/3 in radians: did you mean 60 degrees?",
        ),
    ] {
        let all = findings(keys);
        assert!(all.len() == 1 && all[0].ends_with(found), "{found:?} is not in {all:?}");
    }
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", &format!("{HEAD}{TILE}direction_deg = 2.0944\n"));
    let said = sandbox.run(&["tiles", "film.toml"]);
    let warning = "magsplice: warning: film.toml: tile \"a\": direction_deg = 2.0944 is 2 pi/3 in radians";
    assert!(said.status == 0 && said.stderr.starts_with(warning), "{}", said.stderr);
}

#[test]
fn parts_of_the_stock_are_angles_too() {
    let sandbox = Sandbox::new();
    let film = "[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.12\n[volume]\nx_mm = [-2, 2]\n\
        y_mm = [-2, 2]\nz_mm = [-5, -3]\nstep_mm = 1\n[design]\nvary = [\"size\", \"position\"]\n\
        stock = [{ size_mm = [3.3, 1.7], direction_deg = 1.5708 }]\n";
    sandbox.write("film.toml", &format!("{HEAD}{TILE}direction_deg = 30\n{film}"));
    let said = sandbox.run(&["check", "film.toml"]);
    let finding = "FINDING  design: stock[0].direction_deg = 1.5708 is pi/2 in radians: did you mean 90 degrees?";
    assert!(said.status == 1 && said.stdout.contains(finding), "{}", said.stdout);
}

#[test]
fn usual_angles_are_no_findings() {
    for angle in ["0.785", "3.14", "45", "-90", "39.27", "0.01", "12.57", "0.7853", "1e-3"] {
        assert_eq!(findings(&format!("direction_deg = {angle}")), [""; 0], "{angle}");
    }
}

#[test]
fn imported_angles_are_checked_in_the_unit_of_their_column() {
    let import = |column: &str| {
        let sandbox = Sandbox::new();
        let head = "x_mm,y_mm,z_mm,dx_mm,dy_mm,dz_mm,jx_t,jy_t,jz_t";
        sandbox.write("blocks.csv", &format!("{head},{column}\n0,0,0,1,1,1,0,0,1,0.7854\n"));
        let said = sandbox.run(&["import", "blocks.csv", "-o", "film.toml"]);
        assert_eq!(said.status, 0, "{}", said.stderr);
        said.stderr
    };
    assert!(import("rz_deg").contains("is pi/4 in radians: did you mean 45 degrees?"));
    assert!(!import("rz_rad").contains("radians"));
}

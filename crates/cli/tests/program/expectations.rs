//! Bounds of `[expect]` that say nothing, that no film has, or that are in another unit: refused,
//! or findings of `check`.

use serde_json::Value;

use crate::Sandbox;

const FILM: &str = "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.12\n\
    [volume]\nx_mm = [-2, 2]\ny_mm = [-2, 2]\nz_mm = [-5, -3]\nstep_mm = 1\n\
    [[tile]]\nposition_mm = [2.5, 2.5, 0.5]\nsize_mm = [3.3, 3.3, 1]\nstrength_t = 0.12\ndirection = [1, 1, 0]\n\
    mirror = { axes = [\"x\", \"y\"] }\n";

/// The findings of `check` about a film with these keys in a table.
fn findings(table: &str, keys: &str) -> Vec<String> {
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", &format!("{FILM}[{table}]\n{keys}\n"));
    let said = sandbox.run(&["check", "film.toml", "--format", "json"]);
    let json: Value = serde_json::from_str(&said.stdout).unwrap_or_else(|_| panic!("{}", said.stderr));
    let findings = json["layouts"][0]["findings"].as_array().expect("a list");
    // An expectation that is not met has the same status.
    assert!(findings.is_empty() || said.status == 1, "{}", said.stdout);
    findings.iter().map(|finding| finding.as_str().expect("a text").to_owned()).collect()
}

/// Asserts that these keys lead to one finding, which begins so.
#[track_caller]
fn found(table: &str, keys: &str, message: &str) {
    let found = findings(table, keys);
    assert!(found.len() == 1 && found[0].starts_with(message), "{message:?} is not in {found:?}");
}

#[test]
fn clearance_below_zero_is_a_finding() {
    found(
        "expect",
        "clearance_mm = { min = -0.5 }",
        "expect: clearance_mm.min = -0.5 lets tiles reach 0.5 mm into the working volume, in the way of the sensor: give \
         at least 0",
    );
    for least in ["0", "-0.0", "3"] {
        assert_eq!(findings("expect", &format!("clearance_mm = {{ min = {least} }}")), [""; 0], "{least}");
    }
}

#[test]
fn bounds_that_every_film_keeps_are_findings() {
    let uniformity = |key: &str| format!("uniformity_rmse = {{ {key} }}");
    found(
        "expect",
        &uniformity("r_x = 65"),
        "expect: uniformity_rmse.r_x = 65 is met by every film: it bounds an angle",
    );
    found("expect", &uniformity("s_z = 4.2"), "expect: uniformity_rmse.s_z = 4.2 is met by almost every film");
    let displacement = |key: &str| format!("displacement_rmse_mm = {{ {key} }}");
    found(
        "expect",
        &displacement("x = 250"),
        "expect: displacement_rmse_mm.x = 250 is met by every film: it is not below half the wavelength, 5 mm; did you \
         mean 0.25 mm, which is 250 um?",
    );
    found("expect", &displacement("z = 320"), "expect: displacement_rmse_mm.z = 320 is met by almost every film");
    found(
        "expect",
        "amplitude = { min = -0.5 }",
        "expect: amplitude.min = -0.5 is also met by a film that is reversed",
    );
    for keys in [uniformity("r_x = 3, s_z = 3"), displacement("x = 4.9, y = 4.9, z = 4.9")] {
        assert_eq!(findings("expect", &keys), [""; 0], "{keys}");
    }
}

#[test]
fn amplitudes_in_percent_are_findings() {
    found(
        "expect",
        "amplitude = { min = 65 }",
        "expect: amplitude.min = 65 is a fraction of the ideal film's field, so 6500 %: did you mean 0.65?",
    );
    let design = "vary = [\"direction\"]\namplitude = { min = 82.5 }";
    found("design", design, "design: amplitude.min = 82.5 is a fraction of the ideal film's field, so 8250 %");
    assert_eq!(findings("expect", "amplitude = { min = 10 }"), [""; 0]);
}

#[test]
fn bounds_that_no_film_has_are_refused() {
    for (keys, message) in [
        (
            "uniformity_rmse = { r_x = -0.1 }",
            "expect: uniformity_rmse.r_x = -0.1, must be a finite number of at least 0",
        ),
        (
            "displacement_rmse_mm = { z = -1 }",
            "expect: displacement_rmse_mm.z = -1, must be a finite number of at least 0",
        ),
        ("amplitude = { min = 0.9, max = 0.8 }", "unknown field `max`, expected `min`"),
        ("clearance_mm = { min = nan }", "expect: clearance_mm.min = NaN, must be a finite number"),
        (
            "field = { file = \"b.csv\", within = -1e-9 }",
            "expect: field.within = -0.000000001, must be a finite number",
        ),
    ] {
        let sandbox = Sandbox::new();
        sandbox.write("film.toml", &format!("{FILM}[expect]\n{keys}\n"));
        sandbox.run(&["check", "film.toml"]).refuses(message);
    }
}

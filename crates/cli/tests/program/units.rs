//! Numbers with units on the command line.

use serde_json::Value;

use crate::{RunOutput, Sandbox, shipped};

/// A search of one start with few points; `options` replace the wavelength and the film.
fn splice(options: &[&str]) -> (Sandbox, RunOutput) {
    let sandbox = Sandbox::new();
    let fixed = ["splice", "--starts", "1", "--parts", "2", "-o", "film.toml", "-q"];
    let said = sandbox.run(&[&fixed[..], options].concat());
    (sandbox, said)
}

#[test]
fn units_and_bare_numbers_are_the_same_film() {
    let film = |options: &[&str]| {
        let (sandbox, said) = splice(options);
        assert!(said.status < 2, "{}", said.stderr);
        let layout: toml::Table = toml::from_str(&sandbox.read("film.toml")).expect("TOML");
        // Without the history, which tells the time that the search took or the arguments.
        ["ideal", "volume", "tile"].map(|key| layout[key].to_string())
    };
    let bare = film(&[
        "--wavelength",
        "8",
        "--film",
        "8x8",
        "--thickness",
        "1",
        "--remanence",
        "0.12",
        "--range",
        "3x3",
        "--distance",
        "2.4..3.9",
        "--smallest-cut",
        "0.8",
        "--gap",
        "0.1",
    ]);
    let with_units = film(&[
        "--wavelength",
        "8mm",
        "--film",
        "8mmx0.8cm",
        "--thickness",
        "1000µm",
        "--remanence",
        "120mT",
        "--range",
        "3x3mm",
        "--distance",
        "-3.9mm..-2.4mm",
        "--smallest-cut",
        "8e-4m",
        "--gap",
        "100um",
    ]);
    assert_eq!(bare, with_units);
    assert!(bare[1].contains("-3.9") && bare[1].contains("-2.4"), "{}", bare[1]);
}

#[test]
fn wrong_units_are_named() {
    let refused = |options: &[&str], message: &str| splice(options).1.refuses_arguments(message);
    let length = "must be a length in mm, cm, m, um, nm, in, mil; a number without a unit is in mm";
    refused(
        &["--wavelength", "8kg"],
        &format!("invalid value '8kg' for '--wavelength <LENGTH>': has the unit kg, {length}"),
    );
    refused(&["--wavelength", "8mT"], &format!("has the unit mT, {length}"));
    refused(&["--wavelength", "8", "--film", "16x16ft"], &format!("has the unit ft, {length}"));
    refused(
        &["--wavelength", "8", "--film", "16mmx16"],
        "has a unit for the first length only, must have it at the end, as in 16x16mm",
    );
    refused(
        &["--wavelength", "8", "--film", "16"],
        "must be two lengths with an x between them, such as 20x20 or 20mmx20mm",
    );
    refused(
        &["--wavelength", "8", "--film", "16x16", "--remanence", "0.12A/m"],
        "has the unit A/m, must be a flux density in T, mT, uT, nT, G",
    );
    refused(&["--wavelength", "8", "--film", "16x16", "--distance", "3mm"], "must be two lengths with .. between them");
    refused(
        &["--wavelength", "eight"],
        "must be a number with or without a unit (mm, cm, m, um, nm, in, mil), such as 8mm or 8",
    );
}

/// A negative number is a value that breaks a rule, not an unknown option.
#[test]
fn negative_numbers_are_no_options() {
    for options in [
        &["--wavelength", "-8", "--film", "16x16"][..],
        &["--wavelength", "8", "--film", "-16x16"],
        &["--wavelength", "8", "--film", "16x16", "--thickness", "-1mm"],
        &["--wavelength", "8", "--film", "16x16", "--gap", "-0.1"],
        &["--wavelength", "8", "--film", "16x16", "--distance", "-3..5"],
        &["--wavelength", "8", "--film", "16x16", "--amplitude", "-0.5"],
    ] {
        let (_, said) = splice(options);
        assert!(said.status == 2 && !said.stderr.contains("unexpected argument"), "{}", said.stderr);
        assert!(said.stderr.contains("must be"), "{options:?}: {}", said.stderr);
    }
}

#[test]
fn tolerances_take_both_signs_for_micro() {
    let sandbox = Sandbox::new();
    let film = shipped("published-film");
    let accuracy = |within: &str| {
        let said = sandbox.run(&["compare", &film, "--within", within, "--format", "json"]);
        assert_eq!(said.status, 0, "{within}: {}", said.stderr);
        let json: Value = serde_json::from_str(&said.stdout).expect("JSON");
        json["accuracy"].clone()
    };
    for within in ["0.1uT", "0.1µT", "0.1μT", "0.1 µT", "100nT", "1e-7T"] {
        assert_eq!(accuracy(within), serde_json::json!({ "absolute_t": 1e-7 }), "{within}");
    }
    assert_eq!(accuracy("1e-7"), serde_json::json!({ "relative": 1e-7 }));
    sandbox
        .run(&["compare", &film, "--within", "1mm"])
        .refuses_arguments("has the unit mm, must be a flux density in T, mT,");
    for (within, fraction) in [("5%", "0.05"), ("10 %", "0.1"), ("0.1%", "0.001"), ("%", "0.05")] {
        let said = sandbox.run(&["compare", &film, "--within", within]);
        said.refuses_arguments(&format!(
            "a fraction of |B| is written without a unit: {fraction}; it must be below 0.1. A field has a unit (T, mT, \
             uT, nT), as in 10nT"
        ));
    }
    sandbox.run(&["compare", &film, "--within", "1kT"]).refuses_arguments(
        "has the unit kT, must be a flux density in T, mT, uT, nT, G, mG, kG, Oe, mOe, kOe; a number without a unit is a \
         fraction of |B|",
    );
    sandbox.run(&["compare", &film, "--within", "-1nT"]).refuses_arguments("for '--within <TOLERANCE>'");
}

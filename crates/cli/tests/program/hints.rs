//! Messages that say what was probably meant.

use crate::Sandbox;

const HEAD: &str = "format = 1\nname = \"t\"\n";
const TILE: &str = "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";

#[track_caller]
pub(crate) fn hinted(text: &str, hint: &str) {
    let sandbox = Sandbox::new();
    sandbox.write("t.toml", text);
    let said = sandbox.run(&["check", "t.toml"]);
    said.refuses(hint);
    assert!(said.stdout.contains("TOML parse error"), "the place is shown too: {}", said.stdout);
}

#[test]
fn near_misses_of_keys_are_recognized() {
    for (from, to, hint) in [
        ("[[tile]]", "[[tiles]]", "did you mean `tile`?"),
        ("position_mm", "position", "did you mean `position_mm`, in mm?"),
        ("size_mm", "sizes_mm", "did you mean `size_mm`?"),
        ("size_mm", "size_m", "did you mean `size_mm`, in mm?"),
        ("polarization_t", "polarisation_t", "did you mean `polarization_t`?"),
        ("polarization_t", "magnetization_t", "give polarization_t, the polarization J = mu0 M in tesla"),
        ("polarization_t", "magnetisation", "a magnetization M of 955 kA/m is 1.2 T"),
    ] {
        hinted(&format!("{HEAD}{}", TILE.replace(from, to)), hint);
    }
    let ideal = "[ideal]\nwavelenght_mm = 10\nthickness_mm = 1\namplitude_t = 1\n";
    hinted(&format!("{HEAD}{TILE}{ideal}"), "did you mean `wavelength_mm`?");
    hinted(&format!("{HEAD}{TILE}[volum]\nx_mm = [0, 1]\n"), "did you mean `volume`?");
    let volume = "[volume]\nx_mm = [-2, 2]\ny_mm = [-2, 2]\nz_mm = [-5, -3]\nstep_mm = 1\n";
    let design = "[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 1\n[design]\nvary = [\"sizes\"]\n";
    hinted(&format!("{HEAD}{TILE}{volume}{design}"), "did you mean \"size\"?");
}

#[test]
fn missing_and_malformed_values_get_the_sentence_that_helps() {
    hinted(&HEAD.replace("format = 1\n", ""), "missing field `format`, as in `format = 1`");
    hinted("format = 1\n", "missing field `name`, as in `name = \"my film\"`");
    let rotated = format!("{HEAD}{TILE}rotation = ");
    let hint = "`rotation = { axis = [0, 0, 1], angle_deg = 30 }`";
    for value in ["[0, 0, 30]", "30", "[\n  0, 0,\n  30]"] {
        hinted(&format!("{rotated}{value}\n"), hint);
    }
    let sandbox = Sandbox::new();
    sandbox.write("t.toml", &format!("{rotated}{{ axis = [0, 0, 1] }}\n"));
    sandbox.run(&["tiles", "t.toml"]).refuses("line 3: tile \"tile-1\": rotation has axis without an angle_deg");
    hinted(&format!("{HEAD}{}", TILE.replace("[[tile]]", "[tile]")), "write [[tile]] with two brackets");
}

#[test]
fn verbs_for_films_say_what_they_are_for() {
    let sandbox = Sandbox::new();
    sandbox.write("t.toml", &format!("{HEAD}{TILE}"));
    for (verb, purpose) in
        [("compare", "`magsplice compare` compares the field"), ("decouple", "`magsplice decouple` evaluates")]
    {
        let said = sandbox.run(&[verb, "t.toml"]);
        said.refuses("t.toml: the layout has no [ideal] table, which this needs");
        said.refuses(purpose);
        said.refuses("use `magsplice field t.toml`");
    }
}

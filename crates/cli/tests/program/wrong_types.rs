//! Values of a wrong type in layouts: the message says which form the key wants.

use crate::Sandbox;
use crate::hints::hinted;

const HEAD: &str = "format = 1\nname = \"t\"\n";
const TILE: &str = "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
const IDEAL: &str = "[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.12\n";
const VOLUME: &str = "[volume]\nx_mm = [-2, 2]\ny_mm = [-2, 2]\nz_mm = [-5, -3]\nstep_mm = 1\n";

/// Words of the parser and of its types, which no message has.
const FOREIGN: [&str; 12] = [
    "f64",
    "i64",
    "usize",
    "u64",
    "struct",
    "Table",
    "array of length",
    "sequence",
    "a map",
    "path string",
    "wanted string",
    "floating point",
];

/// Asserts the message about a layout, and that it is in the words of the format.
#[track_caller]
fn told(text: &str, form: &str) {
    hinted(text, form);
    let sandbox = Sandbox::new();
    sandbox.write("t.toml", text);
    let said = sandbox.run(&["check", "t.toml"]).stdout;
    for word in FOREIGN {
        assert!(!said.contains(word), "{word}: {said}");
    }
}

fn tile(keys: &str) -> String {
    format!("{HEAD}{TILE}{keys}\n")
}

/// A layout with another value of a key of the tile.
fn with(key: &str, value: &str) -> String {
    let lines = TILE.lines().map(|line| match line.split_once(" = ") {
        Some((own, _)) if own == key => format!("{key} = {value}\n"),
        _ => format!("{line}\n"),
    });
    format!("{HEAD}{}", lines.collect::<String>())
}

fn strength(value: &str) -> String {
    let keys = format!("direction = [1, 0, 0]\nstrength_t = {value}");
    format!("{HEAD}{}", TILE.replace("polarization_t = [0, 0, 1]", &keys))
}

#[test]
fn numbers_where_lists_are_wanted() {
    let three = "size_mm is a list of three numbers in mm, not a string, as in `size_mm = [3.3, 1.7, 1.0]`";
    told(&with("size_mm", "\"1\""), three);
    told(&with("size_mm", "\"3.3 mm\""), three);
    told(&with("size_mm", "\"3.3, 1.7, 1\""), "not a string: write `size_mm = [3.3, 1.7, 1]`");
    told(&with("size_mm", "1"), "size_mm is a list of three numbers in mm, not a number, as in `size_mm = [");
    told(&with("position_mm", "true"), "position_mm is a list of three numbers in mm, not true or false, as in");
    told(&with("position_mm", "{ x = 1 }"), "position_mm is a list of three numbers in mm, not a table, as in");
    told(&with("polarization_t", "[0, 1]"), "polarization_t is a list of three numbers in tesla, not a list of 2");
    told(&with("polarization_t", "0.12"), "Or give its magnitude as strength_t, with a direction");
    told(
        &with("size_mm", "[1, \"2 cm\", 1]"),
        "each value of size_mm is a number in mm, without quotes and unit: write 20",
    );
    told(&tile("rotation = { matrix = 3 }"), "matrix is a list of three rows, each of three numbers, not a number");
    told(&tile("rotation = { euler_deg = 30, order = \"xyz\" }"), "euler_deg is a list of three numbers in degrees");
    told(&tile("rotation = { axis = \"z\", angle_deg = 30 }"), "write `axis = [0, 0, 1]`");
    told(&tile("rotation = { axis = \"x\", angle_deg = 30 }"), "write `axis = [1, 0, 0]`");
    told(&tile("grid = { count = 3, pitch_mm = [1, 1, 1] }"), "count is a list of three integers, not a number, as in");
    told(&tile("mirror = { axes = \"y\" }"), "write `axes = [\"y\"]`");
    told(
        &format!("{HEAD}{TILE}{}", VOLUME.replace("[-2, 2]\ny", "2\ny")),
        "x_mm is a list of two numbers in mm, not a number",
    );
    let step = "step_mm is one number in mm, or a list of three, one along each axis";
    told(&format!("{HEAD}{TILE}{}", VOLUME.replace("step_mm = 1", "step_mm = \"1\"")), step);
    let lattice = "[[lattice]]\nstart_mm = [0, 0, 0]\nheight_mm = 1\nstrength_t = 0.1\nx = ";
    told(&format!("{HEAD}{lattice}[3.3]"), "each value of x is a table, not a number");
    told(&format!("{HEAD}{lattice}3.3"), "x is a list of tables, not a number, as in `x = [{ widths_mm = [");
    told(&format!("{HEAD}{lattice}[{{ widths_mm = 3.3, pattern = [1] }}]"), "write `widths_mm = [3.3]`");
    let design = format!("{HEAD}{TILE}{IDEAL}{VOLUME}[design]\nvary = ");
    told(&format!("{design}\"size\""), "vary is a list, not a string: write `vary = [\"size\"]`");
    told(&format!("{design}[3]"), "each value of vary is a word in quotes, not a number");
}

#[test]
fn other_values_where_numbers_are_wanted() {
    told(&strength("\"200 mT\""), "strength_t is a number in tesla, without quotes and unit: write 0.2");
    told(&strength("\"strong\""), "strength_t is a number in tesla, not a string");
    told(
        &strength("[0, 0, 1]"),
        "strength_t is one number in tesla, not a list, as in `strength_t = 0.12`\nMagnitude of the polarization",
    );
    told(&strength("true"), "strength_t is one number in tesla, not true or false");
    told(&format!("{HEAD}{TILE}{}", IDEAL.replace("10", "[10]")), "wavelength_mm is one number in mm, not a list");
    told(&tile("grid = { count = [1, -2, 1], pitch_mm = [1, 1, 1] }"), "an integer, at least 0");
    told(
        &tile("grid = { count = [1, 2.5, 1], pitch_mm = [1, 1, 1] }"),
        "each value of count is an integer, at least 0, not 2.5",
    );
    told(&tile("").replace("format = 1", "format = \"1\""), "format is an integer, without quotes: write 1");
    told(&tile("name = 3"), "name is a string in quotes: write `name = \"3\"`");
    told(&tile("name = [3]"), "name is a string in quotes, not a list");
}

#[test]
fn other_values_where_tables_are_wanted() {
    told(
        &tile("rotation = [0, 0, 30]"),
        "rotation is a table, not a list, as in `rotation = { axis = [0, 0, 1], angle_deg = 30 }`",
    );
    told(&tile("mirror = \"y\""), "write `mirror = { axes = [\"y\"] }`");
    told(&tile("grid = 3"), "grid is a table, not a number, as in `grid = { count = [4, 4, 1], ");
    told(
        &tile("volume = 3").replace("volume = 3\n", "").replace("[[tile]]", "volume = 3\n[[tile]]"),
        "begin it with the line [volume]",
    );
    let expect = |keys: &str| format!("{HEAD}{TILE}{IDEAL}{VOLUME}[expect]\n{keys}\n");
    told(&expect("clearance_mm = 3.0"), "clearance_mm is a table, not a number: write `clearance_mm = { min = 3 }`");
    told(&expect("clearance_mm = \"3\""), "clearance_mm is a table, not a string: write `clearance_mm = { min = 3 }`");
    told(&expect("amplitude = { min = \"0.8\" }"), "min is a number, without quotes: write 0.8");
    told(
        &expect("uniformity_rmse = 0.05"),
        "uniformity_rmse is a table, not a number, as in `uniformity_rmse = { r_x = ",
    );
    told(&expect("field = \"a.csv\""), "field is a table, not a string, as in `field = { file = ");
    told(&expect("field = { file = 3, within = 1e-9 }"), "file is a string in quotes: write `file = \"3\"`");
    let design = format!("{HEAD}{TILE}{IDEAL}{VOLUME}[design]\nvary = [\"size\"]\n");
    told(&format!("{design}thickness_mm = 1"), "thickness_mm is a table, not a number, as in `thickness_mm = { min = ");
    told(&format!("{design}goal = 3"), "goal is a word in quotes, not a number");
}

//! Files that the program writes are read where a file of their content is read.

#[cfg(feature = "report")]
use std::fs;

use crate::{RunOutput, Sandbox};

/// A film with every table, and few points.
const TABLES: &str = "\n[sensor]\npart = \"MLX90393\"\n\
    [elastomer]\narea_mm2 = 400\nthickness_mm = 7\nyoungs_modulus_mpa = 0.1\npoisson_ratio = 0.45\n\
    [tolerance]\npreset = \"jig\"\n";

fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.published_with(TABLES);
    sandbox
}

#[track_caller]
fn works(said: &RunOutput) {
    assert!(said.status == 0, "{}", said.stderr);
}

/// The verbs that read points, readings, scans and forces.
fn points(file: &str) -> Vec<&str> {
    vec!["field", "film.toml", "--points", file, "-q"]
}

fn readings(file: &str) -> Vec<&str> {
    vec!["read", file, "--layout", "film.toml", "-q"]
}

fn scan(file: &str) -> Vec<&str> {
    vec!["scan", file, "--layout", "film.toml", "--fit", "strength", "-q"]
}

#[test]
fn tables_of_results_are_read() {
    let sandbox = sandbox();
    works(&sandbox.run(&["field", "film.toml", "-o", "b.csv"]));
    works(&sandbox.run(&["field", "film.toml", "--quantity", "h", "-o", "h.csv"]));
    works(&sandbox.run(&["field", "film.toml", "--quantity", "j", "-o", "j.csv"]));
    works(&sandbox.run(&["field", "film.toml", "--quantity", "gradient", "-o", "gradient.csv"]));
    works(&sandbox.run(&["decouple", "film.toml", "-o", "decouple.csv"]));
    works(&sandbox.run(&["resolution", "film.toml", "-o", "resolution.csv"]));
    works(&sandbox.run(&["experiment", "film.toml", "-o", "experiment.csv"]));
    works(&sandbox.run(&["scan", "b.csv", "--layout", "film.toml", "--fit", "strength", "--save", "saved.csv"]));
    for file in ["b.csv", "h.csv", "j.csv", "gradient.csv", "decouple.csv", "resolution.csv", "saved.csv"] {
        works(&sandbox.run(&points(file)));
    }
    for file in ["b.csv", "h.csv", "decouple.csv", "saved.csv", "experiment.csv"] {
        works(&sandbox.run(&readings(file)));
    }
    for file in ["b.csv", "h.csv", "decouple.csv", "saved.csv"] {
        works(&sandbox.run(&scan(file)));
    }
    works(&sandbox.run(&["calibrate", "experiment.csv", "--layout", "film.toml", "-q"]));
    // B of both is the same, as far as mu0 is that of the vacuum.
    let [b, h] = ["b.csv", "h.csv"].map(|file| crate::rows(&sandbox.run(&readings(file)).stdout));
    let near = b.iter().zip(&h).all(|(b, h)| (1..4).all(|axis| (b[axis] - h[axis]).abs() < 1e-9));
    assert!(near && b.len() > 10);
}

#[test]
fn orders_and_plans_are_read() {
    let sandbox = sandbox();
    sandbox.write("two.toml", TWO_TILES);
    works(&sandbox.run(&["forces", "two.toml", "--order", "given", "-o", "order.csv"]));
    works(&sandbox.run(&["forces", "two.toml", "--order", "order.csv", "-q"]));
    let tiles = "tile,strength_t,direction_deg,tilt_deg\na,0.1,0,90\nb,0.102,0,89\nc,,,\n";
    sandbox.write("tiles.csv", tiles);
    let assign = ["assign", "two.toml", "--measured", "tiles.csv", "-o", "assigned.toml", "--plan", "plan.csv"];
    let said = sandbox.run(&[&assign[..], &["--starts", "1"]].concat());
    works(&said);
    assert!(
        said.stderr.contains("tiles.csv: line 4: left out: the magnetization of tile \"c\" is missing"),
        "{}",
        said.stderr
    );
    sandbox.write("placed.csv", &sandbox.read("plan.csv").replace(",no\n", ",yes\n"));
    works(&sandbox.run(&[&assign[..], &["--placed", "placed.csv", "--starts", "1", "-q"]].concat()));
}

const TWO_TILES: &str = "format = 1\nname = \"two\"\n[ideal]\nwavelength_mm = 10\nthickness_mm = 1\namplitude_t = 0.1\n\
    [volume]\nx_mm = [-1, 1]\ny_mm = [-1, 1]\nz_mm = [-5, -4]\nstep_mm = 1\n\
    [kind.k]\nsize_mm = [2, 2, 1]\npolarization_t = [0, 0, 0.1]\n\
    [[tile]]\nname = \"left\"\nkind = \"k\"\nposition_mm = [-2, 0, 0.5]\n\
    [[tile]]\nname = \"right\"\nkind = \"k\"\nposition_mm = [2, 0, 0.5]\nrotation = { axis = [0, 0, 1], angle_deg = 30 }\n";

/// The CSV files beside figures.
#[cfg(feature = "report")]
#[test]
fn tables_of_figures_are_read() {
    let sandbox = sandbox();
    sandbox.write("two.toml", TWO_TILES);
    works(&sandbox.run(&["report", "two.toml", "-o", "report", "-q"]));
    let files: Vec<String> = fs::read_dir(sandbox.path("report"))
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8"))
        .filter(|name| name.ends_with(".csv"))
        .collect();
    assert!(files.len() >= 5, "{files:?}");
    for file in &files {
        let path = format!("report/{file}");
        let text = sandbox.read(&path);
        let names = text.lines().next().expect("names").to_owned();
        if names.contains("x_mm,y_mm,z_mm") {
            works(&sandbox.run(&["field", "two.toml", "--points", &path, "--unbounded", "nan", "-q"]));
        }
        if names.contains("b_x_t") {
            works(&sandbox.run(&["read", &path, "--layout", "two.toml", "-q"]));
        }
        if names.contains("size_x_mm") {
            works(&sandbox.run(&["import", &path, "-o", "again.toml", "-q"]));
        }
    }
    // The turned tile is turned again.
    let field = |layout: &str| {
        sandbox.write("p.csv", "x_mm,y_mm,z_mm\n1.5,0.5,-2\n");
        crate::rows(&sandbox.run(&["field", layout, "--points", "p.csv"]).stdout).remove(0)
    };
    let (film, again) = (field("two.toml"), field("again.toml"));
    assert!(film.iter().zip(&again).all(|(one, other)| (one - other).abs() < 1e-9), "{film:?} {again:?}");

    works(&sandbox.run(&["field", "film.toml", "-o", "b.csv"]));
    works(&sandbox.run(&["scan", "b.csv", "--layout", "film.toml", "--figures", "scan", "--fit", "strength", "-q"]));
    let fields =
        fs::read_dir(sandbox.path("scan")).expect("a folder").map(|entry| entry.expect("an entry").file_name());
    let mut scans = 0;
    for name in fields.map(|name| name.into_string().expect("UTF-8")).filter(|name| name.ends_with(".csv")) {
        let path = format!("scan/{name}");
        works(&sandbox.run(&points(&path)));
        if sandbox.read(&path).lines().next().is_some_and(|names| names.contains(",b_x_t")) {
            works(&sandbox.run(&readings(&path)));
            scans += 1;
        }
    }
    assert!(scans > 0);
}

//! `export --to c-header`: the header is compiled, and its function gives the displacements.

use std::io::Write;
use std::process::{Command, Stdio};

use crate::{Sandbox, rows, shipped};

const MAIN: &str = "#include \"film.h\"\n#include <stdio.h>\n\
    int main(void) {\n\
        float b[3], d[3];\n\
        while (scanf(\"%f,%f,%f\", &b[0], &b[1], &b[2]) == 3) {\n\
            int status = magsplice_displacement(b, d);\n\
            printf(\"%d,%.9g,%.9g,%.9g\\n\", status, d[0], d[1], d[2]);\n\
        }\n\
        return 0;\n\
    }\n";

/// Compiles the header of a film with the compiler that Rust links with, as strictly as it can.
pub(crate) fn compiled(sandbox: &Sandbox) {
    sandbox.write("main.c", MAIN);
    let said = Command::new("cc")
        .args(["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O1", "main.c", "-o", "main", "-lm"])
        .current_dir(sandbox.path("."))
        .output()
        .expect("a C compiler");
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
}

/// What the compiled program answers to readings: a status, and a displacement in millimetres.
pub(crate) fn answers(sandbox: &Sandbox, readings: &str) -> Vec<Vec<f64>> {
    let mut program = Command::new(sandbox.path("main"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    program.stdin.take().expect("a pipe").write_all(readings.as_bytes()).expect("it reads");
    let said = program.wait_with_output().expect("it ends");
    let text = String::from_utf8(said.stdout).expect("UTF-8");
    text.lines().map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect()).collect()
}

/// Readings at all points of the working volume, where the displacement is known. Single precision
/// has an error of 1e-7 of the parameters, which is 1e-6 mm, and adds up over terms to less than
/// 1e-4 mm.
#[test]
fn compiled_header_gives_displacements_within_the_stated_error() {
    let sandbox = Sandbox::new();
    for (film, error) in [("robust-in-plane", 5e-3), ("robust-in-plane", 5e-4), ("designed-displacement", 5e-3)] {
        let film = shipped(film);
        let wanted = format!("{error}mm");
        let said = sandbox.run(&["export", &film, "--to", "c-header", "--error", &wanted, "-o", "film.h"]);
        assert_eq!((said.status, said.stderr.as_str()), (0, ""));
        compiled(&sandbox);
        let field = rows(&sandbox.run(&["field", &film]).stdout);
        let readings: String = field.iter().map(|row| format!("{:?},{:?},{:?}\n", row[3], row[4], row[5])).collect();
        let found = answers(&sandbox, &readings);
        assert_eq!(found.len(), field.len());
        for (found, row) in found.iter().zip(&field) {
            assert_eq!(found[0], 0.0, "{row:?}");
            for (axis, truth) in [row[0], row[1], row[2] + 5.0].into_iter().enumerate() {
                assert!((found[1 + axis] - truth).abs() <= error + 1e-4, "{found:?} at {row:?}");
            }
        }
    }
    let header = sandbox.read("film.h");
    assert!(header.contains("x -2 .. 2, y -2 .. 2, z -5 .. -3 mm") && header.contains("#define MAGSPLICE_DEGREE 4"));
    // A name that begins and ends comments, and holds a placeholder, is still a name.
    let text = std::fs::read_to_string(shipped("designed-displacement")).expect("readable");
    let named = text.replacen("name = \"", "name = \"/* {error} */ ", 1);
    sandbox.write("named.toml", &named);
    assert_eq!(sandbox.run(&["export", "named.toml", "-o", "film.h"]).status, 0);
    assert!(sandbox.read("film.h").contains("Film: / * {error} * / "), "{}", sandbox.read("film.h"));
    compiled(&sandbox);
    // Outside the volume, and without B_z.
    let found = answers(&sandbox, "0,0,0.02\n0.001,0.002,0\nnan,0,1\n");
    assert_eq!([found[0][0], found[1][0]], [1.0, 2.0]);
}

/// The header of a head takes the weighted sum, which `experiment` computes. It has the weights.
#[test]
fn header_of_a_head_gives_displacements_from_the_weighted_sum() {
    let sandbox = Sandbox::new();
    let film = shipped("heads/published-cross");
    let said = sandbox.run(&["export", &film, "--to", "c-header", "--error", "5e-3mm", "-o", "film.h"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    assert!(sandbox.read("film.h").contains("at (5, -5, 0) mm of the board: (-0.125, -0.125, -0.125)"));
    compiled(&sandbox);
    assert_eq!(sandbox.run(&["experiment", &film, "-o", "moved.csv", "--quiet"]).status, 0);
    let moved = rows(&sandbox.read("moved.csv"));
    let readings: String = moved.iter().map(|row| format!("{:?},{:?},{:?}\n", row[4], row[5], row[6])).collect();
    for (found, row) in answers(&sandbox, &readings).iter().zip(&moved) {
        // The sensor moves the other way past the film.
        for axis in 0..3 {
            assert!((found[1 + axis] + row[1 + axis]).abs() < 5e-3 + 1e-4, "{found:?} at {row:?}");
        }
    }
}

#[test]
fn headers_that_cannot_be_written_say_why() {
    let sandbox = Sandbox::new();
    let header = |film: &str, error: &str| {
        sandbox.run(&["export", &shipped(film), "--to", "c-header", "--error", error, "-o", "film.h"])
    };
    header("designed-displacement", "1e-9mm")
        .refuses("no polynomial reaches an error of 0.000000001 mm; the least is ");
    header("designed-displacement", "0mm").refuses_arguments("must be above 0");
    assert!(!sandbox.path("film.h").exists());
    let tile = "[[tile]]\nposition_mm = [0, 0, 1]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
    sandbox.write("tile.toml", &format!("format = 1\nname = \"a tile\"\n{tile}"));
    let said = sandbox.run(&["export", "tile.toml", "-o", "film.h"]);
    said.refuses("tile.toml: the layout has no [volume] table");
}

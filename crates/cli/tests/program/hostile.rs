//! Files that are made to do harm: the program refuses them in words, or uses them as any other.

use crate::{Sandbox, shipped};

/// Control characters, and marks that reverse the direction of text, as a terminal obeys them.
const MARKS: &str = "\u{1b}[2J\u{9b}31m\u{7}\u{202e}gnp\u{2066}\u{2069}\u{202a}";

fn is_obeyed(c: char) -> bool {
    c.is_control() && !"\n\t".contains(c) || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[test]
fn characters_that_a_terminal_obeys_are_escaped_on_standard_error() {
    let sandbox = Sandbox::new();
    let film = shipped("published-film");
    sandbox.write("names.csv", &format!("x_mm,y_mm,z_mm{MARKS},note\n0,0,-4,1\n"));
    sandbox.write("cells.csv", &format!("x_mm,y_mm,z_mm\n0,{MARKS},-4\n"));
    sandbox.write("columns.csv", &format!("x_mm,y_mm,z_mm,bx_t,by_t,bz_t,{MARKS}\n0,0,-4,{MARKS},0,1,0\n"));
    sandbox.write("tiles.csv", &format!("tile,part,strength_t,direction_deg\n{MARKS},1,0.12,45\n"));
    sandbox.write("keys.toml", &format!("format = 1\nname = \"a\"\n\"{MARKS}\" = 1\n"));
    sandbox.write("comment.toml", &format!("# {MARKS}\n"));
    sandbox.write("names.toml", "format = 1\nname = \"\\u001b[2J\\u202e\"\n");
    sandbox.write(&format!("{MARKS}.toml"), "format = 2\n");
    let calls: [&[&str]; 8] = [
        &["field", &film, "--points", "names.csv"],
        &["field", &film, "--points", "cells.csv"],
        &["scan", &film, "columns.csv"],
        &["assign", &film, "--measured", "tiles.csv"],
        &["tiles", "keys.toml"],
        &["tiles", "comment.toml"],
        &["tiles", "names.toml"],
        &["tiles", &format!("{MARKS}.toml")],
    ];
    for call in calls {
        let said = sandbox.run(call);
        assert_eq!((said.status, said.stdout.as_str()), (2, ""), "{call:?}: {}", said.stderr);
        assert!(!said.stderr.contains(is_obeyed), "{call:?}: {:?}", said.stderr);
        assert!(said.stderr.contains("\\u{202e}"), "{call:?}: {:?}", said.stderr);
    }
}

/// A volume with 1e8 points, in a process that may take half a gigabyte. Without a check, the
/// process is aborted when it allocates more.
#[cfg(target_os = "linux")]
#[test]
fn volumes_that_do_not_fit_into_memory_are_refused_by_every_verb() {
    let sandbox = Sandbox::new();
    let film = sandbox.published_with("[tolerance]\npreset = \"workshop\"\n[sensor]\npart = \"MLX90393\"");
    let text = sandbox.read(&film).replace("step_mm = 0.5", "step_mm = 0.01");
    sandbox.write(&film, &text);
    sandbox.write("tiles.csv", "tile,part,strength_t,direction_deg\na,1,0.12,45\n");
    sandbox.write("readings.csv", "bx_t,by_t,bz_t\n0.001,0.001,0.001\n");
    let before = sandbox.files();
    let calls = [
        "compare",
        "decouple",
        "resolution",
        "resolution -o out.npz",
        "experiment",
        "read readings.csv",
        "budget",
        "tolerance",
        "tolerance sample -o made.toml",
        "design -o out.toml",
        "field -o out.npz",
        "field --within 1e-6 -o out.csv",
        "report",
    ];
    for call in calls {
        let (verb, options) = call.split_once(' ').unwrap_or((call, ""));
        let (verb, options) = match options.strip_prefix("sample ") {
            Some(options) => ("tolerance sample", options),
            None => (verb, options),
        };
        let program = env!("CARGO_BIN_EXE_magsplice");
        let line = format!("ulimit -v 500000; exec {program} --threads 2 {verb} {film} {options}");
        let said = std::process::Command::new("sh")
            .args(["-c", &line])
            .current_dir(sandbox.path("."))
            .output()
            .expect("a shell");
        let stderr = String::from_utf8_lossy(&said.stderr);
        assert_eq!((said.status.code(), said.stdout.len()), (Some(2), 0), "{call}: {stderr}");
        let words =
            ["[volume] has 32321001 points, for which this takes ", " GB can be had: use a step_mm of at least 0."];
        assert!(words.iter().all(|words| stderr.contains(words)), "{call}: {stderr}");
        assert_eq!(sandbox.files(), before, "{call}");
    }
}

/// Squares of larger numbers overflow, and results would print inf.
#[test]
fn measured_values_that_no_sensor_reads_are_refused_with_their_line() {
    let sandbox = Sandbox::new();
    let film = shipped("published-film");
    let head = "x_mm,y_mm,z_mm,fx_n,fy_n,fz_n,bx_t,by_t,bz_t\n";
    let good = "0,0,-4,0.1,0,0,1e-3,1e-3,1e-3\n".repeat(4);
    sandbox.write("reading.csv", &format!("{head}{good}0,0,-4,0,0,0,1e-3,-1e200,1e-3\n"));
    sandbox.write("force.csv", &format!("{head}{good}0,0,-4,1e180,0,0,1e-3,1e-3,1e-3\n"));
    for (verb, file, value) in [
        ("read", "reading.csv", "by_t = \"-1e200\""),
        ("scan", "reading.csv", "by_t = \"-1e200\""),
        ("calibrate", "reading.csv", "by_t = \"-1e200\""),
        ("calibrate", "force.csv", "fx_n = \"1e180\""),
    ] {
        let message = format!("{file}: line 6: {value}, must be a measured value, at most 1e100");
        sandbox.run(&[verb, &film, file]).refuses(&message);
    }
    let diagnose = |file: &str, noise: &str| sandbox.run(&["diagnose", &film, "--scan", file, "--noise", noise]);
    diagnose("reading.csv", "5uT").refuses("must be a measured value, at most 1e100");
    sandbox.run(&["tolerance", "sample", &film, "--preset", "jig", "--scan", "scan.csv", "--quiet"]);
    diagnose("scan.csv", "1e-300T").refuses("noise[0] = 1e-300 T, must be a finite number of at least 1e-30 T");
}

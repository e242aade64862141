//! Output on a terminal: colours, and refused binary formats. progress.rs tests the progress line.

use std::fs::{File, OpenOptions};
use std::io::Read;
use std::os::fd::OwnedFd;
use std::process::{Child, Command, Stdio};

use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

use crate::{Sandbox, shipped};

/// A terminal: the side of the program, and the side of the person.
pub(crate) fn terminal() -> (OwnedFd, File) {
    let seen = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).expect("a terminal");
    grantpt(&seen).expect("a terminal");
    unlockpt(&seen).expect("a terminal");
    let name = ptsname(&seen, Vec::new()).expect("a name").into_string().expect("UTF-8");
    let given = OpenOptions::new().read(true).write(true).open(name).expect("the other side");
    (given.into(), seen.into())
}

pub(crate) fn program(sandbox: &Sandbox, arguments: &[&str]) -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_magsplice"));
    program.args(arguments).current_dir(sandbox.path("")).env("TERM", "xterm");
    for name in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE", "CI"] {
        program.env_remove(name);
    }
    program
}

/// The text on the terminal until the program ends or the text is `enough`.
pub(crate) fn watch(mut seen: File, enough: impl Fn(&str) -> bool) -> String {
    let (mut text, mut buffer) = (String::new(), [0; 4096]);
    // Reading a terminal fails when its other side is closed.
    while let Ok(length @ 1..) = seen.read(&mut buffer) {
        text.push_str(&String::from_utf8_lossy(&buffer[..length]));
        if enough(&text) {
            break;
        }
    }
    text
}

fn on_a_terminal(sandbox: &Sandbox, arguments: &[&str], no_color: Option<&str>) -> String {
    let (given, seen) = terminal();
    let mut program = program(sandbox, arguments);
    if let Some(value) = no_color {
        program.env("NO_COLOR", value);
    }
    let mut child: Child = program.stdin(Stdio::null()).stdout(given).stderr(Stdio::null()).spawn().expect("it starts");
    // Closes the copy of the terminal in this process, so that reading ends with the program.
    drop(program);
    let text = watch(seen, |_| false);
    child.wait().expect("it ends");
    text
}

#[test]
fn colours_are_for_terminals_and_respect_no_color() {
    let sandbox = Sandbox::new();
    let layout = shipped("published-film");
    let green = "  \u{1b}[32mok     \u{1b}[0m  amplitude";
    assert!(on_a_terminal(&sandbox, &["check", &layout], None).contains(green));
    let plain = on_a_terminal(&sandbox, &["check", &layout], Some("1"));
    assert!(!plain.contains('\u{1b}') && plain.contains("  ok       amplitude"), "{plain}");
    let piped = program(&sandbox, &["check", &layout]).output().expect("it runs");
    assert_eq!(plain.replace("\r\n", "\n"), String::from_utf8(piped.stdout).expect("UTF-8"));
    // Help texts too.
    assert!(on_a_terminal(&sandbox, &["--help"], None).contains('\u{1b}'));
    assert!(!on_a_terminal(&sandbox, &["--help"], Some("1")).contains('\u{1b}'));
}

#[test]
fn number_of_threads_is_kept_and_changes_no_digit() {
    let sandbox = Sandbox::new();
    let volume = "[volume]\nx_mm = [-4, 4]\ny_mm = [-4, 4]\nz_mm = [-8, -1]\nstep_mm = 0.1\n";
    let tile = "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
    sandbox.write("large.toml", &format!("format = 1\nname = \"large\"\n{volume}{tile}"));
    let mut firsts = Vec::new();
    for count in [1, 3] {
        let mut program = program(&sandbox, &["field", "large.toml", "--threads", &count.to_string()]);
        // No terminal, where the progress line would be one more thread.
        let mut child = program.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("it starts");
        // The program waits with its threads, because the rest of its output is not read.
        let mut first = vec![0; 10_000];
        child.stdout.as_mut().expect("piped").read_exact(&mut first).expect("results");
        let threads = std::fs::read_dir(format!("/proc/{}/task", child.id())).expect("threads").count();
        child.kill().expect("it runs");
        child.wait().expect("it ends");
        // The threads that compute and the one that writes.
        assert_eq!(threads, count + 1);
        firsts.push(first);
    }
    assert!(firsts[0] == firsts[1]);
}

#[test]
fn binary_formats_are_refused_on_a_terminal() {
    let sandbox = Sandbox::new();
    let layout = shipped("published-film");
    for arguments in [
        ["field", &layout, "--format", "npz"],
        ["decouple", &layout, "--format", "vtk"],
        ["export", &layout, "--to", "vtk"],
    ] {
        let (given, seen) = terminal();
        let mut program = program(&sandbox, &arguments);
        let child = program.stdin(Stdio::null()).stdout(given).stderr(Stdio::piped()).spawn().expect("it starts");
        drop(program);
        assert_eq!(watch(seen, |_| false), "", "{arguments:?}");
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(2));
        let said = String::from_utf8(output.stderr).expect("UTF-8");
        assert!(said.contains("is binary and would go to the terminal: give a file with -o"), "{said}");
    }
    // Text formats are shown.
    assert!(
        on_a_terminal(&sandbox, &["export", &layout, "--to", "magpylib"], None).starts_with("\"\"\"A film of block")
    );
}

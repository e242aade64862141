//! Files and pipes: what the program replaces, keeps, and leaves behind.

use std::process::{Command, Output, Stdio};

use crate::{Sandbox, shipped};

#[test]
fn existing_file_is_replaced_and_link_stays_a_link() {
    let sandbox = Sandbox::new();
    sandbox.write("target.csv", "old");
    #[cfg(unix)]
    std::os::unix::fs::symlink(sandbox.path("target.csv"), sandbox.path("out.csv")).unwrap();
    assert_eq!(sandbox.run(&["field", &shipped("single-tile"), "-o", "out.csv"]).status, 0);
    assert!(sandbox.read("target.csv").starts_with("x_mm,"));
    assert!(sandbox.path("out.csv").symlink_metadata().unwrap().is_symlink());
    assert_eq!(sandbox.files(), ["out.csv", "target.csv"]);
    #[cfg(unix)]
    {
        use std::os::unix::fs::{FileTypeExt, PermissionsExt};
        assert_eq!(sandbox.run(&["field", &shipped("single-tile"), "-o", "/dev/null"]).status, 0);
        assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());
        // The permissions of any new file.
        let plain = sandbox.path("plain");
        std::fs::write(&plain, "").unwrap();
        let mode = |path| std::fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(sandbox.path("target.csv")), mode(plain));
    }
}

/// Runs the program with a closed pipe as standard output.
fn unread(arguments: &[&str]) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_magsplice"))
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(program.stdout.take());
    program.wait_with_output().unwrap()
}

#[test]
fn closed_pipe_is_no_failure() {
    let output = unread(&["field", &shipped("single-tile")]);
    assert!(output.status.success());
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

#[test]
fn findings_are_printed_after_a_closed_pipe() {
    let sandbox = Sandbox::new();
    let grid = "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n\
                grid = { count = [100, 100, 1], pitch_mm = [1, 1, 1] }\n";
    sandbox.write("grid.toml", &format!("format = 1\nname = \"grid\"\n{grid}[kind.idle]\nsize_mm = [1, 1, 1]\n"));
    let output = unread(&["check", sandbox.path("grid.toml").to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("kind \"idle\" is declared but no tile uses it"));
}

/// Ctrl-C while a file is written removes the temporary file and keeps the earlier one.
#[cfg(unix)]
#[test]
fn interruption_leaves_no_temporary_file() {
    let sandbox = Sandbox::new();
    sandbox.write("out.csv", "before");
    let volume = "[volume]\nx_mm = [-4, 4]\ny_mm = [-4, 4]\nz_mm = [-8, -1]\nstep_mm = 0.02\n";
    let tile = "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";
    sandbox.write("large.toml", &format!("format = 1\nname = \"large\"\n{volume}{tile}"));
    let mut program = Command::new(env!("CARGO_BIN_EXE_magsplice"))
        .args(["field", "large.toml", "-o", "out.csv"])
        .current_dir(sandbox.path(""))
        .spawn()
        .unwrap();
    while sandbox.files().len() < 3 {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let killed = Command::new("kill").args(["-INT", &program.id().to_string()]).status().unwrap();
    assert!(killed.success());
    assert_eq!(program.wait().unwrap().code(), Some(130));
    assert_eq!(sandbox.files(), ["large.toml", "out.csv"]);
    assert_eq!(sandbox.read("out.csv"), "before");
}

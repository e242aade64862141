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

#[cfg(unix)]
#[test]
fn links_to_nothing_are_followed_and_circles_are_refused() {
    use std::os::unix::fs::symlink;
    let sandbox = Sandbox::new();
    std::fs::create_dir(sandbox.path("folder")).unwrap();
    symlink("folder/second.csv", sandbox.path("first.csv")).unwrap();
    symlink("../third.csv", sandbox.path("folder/second.csv")).unwrap();
    assert_eq!(sandbox.run(&["field", &shipped("single-tile"), "-o", "first.csv"]).status, 0);
    assert!(sandbox.read("third.csv").starts_with("x_mm,"));
    symlink("nowhere/out.csv", sandbox.path("lost.csv")).unwrap();
    sandbox
        .run(&["field", &shipped("single-tile"), "-o", "lost.csv"])
        .refuses("cannot write lost.csv: nowhere does not exist");
    symlink("b.csv", sandbox.path("a.csv")).unwrap();
    symlink("a.csv", sandbox.path("b.csv")).unwrap();
    symlink("circle", sandbox.path("circle")).unwrap();
    let circles: [&[&str]; 3] =
        [&["field", "-o", "a.csv"], &["export", "--to", "vtk", "-o", "circle"], &["report", "-o", "circle"]];
    for arguments in circles.iter().take(if cfg!(feature = "report") { 3 } else { 2 }) {
        let layout = shipped("single-tile");
        sandbox.run(&[*arguments, &[&layout]].concat()).refuses("Too many levels of symbolic links");
    }
    for link in ["first.csv", "folder/second.csv", "lost.csv", "a.csv", "b.csv", "circle"] {
        assert!(sandbox.path(link).is_symlink(), "{link}");
    }
}

/// A limit on the size of files fails as a full disk does.
#[cfg(target_os = "linux")]
#[test]
fn failed_writes_name_the_file_asked_for_and_the_reason_of_the_system() {
    let sandbox = Sandbox::new();
    let layout = shipped("published-film");
    for (arguments, name) in [
        ("field -o out.csv", "out.csv"),
        ("field -o out.npz", "out.npz"),
        ("field -o out.npy", "out.npy"),
        ("field -o out.vti", "out.vti"),
        ("decouple -o ./out.json", "./out.json"),
        ("export -o out.py", "out.py"),
    ] {
        let script = format!("trap '' XFSZ; ulimit -f 1; exec \"$0\" {arguments} \"$1\"");
        let said = Command::new("bash")
            .args(["-c", &script, env!("CARGO_BIN_EXE_magsplice"), &layout])
            .current_dir(sandbox.path(""))
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&said.stderr);
        assert_eq!(stderr, format!("magsplice: cannot write {name}: File too large (os error 27)\n"));
        assert_eq!(said.status.code(), Some(2));
    }
    assert_eq!(sandbox.files(), [""; 0]);
    for format in ["csv", "npz", "npy", "vtk", "json"] {
        sandbox
            .run(&["field", &layout, "--format", format, "-o", "/dev/full"])
            .refuses("cannot write /dev/full: No space left on device (os error 28)\n");
    }
}

#[cfg(unix)]
#[test]
fn inputs_are_not_replaced_under_any_of_their_names() {
    use std::os::unix::fs::symlink;
    let sandbox = Sandbox::new();
    let layout = std::fs::read_to_string(shipped("single-tile")).unwrap();
    sandbox.write("film.toml", &layout);
    sandbox.write("points.csv", "x_mm,y_mm,z_mm\n0,0,-1\n");
    symlink(sandbox.path("film.toml"), sandbox.path("link.csv")).unwrap();
    symlink("link.csv", sandbox.path("second.csv")).unwrap();
    symlink(".", sandbox.path("here")).unwrap();
    let csv = ["--format", "csv", "-o"];
    for output in ["./film.toml", "link.csv", "second.csv", "here/film.toml", "/proc/self/cwd/film.toml"] {
        sandbox
            .run(&[&["field", "film.toml"], &csv[..], &[output]].concat())
            .refuses("it is an input, which would be lost");
        sandbox.run(&[&["field", "here/film.toml"], &csv[..], &[output]].concat()).refuses("it is an input");
    }
    for points in ["points.csv", "here/points.csv"] {
        sandbox.run(&["field", "film.toml", "--points", points, "-o", "points.csv"]).refuses("it is an input");
    }
    let typed = Command::new(env!("CARGO_BIN_EXE_magsplice"))
        .args(["field", "film.toml", "--points", "-", "-o", "points.csv"])
        .current_dir(sandbox.path(""))
        .stdin(std::fs::File::open(sandbox.path("points.csv")).unwrap())
        .output()
        .unwrap();
    assert_eq!(typed.status.code(), Some(2));
    assert_eq!(sandbox.read("film.toml"), layout);
    assert_eq!(sandbox.read("points.csv"), "x_mm,y_mm,z_mm\n0,0,-1\n");
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

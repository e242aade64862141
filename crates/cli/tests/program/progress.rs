//! The progress line: on a terminal only, and only for long work. An interruption changes no file.

use std::fs::File;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::terminal::{program, terminal, watch};
use crate::{Sandbox, shipped};

/// Interval at which a folder is searched for a temporary file.
const LOOKS: Duration = Duration::from_millis(1);

const IDEAL: &str = "[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n";
const EXPECT: &str = "[expect]\nfield = { file = \"large.csv\", within = 1e-12 }\n";

/// Writes a layout of 401 x 401 x 51 points. With [`many_tiles`] the field takes minutes; with
/// [`ONE_TILE`] it takes less time than writing it.
fn large(sandbox: &Sandbox, tiles: &str) {
    let volume = "[volume]\nx_mm = [-2, 2]\ny_mm = [-2, 2]\nz_mm = [-5, -4.5]\nstep_mm = 0.01\n";
    sandbox.write("large.toml", &format!("format = 1\nname = \"large\"\n{IDEAL}{volume}{EXPECT}{tiles}"));
}

const POINTS: &str = " of 8,200,851 points";
const ONE_TILE: &str = "[[tile]]\nposition_mm = [0, 0, 0.5]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";

fn many_tiles() -> String {
    let widths = "{ widths_mm = [3.3, 1.7, 3.3, 1.7], pattern = [1, 0, -1, 0], times = 40 }";
    format!(
        "[[lattice]]\nname = \"film\"\nstart_mm = [-200.85, -200.85, 0]\nheight_mm = 1\nstrength_t = 0.12\nx = [{widths}]\n"
    )
}

/// Starts the program with a terminal as standard error. Returns the other side of the terminal.
fn start(sandbox: &Sandbox, arguments: &[&str]) -> (Child, File) {
    let (given, seen) = terminal();
    let mut program = program(sandbox, arguments);
    let child = program.stdin(Stdio::null()).stdout(Stdio::null()).stderr(given).spawn().expect("it starts");
    (child, seen)
}

fn interrupt(child: &mut Child) -> ExitStatus {
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill runs");
    assert!(sent.success());
    child.wait().expect("it ends")
}

/// Whether a shell would report 130: the status itself, or the signal if the program had no
/// temporary file and so no handler.
fn is_interrupted(status: ExitStatus) -> bool {
    status.code() == Some(130) || status.signal() == Some(2)
}

/// Writes the files that must stay unchanged: a result, a baseline and a report. Returns all files.
fn earlier(sandbox: &Sandbox) -> Vec<(PathBuf, Vec<u8>)> {
    sandbox.write("out.csv", "earlier");
    sandbox.write("large.csv", "x_mm,y_mm,z_mm,bx_t,by_t,bz_t\n");
    if cfg!(feature = "report") {
        assert_eq!(sandbox.run(&["report", &shipped("single-tile"), "-o", "out"]).status, 0);
    }
    contents(&sandbox.path(""))
}

/// Paths and contents of all files in a folder and the folders in it.
fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let entries = std::fs::read_dir(folder).expect("a readable folder").map(|entry| entry.expect("an entry").path());
    let mut all: Vec<(PathBuf, Vec<u8>)> = entries
        .flat_map(|path| match path.is_dir() {
            true => contents(&path),
            false => vec![(path.clone(), std::fs::read(&path).expect("a readable file"))],
        })
        .collect();
    all.sort();
    all
}

#[test]
fn progress_line_counts_points_and_interruption_keeps_earlier_files() {
    let sandbox = Sandbox::new();
    large(&sandbox, &many_tiles());
    let before = earlier(&sandbox);
    let mut verbs = vec![
        (vec!["field", "large.toml", "-o", "out.csv"], "field "),
        (vec!["decouple", "large.toml", "-o", "out.csv"], "field "),
        (vec!["decouple", "large.toml"], "field "),
        (vec!["compare", "large.toml"], "field "),
        (vec!["check", "large.toml", "--update"], "field "),
        (vec!["check", "large.toml", "large.toml", "--update"], "large.toml (1 of 2): field "),
    ];
    if cfg!(feature = "report") {
        verbs.push((vec!["report", "large.toml", "-o", "out"], "field "));
    }
    for (verb, stage) in verbs {
        let (mut child, seen) = start(&sandbox, &verb);
        let text = watch(seen, |text| text.contains(POINTS));
        assert!(text.contains(stage) && text.contains(POINTS), "{verb:?}: {text:?}");
        assert!(is_interrupted(interrupt(&mut child)), "{verb:?}");
        assert!(contents(&sandbox.path("")) == before, "{verb:?}: {:?}", sandbox.files());
    }
}

#[test]
fn uncounted_work_shows_its_stage() {
    let sandbox = Sandbox::new();
    large(&sandbox, ONE_TILE);
    // The program waits for a point file that nobody writes.
    let pipe = sandbox.path("points.csv");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo runs").success());
    for verb in [["field", "large.toml", "--points", "points.csv"], ["plan", "large.toml", "--points", "points.csv"]] {
        let (mut child, seen) = start(&sandbox, &verb);
        let text = watch(seen, |text| text.contains('\u{1b}') || text.contains("reading"));
        assert!(text.contains("reading the layout, "), "{verb:?}: {text:?}");
        assert!(is_interrupted(interrupt(&mut child)));
    }
}

/// Neither the baseline nor a result changes before its successor is complete.
#[test]
fn interruption_while_writing_keeps_earlier_files() {
    let sandbox = Sandbox::new();
    large(&sandbox, ONE_TILE);
    let before = earlier(&sandbox);
    for verb in [["check", "large.toml", "--update"], ["decouple", "large.toml", "-oout.csv"]] {
        let (mut child, _seen) = start(&sandbox, &verb);
        let half_written = || {
            let entries = std::fs::read_dir(sandbox.path("")).expect("a readable folder").map(|e| e.expect("an entry"));
            let mut temporary = entries.filter(|e| e.file_name().to_string_lossy().starts_with(".magsplice-"));
            temporary.any(|e| e.metadata().is_ok_and(|m| m.len() > 1 << 20))
        };
        while !half_written() {
            assert!(child.try_wait().expect("it runs").is_none(), "{verb:?} ended before it was seen writing");
            sleep(LOOKS);
        }
        assert_eq!(interrupt(&mut child).code(), Some(130), "{verb:?}");
        assert!(contents(&sandbox.path("")) == before, "{verb:?}: {:?}", sandbox.files());
    }
}

/// The program runs for 2 s, twice the delay of the line.
#[test]
fn quiet_runs_and_pipes_show_no_progress_line() {
    let sandbox = Sandbox::new();
    large(&sandbox, &many_tiles());
    for quiet in [true, false] {
        let verb: &[&str] = if quiet { &["decouple", "large.toml", "--quiet"] } else { &["decouple", "large.toml"] };
        let (given, seen) = terminal();
        let mut program = program(&sandbox, verb);
        program.stdin(Stdio::null()).stdout(Stdio::null());
        let (mut child, mut said) = if quiet {
            (program.stderr(given).spawn().expect("it starts"), seen)
        } else {
            let mut child = program.stderr(Stdio::piped()).spawn().expect("it starts");
            let said = child.stderr.take().expect("piped");
            (child, File::from(std::os::fd::OwnedFd::from(said)))
        };
        drop(program);
        sleep(Duration::from_secs(2));
        assert!(child.try_wait().expect("it runs").is_none(), "long enough for a bar");
        assert!(is_interrupted(interrupt(&mut child)));
        let mut text = String::new();
        // Reading a terminal fails when its other side is closed.
        let _ = std::io::Read::read_to_string(&mut said, &mut text);
        assert_eq!(text, "", "{verb:?}");
    }
}

#[test]
fn short_work_shows_no_progress_line() {
    let sandbox = Sandbox::new();
    let layout = crate::shipped("single-tile");
    for verb in [&["field", &layout, "-o", "out.csv"][..], &["check", &layout], &["tiles", &layout]] {
        // On a busy machine the run may take longer than the delay of the line; then it is
        // repeated.
        loop {
            let begun = Instant::now();
            let (mut child, seen) = start(&sandbox, verb);
            let text = watch(seen, |_| false);
            assert!(child.wait().expect("it ends").success());
            if begun.elapsed() < Duration::from_secs(1) {
                assert_eq!(text, "", "{verb:?}");
                break;
            }
        }
    }
}

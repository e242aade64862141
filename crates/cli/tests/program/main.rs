//! Tests of the built program.

mod advice;
mod assign;
mod at_points;
mod bad_layouts;
mod bad_points;
mod baselines;
mod bench;
mod c_header;
mod calibrate;
mod checks;
mod cut_list;
mod decouple;
mod design;
mod diagnose;
mod expectations;
mod field;
mod files;
mod flat_volumes;
mod forces;
mod formats;
mod fuzz;
mod fuzz_verbs;
mod heads;
mod help;
mod hints;
mod hostile;
mod import;
/// Layouts with flat iron.
mod iron;
#[cfg(feature = "report")]
mod live_page;
mod measured_files;
mod own_files;
mod point_files;
#[cfg(target_os = "linux")]
mod progress;
mod published_devices;
mod radians;
mod real_films;
mod recoil;
#[cfg(feature = "report")]
mod report;
#[cfg(feature = "report")]
mod report_pair_watch;
mod sampled_scan;
mod scan;
mod scan_faults;
mod sensor;
mod splice;
mod start;
mod stated_sensor;
#[cfg(feature = "studio")]
mod studio;
mod suspicious;
#[cfg(target_os = "linux")]
mod terminal;
mod tolerances;
mod unbounded;
mod units;
mod wrong_types;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// A folder to run the program in.
struct Sandbox {
    folder: TempDir,
}

/// Exit status and output of a run of the program.
struct RunOutput {
    status: i32,
    stdout: String,
    stderr: String,
    /// Whether this is `check` on a layout, whose errors are results on standard output.
    is_check: bool,
}

impl Sandbox {
    fn new() -> Sandbox {
        Sandbox { folder: TempDir::new().expect("a temporary folder") }
    }

    /// The name of the folder.
    fn name(&self) -> String {
        self.folder.path().file_name().expect("a name").to_string_lossy().into_owned()
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, text).expect("a writable folder");
        path
    }

    /// The published film without its sensor and its elastic layer, with these tables instead.
    fn published_with(&self, tables: &str) -> String {
        let text = fs::read_to_string(shipped("published-film")).expect("readable");
        let is_kept = |part: &&str| !part.contains("[sensor]\n") && !part.contains("[elastomer]\n");
        let kept: Vec<&str> = text.split("\n\n").filter(is_kept).collect();
        self.write("film.toml", &format!("{}\n{tables}\n", kept.join("\n\n")));
        "film.toml".to_owned()
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).expect("a readable file")
    }

    /// Names of all files in the folder.
    fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).expect("a readable folder");
        let mut names: Vec<String> =
            entries.map(|e| e.expect("an entry").file_name().into_string().expect("UTF-8")).collect();
        names.sort();
        names
    }

    fn run(&self, arguments: &[&str]) -> RunOutput {
        let output: Output = Command::new(env!("CARGO_BIN_EXE_magsplice"))
            .args(arguments)
            .current_dir(self.folder.path())
            .output()
            .expect("the program starts");
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8 output");
        RunOutput {
            status: output.status.code().expect("an exit status"),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
            is_check: arguments.first() == Some(&"check"),
        }
    }
}

impl RunOutput {
    /// Asserts that the program printed this message, nothing on standard output, and exited
    /// with 2. For `check`, that the message is the result of the layout.
    #[track_caller]
    fn refuses(&self, message: &str) {
        if self.is_check {
            assert_eq!((self.status, self.stderr.as_str()), (2, ""), "stdout: {}", self.stdout);
            // Lines after the first are indented.
            let text = self.stdout.replace(&format!("\n{:11}", ""), "\n");
            assert!(text.contains(message), "{message:?} is not in {:?}", self.stdout);
            assert!(text.contains("  ERROR    ") && text.ends_with("1 layout checked, 1 with an error\n"), "{text}");
            return;
        }
        assert_eq!((self.status, self.stdout.as_str()), (2, ""), "stderr: {}", self.stderr);
        assert!(self.stderr.contains(message), "{message:?} is not in {:?}", self.stderr);
        assert!(self.stderr.starts_with("magsplice: ") && !self.stderr.contains("panicked"), "{:?}", self.stderr);
    }
}

impl RunOutput {
    /// Asserts that the arguments were refused with this message.
    #[track_caller]
    fn refuses_arguments(&self, message: &str) {
        assert_eq!((self.status, self.stdout.as_str()), (2, ""), "stderr: {}", self.stderr);
        assert!(self.stderr.contains(message), "{message:?} is not in {:?}", self.stderr);
    }
}

/// Path of a layout in `layouts/`.
fn shipped(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../layouts").join(name).with_extension("toml");
    path.to_str().expect("UTF-8").to_owned()
}

/// The numbers of a CSV table, row by row.
fn rows(csv: &str) -> Vec<Vec<f64>> {
    csv.lines().skip(1).map(|l| l.split(',').map(|c| c.parse().expect("a number")).collect()).collect()
}

//! Tests of the built program.

mod bad_layouts;
mod bad_points;
mod checks;
mod design;
mod formats;
mod help;
#[cfg(target_os = "linux")]
mod progress;
#[cfg(feature = "report")]
mod report;
mod results;
mod start;
#[cfg(target_os = "linux")]
mod terminal;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// A folder to run the program in.
struct Bench {
    folder: TempDir,
}

/// What the program said.
struct Said {
    status: i32,
    stdout: String,
    stderr: String,
}

impl Bench {
    fn new() -> Bench {
        Bench { folder: TempDir::new().expect("a temporary folder") }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, text).expect("a writable folder");
        path
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

    fn run(&self, arguments: &[&str]) -> Said {
        let output: Output = Command::new(env!("CARGO_BIN_EXE_magsplice"))
            .args(arguments)
            .current_dir(self.folder.path())
            .output()
            .expect("the program starts");
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8 output");
        Said {
            status: output.status.code().expect("an exit status"),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
        }
    }
}

impl Said {
    /// Asserts that the program refused with status 2, one clear message and nothing else.
    #[track_caller]
    fn refuses(&self, message: &str) {
        assert_eq!((self.status, self.stdout.as_str()), (2, ""), "stderr: {}", self.stderr);
        assert!(self.stderr.contains(message), "{message:?} is not in {:?}", self.stderr);
        assert!(self.stderr.starts_with("magsplice: ") && !self.stderr.contains("panicked"), "{:?}", self.stderr);
    }
}

impl Said {
    /// Asserts that the arguments were refused, with these words.
    #[track_caller]
    fn refuses_arguments(&self, message: &str) {
        assert_eq!((self.status, self.stdout.as_str()), (2, ""), "stderr: {}", self.stderr);
        assert!(self.stderr.contains(message), "{message:?} is not in {:?}", self.stderr);
    }
}

/// A layout shipped with the project.
fn shipped(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../layouts").join(name).with_extension("toml");
    path.to_str().expect("UTF-8").to_owned()
}

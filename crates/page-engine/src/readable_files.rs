//! The files beside a layout that its session may read.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use magsplice::layout::{Layout, referenced_files};

/// The files to which a layout on disk refers: baselines, measured errors and neighbours. A text
/// that refers to any other file is refused before it is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadableFiles {
    /// The folder to which the names are relative.
    folder: PathBuf,
    names: Names,
}

/// Names of files, as a layout writes them.
#[derive(Clone, Debug, PartialEq)]
enum Names {
    Any,
    These(BTreeSet<String>),
}

impl Default for Names {
    fn default() -> Names {
        Names::These(BTreeSet::new())
    }
}

impl ReadableFiles {
    /// The files to which a text refers, in this folder. `None` if the text is not TOML.
    pub fn new(folder: impl Into<PathBuf>, text: &str) -> Option<ReadableFiles> {
        Some(ReadableFiles { folder: folder.into(), names: Names::These(referenced_files(text)?) })
    }

    /// Adds the files to which another text refers. Whether the text is TOML.
    pub fn add(&mut self, text: &str) -> bool {
        let Some(more) = referenced_files(text) else { return false };
        if let Names::These(names) = &mut self.names {
            names.extend(more);
        }
        true
    }

    /// No files.
    pub fn none(folder: impl Into<PathBuf>) -> ReadableFiles {
        ReadableFiles { folder: folder.into(), names: Names::default() }
    }

    /// Any file: where there are none, as in a WebAssembly module. Layouts may then refer to
    /// baselines, which a session does not read.
    pub fn any() -> ReadableFiles {
        ReadableFiles { folder: PathBuf::new(), names: Names::Any }
    }

    /// The folder to which names in the layout are relative.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The layout in a text that refers to no other files. `name` identifies it in messages.
    ///
    /// # Errors
    /// If the text refers to another file, even to the same one under another name; or if the
    /// layout breaks a rule.
    pub fn layout(&self, text: &str, name: &str) -> Result<Layout, String> {
        // A text that is not TOML refers to nothing, and is refused below.
        referenced_files(text).unwrap_or_default().iter().try_for_each(|file| self.check(file, name))?;
        Layout::parse_beside(text, name, &self.folder).map_err(|error| error.to_string())
    }

    /// Refuses a file to which the layout on disk does not refer. `name` identifies the layout in
    /// the message.
    fn check(&self, file: &str, name: &str) -> Result<(), String> {
        match &self.names {
            Names::Any => return Ok(()),
            Names::These(names) if names.contains(file) => return Ok(()),
            Names::These(_) => {}
        }
        Err(format!(
            "{name}: refers to \"{}\", must refer only to files that the layout on disk refers to: add the name there, \
             with an editor",
            file.escape_debug()
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TILE: &str = "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, 1, 1]\npolarization_t = [0, 0, 1]\n";

    fn layout(tables: &str) -> String {
        format!("format = 1\nname = \"one\"\n{tables}\n{TILE}")
    }

    fn measured(file: &str) -> String {
        layout(&format!("[tolerance]\nposition_mm = {{ file = \"{file}\" }}\n"))
    }

    #[test]
    fn only_files_of_the_layout_on_disk_are_read() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["x.csv", "secret.csv"] {
            std::fs::write(folder.path().join(name), "0.1\n0.2\n").expect("writable");
        }
        let files = ReadableFiles::new(folder.path(), &measured("x.csv")).expect("TOML");
        let read = files.layout(&measured("x.csv"), "film").expect("a layout");
        assert!(read.states_errors_of_tiles());
        assert!(files.layout(&layout(""), "film").is_ok());
        let mut both = files.clone();
        assert!(both.add(&measured("secret.csv")) && !both.add("a = ["));
        assert!(
            both.layout(&measured("x.csv"), "film").is_ok() && both.layout(&measured("secret.csv"), "film").is_ok()
        );
        let absolute = folder.path().join("x.csv").display().to_string();
        for other in ["secret.csv", "./x.csv", "X.csv", "../x.csv", "/etc/passwd", &absolute] {
            let refused = files.layout(&measured(other), "film").expect_err("another file");
            assert!(refused.starts_with(&format!("film: refers to \"{other}\", must")), "{refused}");
        }
        for tables in [
            "[expect]\nfield = { file = \"secret.csv\", within = 1 }\n",
            "[tolerance.neighbour]\nlayout = \"secret.csv\"\nposition_mm = [0, 0, -9]\n",
            "[[tolerance.group]]\nkinds = [\"a\"]\nstrength_pct = { file = \"secret.csv\" }\n",
        ] {
            let refused = files.layout(&layout(tables), "film").expect_err("another file");
            assert!(refused.contains("refers to \"secret.csv\""), "{refused}");
        }
    }

    #[test]
    fn texts_without_references_read_nothing() {
        let none = ReadableFiles::none("");
        assert!(none.layout(&layout(""), "film").is_ok());
        assert!(none.layout("format = ", "film").is_err_and(|error| error.starts_with("film: TOML parse error")));
        assert!(none.layout(&measured("x.csv"), "film").is_err());
        assert_eq!(ReadableFiles::new("", "format = "), None);
        let baseline = layout(
            "[expect]\nfield = { file = \"field.csv\", within = 1 }\n[volume]\nx_mm = [-1, 1]\ny_mm = [-1, 1]\nz_mm = [-5, -3]\nstep_mm = 1\n",
        );
        assert!(none.layout(&baseline, "film").is_err() && ReadableFiles::any().layout(&baseline, "film").is_ok());
        assert_eq!(ReadableFiles::new("", &layout("")), Some(none));
    }
}

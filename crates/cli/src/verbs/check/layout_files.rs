//! The layout files that the arguments of `check` name: files as they are, folders with all layouts
//! below them.

use std::fs;
use std::path::{Path, PathBuf};

use magsplice::layout::is_layout;

/// Deepest folder below an argument that is searched. A deeper tree is a mistake or a circle of
/// mounts.
const MAX_DEPTH: usize = 64;

/// Why a TOML file of a folder is skipped.
pub(super) const NO_LAYOUT: &str = "not a layout: it has no key `format`";

/// A file or a folder that the arguments name.
pub(super) enum NamedFile {
    /// A layout, or a file that may be a broken one.
    Layout(PathBuf),
    /// A TOML file of a folder that is no layout.
    Skipped(PathBuf),
    /// A folder without a layout, or what cannot be searched or read, with the reason.
    Refused(PathBuf, String),
}

/// The files that `arguments` name, in the order of the arguments.
///
/// A folder stands for all files `*.toml` below it, in the order of their paths. Folders and files
/// whose names begin with a dot are not searched, nor are links to folders. A folder without a
/// layout is refused: a build that checks nothing must not pass. So is a link `*.toml` that leads
/// nowhere: the film behind it would vanish from the build.
pub(super) fn expand(arguments: &[PathBuf]) -> Vec<NamedFile> {
    let mut files = Vec::new();
    for argument in arguments {
        if !argument.is_dir() {
            files.push(NamedFile::Layout(argument.clone()));
            continue;
        }
        let mut found = Vec::new();
        search(argument, 0, &mut found);
        found.sort_by(|a, b| a.path().cmp(b.path()));
        if found.iter().all(|file| matches!(file, NamedFile::Skipped(_))) {
            let message = "no layout in this folder: a layout is a file *.toml with the key format".to_owned();
            files.push(NamedFile::Refused(argument.clone(), message));
        }
        files.append(&mut found);
    }
    files
}

impl NamedFile {
    fn path(&self) -> &Path {
        match self {
            NamedFile::Layout(path) | NamedFile::Skipped(path) | NamedFile::Refused(path, _) => path,
        }
    }

    /// A file `*.toml` of a folder.
    fn in_folder(path: PathBuf) -> NamedFile {
        match fs::metadata(&path) {
            Err(error) if path.is_symlink() => {
                NamedFile::Refused(path, format!("cannot follow this symbolic link: {error}"))
            }
            Ok(file) if !file.is_file() => NamedFile::Refused(path, "not a regular file".to_owned()),
            // A file that cannot be read, or is not TOML, may be a broken layout: `check` says why.
            _ if fs::read_to_string(&path).is_ok_and(|text| is_layout(&text) == Some(false)) => {
                NamedFile::Skipped(path)
            }
            _ => NamedFile::Layout(path),
        }
    }
}

/// Adds what is below a folder. A part that cannot be read does not hide the rest.
fn search(folder: &Path, depth: usize, found: &mut Vec<NamedFile>) {
    let failed = |error: &dyn std::fmt::Display| {
        NamedFile::Refused(folder.to_owned(), format!("cannot read this folder: {error}"))
    };
    if depth > MAX_DEPTH {
        return found.push(failed(&format_args!("more than {MAX_DEPTH} folders deep")));
    }
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) => return found.push(failed(&error)),
    };
    for entry in entries {
        let (entry, kind) = match entry.and_then(|entry| entry.file_type().map(|kind| (entry, kind))) {
            Ok(entry) => entry,
            Err(error) => {
                found.push(failed(&error));
                continue;
            }
        };
        let path = entry.path();
        if entry.file_name().as_encoded_bytes().starts_with(b".") {
            continue;
        }
        let is_toml = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
        if kind.is_dir() {
            search(&path, depth + 1, found);
        } else if is_toml && !path.is_dir() {
            found.push(NamedFile::in_folder(path));
        }
    }
}

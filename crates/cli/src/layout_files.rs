//! The layout files that the arguments of `check` name: files as they are, folders with all layouts
//! below them.

use std::fs;
use std::path::{Path, PathBuf};

use magsplice::layout::is_layout;

use crate::failure::Failure;

/// Deepest folder below an argument that is searched. A deeper tree is a mistake or a circle of
/// mounts.
const MAX_DEPTH: usize = 64;

/// The layout files that `arguments` name, and the files of folders that were skipped because they
/// are TOML but no layouts.
///
/// A folder stands for all files `*.toml` below it, in the order of their paths. Folders and files
/// whose names begin with a dot are not searched, nor are links to folders. A folder without a
/// layout is refused: a build that checks nothing must not pass.
pub(crate) fn expand(arguments: &[PathBuf]) -> Result<(Vec<PathBuf>, Vec<PathBuf>), Failure> {
    let (mut layouts, mut skipped) = (Vec::new(), Vec::new());
    for argument in arguments {
        if !argument.is_dir() {
            layouts.push(argument.clone());
            continue;
        }
        let mut found = Vec::new();
        search(argument, 0, &mut found)?;
        found.sort();
        let before = layouts.len();
        for path in found {
            // A file that cannot be read, or is not TOML, may be a broken layout: `check` says why.
            let is_other = fs::read_to_string(&path).is_ok_and(|text| is_layout(&text) == Some(false));
            if is_other { skipped.push(path) } else { layouts.push(path) }
        }
        if layouts.len() == before {
            let message = "no layout in this folder: a layout is a file *.toml with the key format".to_owned();
            return Err(Failure::Points { path: argument.clone(), message });
        }
    }
    Ok((layouts, skipped))
}

fn search(folder: &Path, depth: usize, found: &mut Vec<PathBuf>) -> Result<(), Failure> {
    let failed = |error: &dyn std::fmt::Display| Failure::Points {
        path: folder.to_owned(),
        message: format!("cannot read this folder: {error}"),
    };
    if depth > MAX_DEPTH {
        return Err(failed(&format_args!("more than {MAX_DEPTH} folders deep")));
    }
    for entry in fs::read_dir(folder).map_err(|error| failed(&error))? {
        let entry = entry.map_err(|error| failed(&error))?;
        let (path, kind) = (entry.path(), entry.file_type().map_err(|error| failed(&error))?);
        if entry.file_name().as_encoded_bytes().starts_with(b".") {
            continue;
        }
        let is_toml = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
        if kind.is_dir() {
            search(&path, depth + 1, found)?;
        } else if is_toml && path.is_file() {
            found.push(path);
        }
    }
    Ok(())
}

//! A folder of results that appears complete or not at all.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::destination::{folder_of, followed, is_same_file_or_below};
use crate::failure::Failure;
use crate::interrupt;
use crate::sha256::sha256;

/// The list of the files of a folder with their hashes, as `sha256sum` writes and checks it. Its
/// first line names the command that wrote the folder.
const LIST: &str = "files.sha256";

/// A temporary folder beside its destination, which [`Folder::finish`] moves there.
pub(crate) struct Folder {
    filled: TempDir,
    destination: PathBuf,
    /// The destination as the user named it.
    named: PathBuf,
    /// The contents of [`LIST`].
    list: String,
}

impl Folder {
    /// Opens `path` for the files of `command`: nothing yet, an empty folder, or an earlier folder
    /// of the same command. Such a folder is replaced if its files are as they were written and
    /// none of them is one of the `inputs`.
    pub(crate) fn open(path: &Path, command: &str, inputs: &[&Path]) -> Result<Folder, Failure> {
        let failed = |error: io::Error| Failure::write(path, error);
        // A link stays a link: the folder it leads to is replaced.
        let destination = followed(path).map_err(failed)?;
        let list = format!("# magsplice {command}\n");
        let mut builder = tempfile::Builder::new();
        builder.prefix(".magsplice-");
        match fs::metadata(&destination) {
            Ok(there) if !there.is_dir() => return Err(failed(io::Error::from(io::ErrorKind::NotADirectory))),
            Ok(there) if there.permissions().readonly() => {
                return Err(failed(io::Error::other("it is read-only")));
            }
            Ok(there) => {
                if let Some(input) = inputs.iter().find(|input| is_same_file_or_below(input, &destination)) {
                    let why =
                        format!("it holds {}, an input, which would be lost: choose another folder", input.display());
                    return Err(failed(io::Error::other(why)));
                }
                unchanged_files(&destination, &list).map_err(failed)?;
                builder.permissions(there.permissions());
            }
            Err(_) => {
                #[cfg(unix)]
                builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
            }
        }
        let beside = folder_of(&destination).map_err(failed)?;
        // Only the kind of the error: its text names the temporary folder, which the user never
        // sees.
        let filled = interrupt::temporary(|| builder.tempdir_in(beside));
        let filled = filled.map_err(|e| failed(io::Error::from(e.kind())))?;
        Ok(Folder { filled, destination, named: path.to_owned(), list })
    }

    /// Writes one file.
    pub(crate) fn write(&mut self, name: &str, contents: &[u8]) -> Result<(), Failure> {
        self.list += &format!("{}  {name}\n", sha256(contents));
        self.write_unlisted(name, contents)
    }

    /// Writes files with their names.
    #[cfg(feature = "report")]
    pub(crate) fn write_all<'f>(&mut self, files: impl IntoIterator<Item = (String, &'f [u8])>) -> Result<(), Failure> {
        files.into_iter().try_for_each(|(name, contents)| self.write(&name, contents))
    }

    fn write_unlisted(&self, name: &str, contents: &[u8]) -> Result<(), Failure> {
        // An interruption that removes the folder waits until the file is written.
        let written = interrupt::uninterrupted(|| fs::write(self.filled.path().join(name), contents));
        written.map_err(|error| Failure::write(&self.named.join(name), error))
    }

    /// Moves the folder to its destination. Without this call it never appears.
    pub(crate) fn finish(self) -> Result<(), Failure> {
        self.write_unlisted(LIST, self.list.as_bytes())?;
        let Folder { filled, destination, named, list } = self;
        let failed = |error| Failure::write(&named, error);
        interrupt::uninterrupted(|| {
            if !destination.exists() {
                fs::rename(filled.path(), &destination)?;
            } else {
                replace(&destination, filled.path(), list.lines().next().unwrap_or(""))?;
            }
            // The temporary path no longer exists, so there is nothing to remove when it is
            // dropped.
            let _ = filled.keep();
            Ok(())
        })
        .map_err(failed)
    }
}

/// Puts the folder `filled` in the place of `destination`. The files of the earlier folder are
/// looked at again, because work may take hours.
fn replace(destination: &Path, filled: &Path, title: &str) -> io::Result<()> {
    let aside = filled.with_extension("old");
    fs::rename(destination, &aside)?;
    // The earlier folder moves back if its successor cannot take its place.
    let files = match unchanged_files(&aside, title).and_then(|files| fs::rename(filled, destination).map(|()| files)) {
        Ok(files) => files,
        Err(error) => {
            fs::rename(&aside, destination)?;
            return Err(error);
        }
    };
    // One by one, so that a file that appears meanwhile is kept.
    files.iter().try_for_each(fs::remove_file)?;
    fs::remove_dir(&aside)
}

/// The files of an earlier folder of the same command, which begins its list with `title`. An error
/// names a file that the command did not write, or that has been changed since.
fn unchanged_files(folder: &Path, title: &str) -> io::Result<Vec<PathBuf>> {
    let mut entries = fs::read_dir(folder)?.collect::<io::Result<Vec<_>>>()?;
    entries.sort_by_key(fs::DirEntry::file_name);
    let is_file = |entry: &fs::DirEntry| entry.file_type().is_ok_and(|kind| kind.is_file());
    let list = match entries.iter().find(|entry| entry.file_name() == LIST && is_file(entry)) {
        Some(list) => fs::read_to_string(list.path()).unwrap_or_default(),
        None => String::new(),
    };
    let list = list.strip_prefix(title.trim_end()).unwrap_or("");
    for entry in entries.iter().filter(|entry| list.is_empty() || entry.file_name() != LIST) {
        let name = entry.file_name();
        let listed = list.lines().filter_map(|line| line.split_once("  ")).find(|(_, listed)| name == *listed);
        let why = match listed {
            Some((hash, _)) if is_file(entry) => {
                if hash == sha256(&fs::read(entry.path())?) {
                    continue;
                }
                "has been changed since this command wrote it"
            }
            _ => "this command did not write",
        };
        let name = name.display();
        return Err(io::Error::other(format!(
            "it holds {name}, which {why} and which would be lost: choose another folder"
        )));
    }
    Ok(entries.iter().map(fs::DirEntry::path).collect())
}

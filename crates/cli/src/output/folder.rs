//! A folder of results that appears complete or not at all.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::destination::folder_of;
use crate::failure::Failure;
use crate::interrupt;

/// A temporary folder beside its destination, which [`Folder::finish`] moves there.
pub(crate) struct Folder {
    filled: TempDir,
    destination: PathBuf,
}

impl Folder {
    /// Opens `path`: nothing yet, an empty folder, or a folder whose files are all `ours`. Such a
    /// folder is replaced.
    pub(crate) fn open(path: &Path, ours: impl Fn(&str) -> bool) -> Result<Folder, Failure> {
        let failed = |error: io::Error| Failure::Write { target: path.display().to_string(), error };
        // A link stays a link: the folder it leads to is replaced.
        let destination = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let mut builder = tempfile::Builder::new();
        builder.prefix(".magsplice-");
        match fs::metadata(&destination) {
            Ok(there) if !there.is_dir() => return Err(failed(io::Error::from(io::ErrorKind::NotADirectory))),
            Ok(there) if there.permissions().readonly() => {
                return Err(failed(io::Error::other("it is read-only")));
            }
            Ok(there) => {
                for entry in fs::read_dir(&destination).map_err(failed)? {
                    let entry = entry.map_err(failed)?;
                    let name = entry.file_name();
                    let is_ours =
                        name.to_str().is_some_and(&ours) && entry.file_type().is_ok_and(|kind| kind.is_file());
                    if !is_ours {
                        let why = format!(
                            "it holds {}, which this command does not write and which would be lost: choose another folder",
                            name.display()
                        );
                        return Err(failed(io::Error::other(why)));
                    }
                }
                builder.permissions(there.permissions());
            }
            Err(_) if fs::symlink_metadata(&destination).is_ok() => {
                return Err(failed(io::Error::other("it is a link to a folder that does not exist")));
            }
            Err(_) => {
                #[cfg(unix)]
                builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
            }
        }
        let beside = folder_of(&destination).map_err(failed)?;
        // Only the kind of the error: its text names the temporary folder, which the user never sees.
        let filled = interrupt::temporary(|| builder.tempdir_in(beside));
        let filled = filled.map_err(|e| failed(io::Error::from(e.kind())))?;
        Ok(Folder { filled, destination })
    }

    /// Writes one file.
    pub(crate) fn write(&self, name: &str, contents: &[u8]) -> Result<(), Failure> {
        let target = || self.destination.join(name).display().to_string();
        // An interruption that removes the folder waits until the file is written.
        let written = interrupt::uninterrupted(|| fs::write(self.filled.path().join(name), contents));
        written.map_err(|error| Failure::Write { target: target(), error })
    }

    /// Moves the folder to its destination. Without this call it never appears.
    pub(crate) fn finish(self) -> Result<(), Failure> {
        let Folder { filled, destination } = self;
        let failed = |error| Failure::Write { target: destination.display().to_string(), error };
        interrupt::uninterrupted(|| {
            if !destination.exists() {
                fs::rename(filled.path(), &destination)?;
            } else {
                // The earlier folder moves aside, and back if its successor cannot take its place.
                let aside = filled.path().with_extension("old");
                fs::rename(&destination, &aside)?;
                if let Err(error) = fs::rename(filled.path(), &destination) {
                    fs::rename(&aside, &destination)?;
                    return Err(error);
                }
                fs::remove_dir_all(&aside)?;
            }
            // The temporary path no longer exists, so there is nothing to remove when it is dropped.
            let _ = filled.keep();
            Ok(())
        })
        .map_err(failed)
    }
}

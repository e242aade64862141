//! Files beside a layout, which are read while the layout is.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use crate::limits::MAX_FILE_BYTES;

/// Where the text of a layout is from.
pub(crate) struct Source {
    /// The folder that paths in the layout are relative to.
    pub(crate) folder: PathBuf,
    /// Whether the layout is the neighbour of another. Its own tolerances, and so its neighbours,
    /// do not count.
    pub(crate) is_neighbour: bool,
}

impl Source {
    /// The source of the layout file at this path.
    pub(crate) fn of_file(path: &Path) -> Source {
        Source { folder: path.parent().unwrap_or(Path::new("")).to_owned(), is_neighbour: false }
    }

    /// The source of a text of this origin: a file if the origin is the path of one, else the
    /// working folder.
    pub(crate) fn of_origin(origin: &str) -> Source {
        let path = Path::new(origin);
        if path.is_file() { Source::of_file(path) } else { Source { folder: PathBuf::new(), is_neighbour: false } }
    }
}

/// The contents of a file with at most 64 MiB.
pub(crate) fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    let too_large = || io::Error::other(format!("it has more than {MAX_FILE_BYTES} bytes, too many for a layout"));
    up_to(path, MAX_FILE_BYTES)?.ok_or_else(too_large)
}

/// The contents of a regular file with at most `most` bytes. Pipes and devices are refused before
/// they are opened, because opening a pipe waits for its other end.
pub(crate) fn regular_bytes(path: &Path, most: usize) -> io::Result<Vec<u8>> {
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::other("it is not a regular file"));
    }
    up_to(path, most)?.ok_or_else(|| io::Error::other(format!("it has more than {most} bytes, too many")))
}

/// The contents of a file, or `None` if it is too large. One byte more than the limit is enough to
/// see that, and ends the reading of a device that has no end.
fn up_to(path: &Path, most: usize) -> io::Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(most as u64 + 1).read_to_end(&mut bytes)?;
    Ok((bytes.len() <= most).then_some(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regular_files_are_read_up_to_their_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        fs::write(&path, "12345").unwrap();
        assert_eq!(regular_bytes(&path, 5).unwrap(), b"12345");
        assert_eq!(regular_bytes(&path, 6).unwrap(), b"12345");
        let refused = |path: &Path, most: usize| regular_bytes(path, most).unwrap_err().to_string();
        assert_eq!(refused(&path, 4), "it has more than 4 bytes, too many");
        assert_eq!(refused(folder.path(), 4), "it is not a regular file");
    }
}

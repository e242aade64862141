//! The file that is shown and kept. It is the truth: what is on disk counts.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use magsplice_page_engine::ReadableFiles;
use serde::Serialize;
use tokio::sync::watch;

use crate::failure::Failure;
use crate::file_watch::FileWatch;
use crate::output::destination::{Output, followed, is_standard};
use crate::sha256::sha256;

/// Largest size of the file, 16 MiB: a layout of 100 000 tiles.
pub(super) const MAX_FILE_BYTES: usize = 16 << 20;

/// Time without a change after which the file is read. Editors that empty a file and write it do so
/// within a few milliseconds. A change must arrive in the page within 200 ms, of which the watch
/// may wait three times this.
const SETTLED: Duration = Duration::from_millis(40);

/// The text of the file, or why it cannot be read.
pub(super) type Latest = Arc<Result<Contents, String>>;

/// The text of the file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Contents {
    pub(super) text: String,
    pub(super) sha256: String,
}

/// Why a text is not written.
#[derive(Debug)]
pub(super) enum NotWritten {
    /// The file on disk is another than the one that was changed.
    Conflict(Contents),
    /// The text is no layout, or refers to files that the file on disk does not refer to.
    Invalid(String),
    /// The file cannot be read or written.
    Failed(String),
}

/// The layout file of the page.
pub(super) struct LayoutFile {
    /// The path as the user named it.
    path: PathBuf,
    latest: watch::Sender<Latest>,
    /// The files that the file has referred to, with the hash of its last text that is TOML.
    readable: Mutex<(String, ReadableFiles)>,
    /// Held while the file is read or written and its state is published, so that states appear in
    /// their order.
    at_work: Mutex<()>,
}

impl LayoutFile {
    /// Opens a regular file. Its text may be broken.
    pub(super) fn open(path: &Path) -> Result<LayoutFile, Failure> {
        let unreadable = |why: String| Failure::Refused(unread(path, &why));
        if path == Path::new("-") || is_standard(path) {
            return Err(unreadable("studio keeps a file, must be the path of a layout file".to_owned()));
        }
        let found = fs::metadata(path).and_then(|found| File::open(path).map(|_| found));
        let found = found.map_err(|error| unreadable(error.to_string()))?;
        if !found.is_file() {
            let kind = if found.is_dir() { "a folder" } else { "not a regular file" };
            return Err(unreadable(format!("it is {kind}, must be a layout file")));
        }
        let readable = Mutex::new((String::new(), ReadableFiles::none(folder_of(path))));
        let latest = watch::Sender::new(Arc::new(read(path)));
        Ok(LayoutFile { path: path.to_owned(), latest, readable, at_work: Mutex::new(()) })
    }

    /// The name of the file without its folder.
    pub(super) fn name(&self) -> String {
        self.path.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// The path of the file, as messages name it.
    pub(super) fn shown_path(&self) -> String {
        self.path.display().to_string()
    }

    /// The text on disk, now.
    pub(super) fn read(&self) -> Latest {
        let _held = self.at_work.lock().unwrap_or_else(PoisonError::into_inner);
        self.publish(read(&self.path));
        self.latest.borrow().clone()
    }

    /// The state of the file, and its changes.
    pub(super) fn states(&self) -> watch::Receiver<Latest> {
        self.latest.subscribe()
    }

    /// A watch of the file, and of the one that it is a link to.
    pub(super) fn watch(&self) -> Result<FileWatch, Failure> {
        let mut files = vec![self.path.clone()];
        files.extend(followed(&self.path).ok().filter(|end| *end != self.path));
        FileWatch::new(&files)
    }

    /// Reads the file whenever it has changed, until the watch ends.
    pub(super) fn follow(&self, watch: &FileWatch) {
        loop {
            let waited = watch.wait(SETTLED);
            if let Err(failure) = waited {
                self.publish(Err(failure.to_string()));
                return;
            }
            self.read();
        }
    }

    /// The files beside it that a session may read: those to which the texts on disk have referred
    /// since the program began. Without earlier ones a page could not go back to its first text.
    pub(super) fn readable_files(&self) -> ReadableFiles {
        let mut known = self.readable.lock().unwrap_or_else(PoisonError::into_inner);
        if let Ok(Contents { text, sha256 }) = &**self.latest.borrow()
            && known.0 != *sha256
            && known.1.add(text)
        {
            known.0.clone_from(sha256);
        }
        known.1.clone()
    }

    /// Writes a valid layout in place of the text with the hash `base`, complete or not at all.
    /// Returns the new hash.
    pub(super) fn replace(&self, text: &str, base: &str) -> Result<String, NotWritten> {
        self.unless_changed(&self.read(), base)?;
        self.readable_files().layout(text, &self.shown_path()).map_err(NotWritten::Invalid)?;
        let _held = self.at_work.lock().unwrap_or_else(PoisonError::into_inner);
        let failed = |failure: Failure| NotWritten::Failed(failure.to_string());
        let mut output = Output::open(Some(&self.path), &[]).map_err(failed)?;
        output.write(|writer| writer.write_all(text.as_bytes())).map_err(failed)?;
        // Again, because reading a large layout takes long.
        self.unless_changed(&read(&self.path), base)?;
        output.finish().map_err(failed)?;
        let sha256 = sha256(text.as_bytes());
        self.publish(Ok(Contents { text: text.to_owned(), sha256: sha256.clone() }));
        Ok(sha256)
    }

    fn unless_changed(&self, read: &Result<Contents, String>, base: &str) -> Result<(), NotWritten> {
        match read {
            Ok(contents) if contents.sha256 == base => Ok(()),
            Ok(contents) => Err(NotWritten::Conflict(contents.clone())),
            Err(why) => Err(NotWritten::Failed(why.clone())),
        }
    }

    fn publish(&self, read: Result<Contents, String>) {
        self.latest.send_if_modified(|latest| {
            let is_new = **latest != read;
            if is_new {
                *latest = Arc::new(read);
            }
            is_new
        });
    }
}

/// The folder that names in the file are relative to.
fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// The text of a file, or why there is none.
fn read(path: &Path) -> Result<Contents, String> {
    let bytes = bytes(path).map_err(|error| unread(path, &error.to_string()))?;
    let sha256 = sha256(&bytes);
    let text = String::from_utf8(bytes).map_err(|error| format!("{}: not UTF-8 text: {error}", path.display()))?;
    Ok(Contents { text, sha256 })
}

/// The bytes of a regular file that fits into a request.
fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::other("it is not a regular file"));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(MAX_FILE_BYTES as u64 + 1).read_to_end(&mut bytes)?;
    if bytes.len() > MAX_FILE_BYTES {
        return Err(io::Error::other(format!("it has more than {MAX_FILE_BYTES} bytes, too many for a page")));
    }
    Ok(bytes)
}

fn unread(path: &Path, why: &str) -> String {
    format!("cannot read {}: {why}", path.display())
}

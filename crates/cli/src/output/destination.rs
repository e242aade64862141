//! Standard output, or a file that appears complete or not at all.

use std::fs;
use std::io::{self, BufWriter, Seek, StdoutLock, Write};
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, SpooledTempFile, TempPath};

use crate::failure::Failure;
use crate::interrupt;

/// Bytes of a result that are held back in memory; more of them go to a temporary file.
const MAX_HELD_BYTES: usize = 64 << 20;

/// Bytes that go to it in one piece. Rows are short, and each call of the file system takes long.
const HELD_PIECE_BYTES: usize = 1 << 20;

/// An open destination of a result.
pub(crate) enum Output {
    Stdout(BufWriter<StdoutLock<'static>>),
    /// A temporary file in the folder of its destination, which [`Output::finish`] moves there.
    File {
        writer: BufWriter<fs::File>,
        temporary: TempPath,
        destination: PathBuf,
        /// The destination as the user named it.
        named: PathBuf,
    },
    /// A device, a pipe, or anything else that is not a regular file.
    Special {
        writer: BufWriter<fs::File>,
        named: PathBuf,
    },
    /// Anything that [`Output::finish`] passes on as a whole.
    HeldBack {
        held: BufWriter<SpooledTempFile>,
        output: Box<Output>,
    },
}

impl Output {
    /// Opens `path`; without one, or with `-`, standard output. `inputs` are files it must not
    /// replace.
    pub(crate) fn open(path: Option<&Path>, inputs: &[&Path]) -> Result<Output, Failure> {
        let Some(path) = path.filter(|path| !is_standard(path)) else {
            return Ok(Output::Stdout(BufWriter::new(io::stdout().lock())));
        };
        let failed = |error: io::Error| Failure::write(path, error);
        let refused = |why: &str| failed(io::Error::other(why.to_owned()));
        let destination = followed(path).map_err(failed)?;
        if destination.is_dir() {
            return Err(failed(io::Error::from(io::ErrorKind::IsADirectory)));
        }
        if inputs.iter().any(|input| is_same_file_or_below(input, &destination)) {
            return Err(refused("it is an input, which would be lost: choose another name"));
        }
        let existing = fs::metadata(&destination).ok();
        if existing.as_ref().is_some_and(|m| !m.is_file()) || is_descriptor(path) {
            let file = fs::OpenOptions::new().write(true).open(path).map_err(failed)?;
            return Ok(Output::Special { writer: BufWriter::new(file), named: path.to_owned() });
        }
        if existing.as_ref().is_some_and(|m| m.permissions().readonly()) {
            return Err(refused("it is read-only"));
        }
        let file = beside(&destination, existing.map(|m| m.permissions())).map_err(failed)?;
        // The two apart, because errors of a NamedTempFile name a file that the user never sees.
        let (file, temporary) = file.into_parts();
        Ok(Output::File { writer: BufWriter::new(file), temporary, destination, named: path.to_owned() })
    }

    /// The same output, of which nothing appears before [`Output::finish`].
    pub(crate) fn held_back(self) -> Output {
        match self {
            // A file appears as a whole already.
            Output::File { .. } | Output::HeldBack { .. } => self,
            output => {
                let held = BufWriter::with_capacity(HELD_PIECE_BYTES, SpooledTempFile::new(MAX_HELD_BYTES));
                Output::HeldBack { held, output: Box::new(output) }
            }
        }
    }

    /// Whether this is standard output.
    pub(crate) fn is_standard(&self) -> bool {
        matches!(self, Output::Stdout(_))
    }

    /// Writes through `write`. A closed pipe is [`Failure::PipeClosed`].
    pub(crate) fn write(&mut self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
        let writer: &mut dyn Write = match self {
            Output::Stdout(writer) => writer,
            Output::File { writer, .. } | Output::Special { writer, .. } => writer,
            Output::HeldBack { held, .. } => held,
        };
        let mut writer = FirstError { writer, error: None };
        let result = write(&mut writer);
        writer.error.map_or(result, Err).map_err(|error| self.failure(error))
    }

    /// Completes the output. Without this call a file never appears.
    pub(crate) fn finish(mut self) -> Result<(), Failure> {
        self.write(|writer| writer.flush())?;
        if let Output::HeldBack { held, mut output } = self {
            let mut held = held.into_inner().map_err(|error| output.failure(error.into_error()))?;
            held.rewind().map_err(|error| output.failure(error))?;
            output.write(|writer| io::copy(&mut held, writer).map(drop))?;
            return output.finish();
        }
        if let Output::File { temporary, destination, named, .. } = self {
            temporary.persist(&destination).map_err(|e| Failure::write(&named, e.error))?;
        }
        Ok(())
    }

    /// Writes a text, which is the whole output.
    pub(crate) fn complete(mut self, text: &str) -> Result<(), Failure> {
        self.write(|writer| writer.write_all(text.as_bytes()))?;
        self.finish()
    }

    fn failure(&self, error: io::Error) -> Failure {
        match self {
            _ if error.kind() == io::ErrorKind::BrokenPipe => Failure::PipeClosed,
            Output::Stdout(_) => Failure::Write { target: "standard output".to_owned(), error },
            Output::File { named, .. } | Output::Special { named, .. } => Failure::write(named, error),
            Output::HeldBack { .. } => {
                Failure::Write { target: format!("to the folder {}", std::env::temp_dir().display()), error }
            }
        }
    }
}

/// A writer that keeps its first error, as the operating system gave it: writers of formats wrap
/// errors in words of their own. After an error it accepts everything, so that such a writer can
/// end without complaint.
struct FirstError<'a> {
    writer: &'a mut dyn Write,
    error: Option<io::Error>,
}

impl FirstError<'_> {
    fn unless_failed<T>(&mut self, done: T, work: impl FnOnce(&mut dyn Write) -> io::Result<T>) -> io::Result<T> {
        if self.error.is_some() {
            return Ok(done);
        }
        work(self.writer).map_err(|error| {
            let kind = error.kind();
            if kind != io::ErrorKind::Interrupted {
                self.error = Some(error);
            }
            io::Error::from(kind)
        })
    }
}

impl Write for FirstError<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.unless_failed(bytes.len(), |writer| writer.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.unless_failed((), |writer| writer.flush())
    }
}

/// Whether this path names standard output.
pub(crate) fn is_standard(path: &Path) -> bool {
    path == Path::new("-") || path == Path::new("/dev/stdout")
}

/// A temporary file in the folder of `destination`, removed by an interruption.
fn beside(destination: &Path, permissions: Option<fs::Permissions>) -> io::Result<NamedTempFile> {
    let folder = folder_of(destination)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".magsplice-");
    if let Some(permissions) = permissions.clone().or(new_file_permissions()) {
        builder.permissions(permissions);
    }
    // Only the kind of the error: its text names the temporary file, which the user never sees.
    let file = interrupt::temporary(|| builder.tempfile_in(folder)).map_err(|e| io::Error::from(e.kind()))?;
    // Without the user's mask: the file was made with them. Not every file system keeps them.
    if let Some(permissions) = permissions {
        let _ = file.as_file().set_permissions(permissions);
    }
    Ok(file)
}

/// The folder that contains a destination.
pub(crate) fn folder_of(destination: &Path) -> io::Result<&Path> {
    let folder = destination.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if folder.is_dir() {
        return Ok(folder);
    }
    let why = if folder.exists() { "is not a folder" } else { "does not exist" };
    Err(io::Error::other(format!("{} {why}", folder.display())))
}

/// Writes a new file, complete or not at all. Refuses to replace a file.
pub(crate) fn create(path: &Path, text: &str) -> Result<(), Failure> {
    let written = beside(path, None).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.persist_noclobber(path).map_err(|e| e.error)
    });
    written.map(drop).map_err(|error| {
        let error = match error.kind() {
            io::ErrorKind::AlreadyExists => io::Error::other("it exists already, and was not changed"),
            _ => error,
        };
        Failure::write(path, error)
    })
}

/// The path with its links followed, whether or not anything is at its end. Links that lead in a
/// circle are an error.
pub(crate) fn followed(path: &Path) -> io::Result<PathBuf> {
    match path.canonicalize() {
        Ok(end) => Ok(end),
        Err(error) if path.is_symlink() && error.kind() != io::ErrorKind::NotFound => Err(error),
        Err(_) => {
            let mut end = path.to_owned();
            while let Ok(target) = fs::read_link(&end) {
                end = end.parent().unwrap_or(Path::new("")).join(target);
            }
            Ok(end)
        }
    }
}

/// Whether an input, or `-` for standard input, is the file or in the folder `destination`.
pub(crate) fn is_same_file_or_below(input: &Path, destination: &Path) -> bool {
    let input = if input == Path::new("-") { Path::new("/dev/stdin") } else { input };
    input.canonicalize().is_ok_and(|input| input.starts_with(destination))
}

/// Whether the path names a file that the shell has opened.
fn is_descriptor(path: &Path) -> bool {
    let is_fd = path.parent().is_some_and(|folder| folder.ends_with("fd"));
    path == Path::new("/dev/stderr") || is_fd && (path.starts_with("/dev") || path.starts_with("/proc"))
}

/// Permissions of any new file, before the user's mask is applied. Temporary files have fewer by
/// default.
fn new_file_permissions() -> Option<fs::Permissions> {
    #[cfg(unix)]
    return Some(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    #[cfg(not(unix))]
    return None;
}

/// Writes a text to standard output.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    Output::open(None, &[])?.complete(text)
}

//! Standard output, or a file that appears complete or not at all.

use std::fs;
use std::io::{self, BufWriter, StdoutLock, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::failure::Failure;
use crate::interrupt;

/// An open destination of a result.
pub(crate) enum Output {
    Stdout(BufWriter<StdoutLock<'static>>),
    /// A temporary file in the folder of its destination, which [`Output::finish`] moves there.
    File {
        writer: BufWriter<NamedTempFile>,
        destination: PathBuf,
    },
    /// A device, a pipe, or anything else that is not a regular file.
    Special {
        writer: BufWriter<fs::File>,
        destination: PathBuf,
    },
}

impl Output {
    /// Opens `path`; without one, or with `-`, standard output. `inputs` are files it must not
    /// replace.
    pub(crate) fn open(path: Option<&Path>, inputs: &[&Path]) -> Result<Output, Failure> {
        let Some(path) = path.filter(|path| !is_standard(path)) else {
            return Ok(Output::Stdout(BufWriter::new(io::stdout().lock())));
        };
        let failed = |error: io::Error| Failure::Write { target: path.display().to_string(), error };
        let refused = |why: &str| failed(io::Error::other(why.to_owned()));
        let destination = followed(path);
        if destination.is_dir() {
            return Err(failed(io::Error::from(io::ErrorKind::IsADirectory)));
        }
        let existing = fs::metadata(&destination).ok();
        if existing.as_ref().is_some_and(|m| !m.is_file()) || path.starts_with("/dev") || path.starts_with("/proc") {
            let file = fs::OpenOptions::new().write(true).open(path).map_err(failed)?;
            return Ok(Output::Special { writer: BufWriter::new(file), destination: path.to_owned() });
        }
        let same = |input: &&Path| input.canonicalize().is_ok_and(|input| input == destination);
        if inputs.iter().any(same) {
            return Err(refused("it is an input, which would be lost: choose another name"));
        }
        if existing.as_ref().is_some_and(|m| m.permissions().readonly()) {
            return Err(refused("it is read-only"));
        }
        let file = beside(&destination, existing.map(|m| m.permissions())).map_err(failed)?;
        Ok(Output::File { writer: BufWriter::new(file), destination })
    }

    /// Whether this is standard output.
    pub(crate) fn is_standard(&self) -> bool {
        matches!(self, Output::Stdout(_))
    }

    /// Writes through `write`. A closed pipe is [`Failure::PipeClosed`].
    pub(crate) fn write(&mut self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
        let result = match self {
            Output::Stdout(writer) => write(writer),
            Output::File { writer, .. } => write(writer),
            Output::Special { writer, .. } => write(writer),
        };
        result.map_err(|error| self.failure(error))
    }

    /// Completes the output. Without this call a file never appears.
    pub(crate) fn finish(mut self) -> Result<(), Failure> {
        self.write(|writer| writer.flush())?;
        if let Output::File { writer, destination } = self {
            let failed = |error: io::Error| Failure::Write { target: destination.display().to_string(), error };
            let file = writer.into_inner().map_err(|e| failed(e.into_error()))?;
            file.persist(&destination).map_err(|e| failed(e.error))?;
        }
        Ok(())
    }

    fn failure(&self, error: io::Error) -> Failure {
        match self {
            _ if error.kind() == io::ErrorKind::BrokenPipe => Failure::PipeClosed,
            Output::Stdout(_) => Failure::Write { target: "standard output".to_owned(), error },
            Output::File { destination, .. } | Output::Special { destination, .. } => {
                Failure::Write { target: destination.display().to_string(), error }
            }
        }
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
    if let Some(permissions) = permissions.or(new_file_permissions()) {
        builder.permissions(permissions);
    }
    // Only the kind of the error: its text names the temporary file, which the user never sees.
    interrupt::temporary(|| builder.tempfile_in(folder)).map_err(|e| io::Error::from(e.kind()))
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
        Failure::Write { target: path.display().to_string(), error }
    })
}

/// The path with its links followed, whether or not a file is at its end.
fn followed(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| match fs::read_link(path) {
        Ok(target) => path.parent().unwrap_or(Path::new("")).join(target),
        Err(_) => path.to_owned(),
    })
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
    let mut output = Output::open(None, &[])?;
    output.write(|writer| writer.write_all(text.as_bytes()))?;
    output.finish()
}

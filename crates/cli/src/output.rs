//! Where results go: standard output, or a file that appears whole or not at all.

use std::fs;
use std::io::{self, BufWriter, StdoutLock, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::failure::Failure;
use crate::interrupt;

/// An open result.
pub(crate) enum Output {
    Stdout(BufWriter<StdoutLock<'static>>),
    /// Written beside its destination, and moved there by [`Output::finish`].
    File {
        writer: BufWriter<NamedTempFile>,
        destination: PathBuf,
    },
    /// Something that is not a regular file, such as a device or a pipe.
    Special {
        writer: BufWriter<fs::File>,
        destination: PathBuf,
    },
}

impl Output {
    /// Opens `path`; without one, or with `-`, standard output. `inputs` are files it must not replace.
    pub(crate) fn open(path: Option<&Path>, inputs: &[&Path]) -> Result<Output, Failure> {
        let Some(path) = path.filter(|p| *p != Path::new("-") && *p != Path::new("/dev/stdout")) else {
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
            return Err(refused("it is the input, which would be lost"));
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

    /// Writes through `write`, telling a closed pipe from a failure.
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

/// A temporary file in the folder of `destination`, gone after an interruption.
fn beside(destination: &Path, permissions: Option<fs::Permissions>) -> io::Result<NamedTempFile> {
    let folder = folder_of(destination)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".magsplice-");
    if let Some(permissions) = permissions.or(new_file_permissions()) {
        builder.permissions(permissions);
    }
    // The error of the library names the temporary file, which nobody knows.
    interrupt::temporary(|| builder.tempfile_in(folder)).map_err(|e| io::Error::from(e.kind()))
}

/// The folder a destination is in.
pub(crate) fn folder_of(destination: &Path) -> io::Result<&Path> {
    let folder = destination.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if folder.is_dir() {
        return Ok(folder);
    }
    let why = if folder.exists() { "is not a folder" } else { "does not exist" };
    Err(io::Error::other(format!("{} {why}", folder.display())))
}

/// Writes a file that must not be there yet, whole or not at all.
pub(crate) fn create(path: &Path, text: &str) -> Result<(), Failure> {
    let written = beside(path, None).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.persist_noclobber(path).map_err(|e| e.error)
    });
    written.map(drop).map_err(|error| {
        let error = match error.kind() {
            io::ErrorKind::AlreadyExists => io::Error::other("it is there already, and is left as it is"),
            _ => error,
        };
        Failure::Write { target: path.display().to_string(), error }
    })
}

/// Where a path leads, through links, whether or not there is something at its end.
fn followed(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| match fs::read_link(path) {
        Ok(target) => path.parent().unwrap_or(Path::new("")).join(target),
        Err(_) => path.to_owned(),
    })
}

/// What any new file gets: the mask of the user takes its bits away. Temporary files would get less.
fn new_file_permissions() -> Option<fs::Permissions> {
    #[cfg(unix)]
    return Some(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    #[cfg(not(unix))]
    return None;
}

/// Writes a whole text to standard output.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut output = Output::open(None, &[])?;
    output.write(|writer| writer.write_all(text.as_bytes()))?;
    output.finish()
}

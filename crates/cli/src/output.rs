//! Where results go: standard output, or a file that appears whole or not at all.

use std::fs;
use std::io::{self, BufWriter, StdoutLock, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::failure::Failure;

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
    /// Opens `path`, or standard output.
    pub(crate) fn open(path: Option<&Path>) -> Result<Output, Failure> {
        let Some(path) = path else {
            return Ok(Output::Stdout(BufWriter::new(io::stdout().lock())));
        };
        let failed = |error: io::Error| Failure::Write { target: path.display().to_string(), error };
        // A link is followed, so that it stays a link.
        let destination = if path.exists() { path.canonicalize().map_err(failed)? } else { path.to_owned() };
        if destination.is_dir() {
            return Err(failed(io::Error::from(io::ErrorKind::IsADirectory)));
        }
        if destination.exists() && !destination.is_file() {
            let file = fs::OpenOptions::new().write(true).open(&destination).map_err(failed)?;
            return Ok(Output::Special { writer: BufWriter::new(file), destination });
        }
        let folder = destination.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut builder = tempfile::Builder::new();
        builder.prefix(".magsplice-");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // The mask of the user takes its bits away from this, as for any new file.
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let file = builder.tempfile_in(folder).map_err(failed)?;
        Ok(Output::File { writer: BufWriter::new(file), destination })
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

/// Writes a whole text to standard output.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut output = Output::open(None)?;
    output.write(|writer| writer.write_all(text.as_bytes()))?;
    output.finish()
}

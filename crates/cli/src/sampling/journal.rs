//! The journal of a run: every sample as soon as it is known, in a file beside the one that the run
//! will write. A run that was interrupted or killed continues from it.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::sample_file;
use super::source::SampleSource;
use crate::failure::Failure;
use crate::text::number::counted;
use magsplice::decouple::Figures;

/// What the name of a journal ends with.
const ENDING: &str = ".partial";

/// An open journal.
pub(crate) struct Journal {
    file: File,
    path: PathBuf,
    next: u64,
}

impl Journal {
    /// The path of the journal of a run that will write `save`.
    pub(crate) fn path_beside(save: &Path) -> PathBuf {
        let mut name = OsString::from(save);
        name.push(ENDING);
        PathBuf::from(name)
    }

    /// Opens a journal, and the samples that it holds. A journal of an earlier run is continued if
    /// `resume`, and is refused otherwise, so that no samples are lost.
    pub(crate) fn open(save: &Path, source: &SampleSource, resume: bool) -> Result<(Journal, Vec<Figures>), Failure> {
        let path = Journal::path_beside(save);
        let failed = |error: io::Error| Failure::Write { target: path.display().to_string(), error };
        // A run that was killed before the names of the figures were written has no samples.
        let has_samples = match fs::metadata(&path) {
            Ok(there) => !there.is_file() || has_heading(&path).map_err(failed)?,
            Err(error) if error.kind() == io::ErrorKind::NotFound => false,
            Err(error) => return Err(failed(error)),
        };
        if has_samples {
            let earlier = sample_file::read(&path)?;
            let refused = |message: String| Failure::Points { path: path.clone(), message };
            if !resume {
                return Err(refused(format!(
                    "holds {} of an earlier run: give --resume to continue it, or remove the file",
                    counted(earlier.errors.len(), "sample", "samples")
                )));
            }
            if earlier.source != *source {
                return Err(refused(format!("is of another run: {}", difference(&earlier.source, source))));
            }
            let file = OpenOptions::new().append(true).open(&path).map_err(failed)?;
            // Without the line that was not finished.
            file.set_len(earlier.bytes).map_err(failed)?;
            let next = source.first + earlier.errors.len() as u64;
            return Ok((Journal { file, path, next }, earlier.errors));
        }
        let mut file = File::create(&path).map_err(failed)?;
        let heading = format!("{}\n{}\n", source.line(), sample_file::heading());
        file.write_all(heading.as_bytes()).map_err(failed)?;
        Ok((Journal { file, path, next: source.first }, Vec::new()))
    }

    /// The path of the file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Appends the next samples.
    pub(crate) fn append(&mut self, errors: &[Figures]) -> Result<(), Failure> {
        let lines: String =
            (self.next..).zip(errors).map(|(sample, errors)| sample_file::line(sample, errors) + "\n").collect();
        self.next += errors.len() as u64;
        let written = self.file.write_all(lines.as_bytes());
        written.map_err(|error| Failure::Write { target: self.path.display().to_string(), error })
    }

    /// Removes the file, after its samples are written elsewhere.
    pub(crate) fn remove(self) -> Result<(), Failure> {
        let Journal { file, path, .. } = self;
        drop(file);
        fs::remove_file(&path).map_err(|error| Failure::Write { target: path.display().to_string(), error })
    }
}

/// Whether a journal was written beyond its first two lines' beginning.
fn has_heading(path: &Path) -> io::Result<bool> {
    let heading = sample_file::heading();
    let mut start = vec![0; 4096];
    let length = io::Read::read(&mut File::open(path)?, &mut start)?;
    let start = String::from_utf8_lossy(&start[..length]);
    let mut lines = start.split_inclusive('\n');
    let first = lines.next().unwrap_or("");
    let begun = first.ends_with('\n') && lines.next().is_some_and(|line| line.trim_end() == heading);
    // Anything else than the beginning of a journal is somebody's file.
    let is_beginning = start.is_empty()
        || SampleSource::parse(first.trim_end()).is_some()
        || "# magsplice tolerance: film ".starts_with(&*start)
        || (!first.ends_with('\n') && start.starts_with("# magsplice tolerance: film "));
    Ok(begun || !is_beginning)
}

fn difference(earlier: &SampleSource, source: &SampleSource) -> String {
    if earlier.fingerprint != source.fingerprint {
        return "its layout or [tolerance] has changed since".to_owned();
    }
    let SampleSource { seed, first, count, .. } = earlier;
    format!("it has seed {seed}, first {first}, count {count}: give --seed {seed} --first {first} --count {count}")
}

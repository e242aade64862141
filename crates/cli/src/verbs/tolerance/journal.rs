//! The journal of a run: every sample as soon as it is known, in a file beside the one that the run
//! will write. A run that was interrupted or killed continues from it.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use magsplice::decouple::Figures;
use magsplice::results::SampleRun;

use super::sample_file;
use crate::failure::Failure;
use crate::text::number::counted;

/// What the name of a journal ends with.
const ENDING: &str = ".partial";

/// An open journal.
pub(super) struct Journal {
    file: File,
    path: PathBuf,
    next: u64,
}

impl Journal {
    /// The path of the journal of a run that will write `save`.
    pub(super) fn path_beside(save: &Path) -> PathBuf {
        let mut name = OsString::from(save);
        name.push(ENDING);
        PathBuf::from(name)
    }

    /// Opens a journal, and the samples that it holds. A journal of an earlier run is continued if
    /// `resume`, and is refused otherwise, so that no samples are lost.
    pub(super) fn open(save: &Path, run: &SampleRun, resume: bool) -> Result<(Journal, Vec<Figures>), Failure> {
        let path = Journal::path_beside(save);
        let failed = |error: io::Error| Failure::write(&path, error);
        // A run that was killed before the names of the figures were written has no samples.
        let has_samples = match fs::metadata(&path) {
            Ok(there) => !there.is_file() || has_heading(&path).map_err(failed)?,
            Err(error) if error.kind() == io::ErrorKind::NotFound => false,
            Err(error) => return Err(failed(error)),
        };
        if has_samples {
            let earlier = sample_file::read(&path)?;
            let refused = |message: String| Failure::at(&path, message);
            if !resume {
                return Err(refused(format!(
                    "holds {} of an earlier run: give --resume to continue it, or remove the file",
                    counted(earlier.samples.len(), "sample", "samples")
                )));
            }
            if earlier.run != *run {
                return Err(refused(format!("is of another run: {}", difference(&earlier.run, run))));
            }
            let file = OpenOptions::new().append(true).open(&path).map_err(failed)?;
            // Without the line that was not finished.
            file.set_len(earlier.bytes).map_err(failed)?;
            let next = run.first + earlier.samples.len() as u64;
            return Ok((Journal { file, path, next }, earlier.samples));
        }
        let mut file = File::create(&path).map_err(failed)?;
        let heading = format!("{}\n{}\n", sample_file::first_line(run), sample_file::heading());
        file.write_all(heading.as_bytes()).map_err(failed)?;
        Ok((Journal { file, path, next: run.first }, Vec::new()))
    }

    /// The path of the file.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Appends the next samples.
    pub(super) fn append(&mut self, samples: &[Figures]) -> Result<(), Failure> {
        let lines: String =
            (self.next..).zip(samples).map(|(sample, figures)| sample_file::line(sample, figures) + "\n").collect();
        self.next += samples.len() as u64;
        let written = self.file.write_all(lines.as_bytes());
        written.map_err(|error| Failure::write(&self.path, error))
    }

    /// Removes the file, after its samples are written elsewhere.
    pub(super) fn remove(self) -> Result<(), Failure> {
        let Journal { file, path, .. } = self;
        drop(file);
        fs::remove_file(&path).map_err(|error| Failure::write(&path, error))
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
        || sample_file::parse_first_line(first.trim_end()).is_some()
        || sample_file::BEGINNING.starts_with(&*start)
        || (!first.ends_with('\n') && start.starts_with(sample_file::BEGINNING));
    Ok(begun || !is_beginning)
}

fn difference(earlier: &SampleRun, run: &SampleRun) -> String {
    if earlier.film != run.film {
        return "its layout or [tolerance] has changed since".to_owned();
    }
    let SampleRun { seed, first, count, .. } = earlier;
    format!("it has seed {seed}, first {first}, count {count}: give --seed {seed} --first {first} --count {count}")
}

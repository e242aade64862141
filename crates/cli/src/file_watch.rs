//! Files whose changes are awaited.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use notify::{Event, EventKind, RecommendedWatcher, RecursiveMode, Watcher};

use crate::failure::Failure;

/// Longest wait for a file to settle, in times without a change: a file that is written without a
/// pause is read while it is written.
const LONGEST_WAIT: u32 = 3;

/// A watch of files, by their names in the watched folders.
pub(crate) struct FileWatch {
    changes: Receiver<notify::Result<Event>>,
    names: Vec<OsString>,
    /// The file that failures name.
    first: PathBuf,
    /// Reports changes as long as it lives.
    _watcher: RecommendedWatcher,
}

impl FileWatch {
    /// Watches at least one file. The folders are watched, not the files: an editor that replaces
    /// a file leaves a watch of the old file behind.
    pub(crate) fn new(files: &[PathBuf]) -> Result<FileWatch, Failure> {
        let first = files[0].clone();
        let (sender, changes) = mpsc::channel();
        let report = move |event: notify::Result<Event>| {
            // Nobody waits for changes while the program ends.
            let _ = sender.send(event);
        };
        let mut watcher = notify::recommended_watcher(report).map_err(|error| unwatched(&first, &error))?;
        let mut folders: Vec<PathBuf> = Vec::new();
        for file in files {
            let folder = match file.parent() {
                Some(folder) if folder != Path::new("") => folder.to_owned(),
                _ => PathBuf::from("."),
            };
            if !folders.contains(&folder) {
                watcher.watch(&folder, RecursiveMode::NonRecursive).map_err(|error| unwatched(file, &error))?;
                folders.push(folder);
            }
        }
        let names = files.iter().filter_map(|file| file.file_name()).map(OsString::from).collect();
        Ok(FileWatch { changes, names, first, _watcher: watcher })
    }

    /// Waits until one of the files has changed, and then has not changed for this time.
    pub(crate) fn wait(&self, settled: Duration) -> Result<(), Failure> {
        let ended = || Failure::Refused("the watch of the layout ended".to_owned());
        while !self.concerns(self.changes.recv().map_err(|_| ended())?)? {}
        let begun = Instant::now();
        let latest = begun + settled * LONGEST_WAIT;
        let mut settles = begun + settled;
        loop {
            match self.changes.recv_timeout(settles.min(latest).saturating_duration_since(Instant::now())) {
                Ok(event) => {
                    if self.concerns(event)? {
                        settles = Instant::now() + settled;
                    }
                }
                Err(RecvTimeoutError::Timeout) => return Ok(()),
                Err(RecvTimeoutError::Disconnected) => return Err(ended()),
            }
        }
    }

    /// Whether an event may have changed one of the files.
    fn concerns(&self, event: notify::Result<Event>) -> Result<bool, Failure> {
        match event {
            Ok(event) if matches!(event.kind, EventKind::Access(_)) => Ok(false),
            // After lost events any file may have changed.
            Ok(event) => {
                let is_ours =
                    |path: &PathBuf| path.file_name().is_some_and(|name| self.names.iter().any(|n| n == name));
                Ok(event.need_rescan() || event.paths.iter().any(is_ours))
            }
            Err(error) => Err(unwatched(&self.first, &error)),
        }
    }
}

fn unwatched(file: &Path, error: &notify::Error) -> Failure {
    Failure::Refused(format!("cannot watch {}: {error}", file.display()))
}

//! `report --watch`: draws anew when a layout is saved.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::time::Duration;

use notify::{Event, EventKind, RecursiveMode, Watcher};

use super::draw::Drawing;
use crate::failure::{self, Failure};
use crate::interrupt;

/// Time without a change after which a file counts as saved. Editors write, rename and change the
/// permissions of a file within a few milliseconds.
const SETTLED: Duration = Duration::from_millis(150);

/// Draws the report, and again whenever the contents of a layout have changed. It ends with Ctrl-C
/// only, or if the report cannot be written.
pub(super) fn run(layouts: &[PathBuf], drawing: &Drawing) -> Result<(), Failure> {
    interrupt::handle();
    let (sender, changes) = mpsc::channel();
    let report = move |event: notify::Result<Event>| {
        // The receiver lives as long as the program.
        let _ = sender.send(event);
    };
    let mut watcher = notify::recommended_watcher(report).map_err(|error| unwatched(&layouts[0], &error))?;
    // The folders are watched, not the files: an editor that replaces a file leaves a watch of the
    // old file behind.
    let mut names: Vec<OsString> = Vec::new();
    let mut folders: Vec<PathBuf> = Vec::new();
    for layout in layouts {
        let folder = match layout.parent() {
            Some(folder) if folder != Path::new("") => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        names.extend(layout.file_name().map(OsString::from));
        if !folders.contains(&folder) {
            watcher.watch(&folder, RecursiveMode::NonRecursive).map_err(|error| unwatched(layout, &error))?;
            folders.push(folder);
        }
    }
    let mut drawn: Vec<Option<Vec<u8>>> = Vec::new();
    loop {
        // Read before the drawing, so that a file saved meanwhile differs.
        let contents: Vec<Option<Vec<u8>>> = layouts.iter().map(|layout| fs::read(layout).ok()).collect();
        if contents != drawn {
            drawn = contents;
            match drawing.draw(layouts) {
                Ok(()) => {}
                // Nobody can see the report or read of it.
                Err(failure @ (Failure::Write { .. } | Failure::PipeClosed)) => return Err(failure),
                Err(failure) => failure::tell(&failure),
            }
            if !drawing.quiet {
                let layouts: Vec<String> = layouts.iter().map(|layout| layout.display().to_string()).collect();
                failure::tell(&format_args!("waiting for changes of {}; Ctrl-C ends", layouts.join(" and ")));
            }
        }
        wait(&changes, &names, &layouts[0])?;
    }
}

/// Waits until one of the files has changed and nothing more happens to them.
fn wait(changes: &Receiver<notify::Result<Event>>, names: &[OsString], layout: &Path) -> Result<(), Failure> {
    let concerns = |event: notify::Result<Event>| match event {
        Ok(event) if matches!(event.kind, EventKind::Access(_)) => Ok(false),
        // After lost events any file may have changed.
        Ok(event) => {
            let named = |path: &PathBuf| path.file_name().is_some_and(|name| names.iter().any(|n| n == name));
            Ok(event.need_rescan() || event.paths.iter().any(named))
        }
        Err(error) => Err(unwatched(layout, &error)),
    };
    let ended = || Failure::Refused("the watch of the layout ended".to_owned());
    while !concerns(changes.recv().map_err(|_| ended())?)? {}
    loop {
        match changes.recv_timeout(SETTLED) {
            Ok(event) => concerns(event)?,
            Err(RecvTimeoutError::Timeout) => return Ok(()),
            Err(RecvTimeoutError::Disconnected) => return Err(ended()),
        };
    }
}

fn unwatched(layout: &Path, error: &notify::Error) -> Failure {
    Failure::Refused(format!("cannot watch {}: {error}", layout.display()))
}

//! `report --watch`: draws anew when a layout is saved.

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use super::draw::Drawing;
use crate::failure::{self, Failure};
use crate::file_watch::FileWatch;
use crate::interrupt;

/// Time without a change after which a file counts as saved. Editors write, rename and change the
/// permissions of a file within a few milliseconds.
const SETTLED: Duration = Duration::from_millis(150);

/// Draws the report, and again whenever the contents of a layout have changed. It ends with Ctrl-C
/// only, or if the report cannot be written.
pub(super) fn run(layouts: &[PathBuf], drawing: &Drawing) -> Result<(), Failure> {
    interrupt::handle();
    let watch = FileWatch::new(layouts)?;
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
        watch.wait(SETTLED)?;
    }
}

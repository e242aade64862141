//! A file for a page to print.

use std::path::Path;

use clap::ValueEnum;

use super::choice;
use super::destination::Output;
use crate::args::formats::{FileFormat, FileKind};
use crate::failure::Failure;

/// The format of a page.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum PageFormat {
    /// A page of HTML
    Html,
}

impl FileFormat for PageFormat {
    const OPTION: Option<&'static str> = None;

    fn file(self) -> FileKind {
        FileKind::text(&["html", "htm"]).known_by_ending()
    }
}

/// Opens the file, so that one that cannot be written is refused before any work.
pub(crate) fn open(path: Option<&Path>, inputs: &[&Path]) -> Result<Option<Output>, Failure> {
    let Some(path) = path else { return Ok(None) };
    let PageFormat::Html = choice::choose(None, Some(path), None)?;
    Output::open(Some(path), inputs).map(Some)
}

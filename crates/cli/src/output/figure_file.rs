//! A file for one figure.

use std::path::Path;

use clap::ValueEnum;
use magsplice_report::{Drawing, ReportError};

use super::choice;
use super::destination::Output;
use crate::args::formats::{FileFormat, FileKind};
use crate::failure::Failure;

/// Formats of a figure.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum FigureFormat {
    /// Vectors, with text as text
    Svg,
    /// Pixels, 300 per inch
    Png,
    /// Vectors, with text as outlines
    Pdf,
}

impl FileFormat for FigureFormat {
    const OPTION: Option<&'static str> = None;

    fn file(self) -> FileKind {
        match self {
            FigureFormat::Svg => FileKind::text(&["svg"]).known_by_ending(),
            FigureFormat::Pdf => FileKind::binary(&["pdf"]).known_by_ending(),
            FigureFormat::Png => FileKind::binary(&["png"]).known_by_ending(),
        }
    }
}

/// A file for the figure.
pub(crate) struct FigureFile {
    format: FigureFormat,
    output: Output,
}

/// Opens the file, so that one that cannot be written is refused before any work.
pub(crate) fn open(path: Option<&Path>, inputs: &[&Path]) -> Result<Option<FigureFile>, Failure> {
    let Some(path) = path else { return Ok(None) };
    let format = choice::choose(None, Some(path), None)?;
    Ok(Some(FigureFile { format, output: Output::open(Some(path), inputs)? }))
}

impl FigureFile {
    /// Writes the figure that was drawn.
    pub(crate) fn write(mut self, drawn: Result<Drawing, ReportError>) -> Result<(), Failure> {
        let figure = drawn?;
        let pdf = if self.format == FigureFormat::Pdf { figure.pdf()? } else { Vec::new() };
        self.output.write(|w| match self.format {
            FigureFormat::Pdf => w.write_all(&pdf),
            FigureFormat::Svg => w.write_all(figure.svg.as_bytes()),
            FigureFormat::Png => w.write_all(&figure.png),
        })?;
        self.output.finish()
    }
}

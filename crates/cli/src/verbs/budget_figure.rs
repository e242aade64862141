//! `budget --figure`: the budget as a bar chart.

use std::path::Path;

use clap::ValueEnum;
use magsplice_report::{BudgetBar, budget_figure};

use crate::args::formats::FileFormat;
use crate::failure::Failure;
use crate::output::choice;
use crate::output::destination::Output;
use crate::sampling::film_budget::FilmBudget;

/// Formats of a figure.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum FigureFormat {
    /// Vectors, with text as text
    Svg,
    /// Pixels, 300 per inch
    Png,
}

impl FileFormat for FigureFormat {
    const OPTION: &'static str = "--figure";

    fn endings(self) -> &'static [&'static str] {
        match self {
            FigureFormat::Svg => &["svg"],
            FigureFormat::Png => &["png"],
        }
    }

    fn is_binary(self) -> bool {
        self == FigureFormat::Png
    }

    fn is_known_by_ending(self) -> bool {
        true
    }
}

/// A file for the figure.
pub(super) struct FigureFile {
    format: FigureFormat,
    output: Output,
}

/// Opens the file, so that one that cannot be written is refused before any work.
pub(super) fn open(path: Option<&Path>, inputs: &[&Path]) -> Result<Option<FigureFile>, Failure> {
    let Some(path) = path else { return Ok(None) };
    let format = choice::choose(None, Some(path), None)?;
    Ok(Some(FigureFile { format, output: Output::open(Some(path), inputs)? }))
}

impl FigureFile {
    pub(super) fn write(mut self, film: &FilmBudget) -> Result<(), Failure> {
        let bar = |part: crate::sampling::film_budget::BudgetPart| BudgetBar {
            name: part.name,
            mean_squares_mm2: part.mean_squares_mm2,
        };
        let bars: Vec<BudgetBar> = film.parts().into_iter().map(bar).collect();
        let drawn = budget_figure(&bars, film.totals_mm2());
        let figure = drawn.map_err(|error| Failure::Format(error.to_string()))?;
        self.output.write(|w| match self.format {
            FigureFormat::Svg => w.write_all(figure.svg.as_bytes()),
            FigureFormat::Png => w.write_all(&figure.png),
        })?;
        self.output.finish()
    }
}

//! A report: all figures of a film, and the page.

use std::sync::atomic::{AtomicUsize, Ordering};

use magsplice::{Film, Stage};
use rayon::prelude::*;

use crate::drawing::{Drawing, FigureDraft, SvgText};
use crate::error::ReportError;
use crate::figure_drafts::drafts;
use crate::film_results::{FilmResults, ReportInput};
use crate::html::Pages;
use crate::page::{LIVE_PAGE_NAME, page};
use crate::shared_ranges::SharedRanges;

/// File name of the page.
pub(crate) const PAGE_NAME: &str = "report.html";

/// The figures of a film, and the HTML page that shows them.
///
/// A layout with a working volume and an ideal film has eight figures, and two more with a sensor.
/// Without an ideal film the figures of the decoupling parameters are missing; without a working
/// volume the only figure is the one of the tiles. [`Report::absent`] gives the reasons.
///
/// # Example
///
/// ```
/// use magsplice::Film;
/// use magsplice::layout::Layout;
/// use magsplice_report::{Report, ReportInput, SvgText};
///
/// let layout = Layout::parse(
///     r#"
///     format = 1
///     name = "one tile"
///     [[tile]]
///     position_mm = [0, 0, 0.5]
///     size_mm = [3, 3, 1]
///     polarization_t = [0.12, 0, 0]
///     "#,
///     "one-tile.toml",
/// )?;
/// let film = Film::new(layout)?;
/// let report = Report::new(&film, &ReportInput::default(), SvgText::Text)?;
///
/// // The layout has no working volume, so the report has the tiles only.
/// let names: Vec<String> = report.files().into_iter().map(|(name, _)| name).collect();
/// assert_eq!(names, ["report.html", "layout.svg", "layout.png", "layout.csv"]);
/// assert!(report.absent[0].contains("no [volume] table"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Report {
    /// The figures, in the order of the page.
    pub figures: Vec<Drawing>,
    /// The page by itself: HTML that loads no other file.
    pub html: String,
    /// The page with links to the files of the figures, for a folder with them.
    pub html_in_folder: String,
    /// The live page of the film, if there is one.
    pub live_page: Option<String>,
    /// What the report lacks, and why: one phrase each, without a full stop.
    pub absent: Vec<String>,
}

impl Report {
    /// Draws all figures that the layout allows, and the page.
    ///
    /// The figures have the accuracy of the film. `text` is the form of text in the SVG files; on
    /// the page it is always outlines.
    ///
    /// # Errors
    /// - [`ReportError::Film`] if the film cannot be evaluated.
    /// - [`ReportError::Drawing`] if a figure cannot be drawn.
    pub fn new(film: &Film, input: &ReportInput, text: SvgText) -> Result<Report, ReportError> {
        let results = FilmResults::new(film, input)?;
        let figures = rendered(film, drafts(&results, &SharedRanges::default())?, text)?;
        film.tell(Stage::uncounted("page"));
        let Pages { alone, in_folder } = page(&results, &figures);
        Ok(Report {
            figures,
            html: alone,
            html_in_folder: in_folder,
            live_page: input.live_page.clone(),
            absent: results.absent,
        })
    }

    /// Names and contents of all files: the page, then SVG, PNG and CSV of each figure.
    pub fn files(&self) -> Vec<(String, &[u8])> {
        let mut files = vec![(PAGE_NAME.to_owned(), self.html_in_folder.as_bytes())];
        files.extend(self.live_page.iter().map(|page| (LIVE_PAGE_NAME.to_owned(), page.as_bytes())));
        for figure in &self.figures {
            files.extend(figure.files());
        }
        files
    }
}

/// The figures as SVG and PNG, drawn in parallel.
pub(crate) fn rendered(film: &Film, drafts: Vec<FigureDraft>, text: SvgText) -> Result<Vec<Drawing>, ReportError> {
    let (rendered, all) = (AtomicUsize::new(0), drafts.len());
    let tell = |done: usize| film.tell(Stage { name: "rendering", done, of: Some(all), unit: "figures" });
    tell(0);
    drafts
        .into_par_iter()
        .map(|draft| {
            let figure = draft.rendered(text);
            tell(rendered.fetch_add(1, Ordering::Relaxed) + 1);
            figure
        })
        .collect()
}

//! A report: all figures of a film, and the page.

use std::sync::atomic::{AtomicUsize, Ordering};

use magsplice::{Film, Stage};
use rayon::prelude::*;

use crate::drawing::{Drawing, FigureDraft, SvgText};
use crate::error::ReportError;
use crate::figure_drafts::{drafts, sensor_drafts};
use crate::page::{Pages, PrintedResults, page};
use crate::shared_ranges::SharedRanges;
use crate::survey::{FilmSamples, Survey, tiles_to_draw};

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
/// use magsplice_report::{PrintedResults, Report, SvgText};
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
/// let results = PrintedResults { text: "one tile", json: "{}" };
/// let report = Report::new(&film, None, results, SvgText::Text)?;
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
    /// What the report lacks, and why: one phrase each, without a full stop.
    pub absent: Vec<String>,
}

impl Report {
    /// Draws all figures that the layout allows, and the page.
    ///
    /// `samples` are films as made, whose errors two further figures show. The figures have the
    /// accuracy of the film. `text` is the form of text in the SVG files; on the page it is always
    /// outlines.
    ///
    /// # Errors
    /// - [`ReportError::Film`] if the film cannot be evaluated.
    /// - [`ReportError::Drawing`] if a figure cannot be drawn.
    pub fn new(
        film: &Film,
        samples: Option<FilmSamples>,
        results: PrintedResults,
        text: SvgText,
    ) -> Result<Report, ReportError> {
        let survey = Survey::new(film)?.map(|survey| Survey { samples, ..survey });
        let tiles = tiles_to_draw(film.layout());
        let ranges = SharedRanges::default();
        let mut drafts = drafts(film, &tiles, survey.as_ref(), &ranges)?;
        if let Some(survey) = &survey {
            drafts.extend(sensor_drafts(film, survey, &ranges)?);
        }
        let figures = rendered(film, drafts, text)?;
        film.tell(Stage::uncounted("page"));
        let absent = absent(film);
        let Pages { alone, in_folder } = page(film, survey.as_ref(), &tiles, &figures, &absent, results);
        Ok(Report { figures, html: alone, html_in_folder: in_folder, absent })
    }

    /// Names and contents of all files: the page, then SVG, PNG and CSV of each figure.
    pub fn files(&self) -> Vec<(String, &[u8])> {
        let mut files = vec![(PAGE_NAME.to_owned(), self.html_in_folder.as_bytes())];
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

/// What the report of a film lacks, and why.
pub(crate) fn absent(film: &Film) -> Vec<String> {
    let without_volume = "no field and no decoupling: the layout has no [volume] table";
    let without_ideal =
        "no comparison and no decoupling: the layout has no [ideal] table that describes the ideal film";
    let absent = [(film.volume().is_err(), without_volume), (film.ideal().is_err(), without_ideal)];
    absent.into_iter().filter(|(is_absent, _)| *is_absent).map(|(_, what)| what.to_owned()).collect()
}

//! `magsplice report`: draws figures and a page.

use std::fmt::Write;

use magsplice::prelude::DVec3;
use magsplice::{Film, FilmError, Stage};
use magsplice_report::{PrintedResults, Report, ReportError};

use crate::args::evaluate::ReportArgs;
use crate::evaluation::Evaluation;
use crate::failure::Failure;
use crate::json::decouple::DecoupleJson;
use crate::json::source::SourceJson;
use crate::output::destination::print;
use crate::output::folder::Folder;
use crate::progress::ProgressLine;
use crate::words::film_failure;
use crate::{json, remarks, text};

pub(crate) fn run(args: &ReportArgs, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let show = |stage: Stage| progress.show(stage);
    let layout = remarks::read_layout(&args.layout, remarks::OF_COMPARISONS, quiet, &progress)?;
    let film = Film::new(&layout).with_accuracy(args.accuracy.accuracy()).with_progress(&show);
    let failed = |error| film_failure(&args.layout, &layout, error);
    // A folder that cannot be written is refused before the field is computed.
    let mut folder = Folder::open(&args.output, "report", &[&args.layout])?;
    let PageNumbers { text, json, field_t } = numbers(&film).map_err(failed)?;
    let results = PrintedResults { text: &text, json: &json };
    let report = Report::new(&film, field_t, results, args.text.into()).map_err(|error| match error {
        ReportError::Film(error) => failed(error),
        error => Failure::Report { layout: args.layout.clone(), message: error.to_string() },
    })?;
    for (name, contents) in report.files() {
        folder.write(&name, contents)?;
    }
    folder.finish()?;
    progress.end();
    let page = args.output.join("report.html");
    let mut said = format!("{}: {} figures, each also as SVG, PNG and CSV\n", page.display(), report.figures.len());
    for absent in &report.absent {
        let _ = writeln!(said, "absent: {absent}");
    }
    print(&said)
}

/// The numbers of the page, as `decouple` prints them.
struct PageNumbers {
    text: String,
    json: String,
    /// The field of the working volume, if the layout has one.
    field_t: Option<Vec<DVec3>>,
}

/// As many numbers as the tables of the layout allow.
fn numbers(film: &Film) -> Result<PageNumbers, FilmError> {
    if film.ideal().is_ok() && film.volume().is_ok() {
        let evaluation = Evaluation::new(film)?;
        let text = text::decouple::evaluation(&evaluation);
        let json = json::pretty(&DecoupleJson::new(&evaluation, None));
        return Ok(PageNumbers { text, json, field_t: Some(evaluation.field_t) });
    }
    let json = json::pretty(&SourceJson::new(film));
    let Ok(volume) = film.volume() else {
        return Ok(PageNumbers { text: text::header::layout(film.layout()), json, field_t: None });
    };
    let field_t = film.volume_field_t()?;
    let field = text::decouple::field(&field_t, volume, film.reference_field_t()?, None);
    let text = format!("{}\n{field}", text::header::film(film, volume));
    Ok(PageNumbers { text, json, field_t: Some(field_t) })
}

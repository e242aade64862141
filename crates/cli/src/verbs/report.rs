//! `magsplice report`: figures and a page, in a folder.

use std::fmt::Write;

use magsplice::layout::Layout;
use magsplice::prelude::DVec3;
use magsplice::{Film, FilmError, Stage};
use magsplice_report::{PrintedResults, Report, ReportError};

use crate::args::ReportArgs;
use crate::failure::Failure;
use crate::folder::Folder;
use crate::output;
use crate::progress::Progress;
use crate::text;
use crate::verbs::decouple::{Evaluated, Source};

pub(crate) fn run(args: &ReportArgs, quiet: bool) -> Result<(), Failure> {
    let progress = Progress::start(!quiet);
    let tell = |stage: Stage| progress.show(stage);
    let layout = Layout::read(&args.layout)?;
    let film = Film::new(&layout).with_accuracy(args.accuracy.get()).with_progress(&tell);
    let failed = |error| text::film_failure(&args.layout, &layout, error);
    // Whether the folder can be written is known before anything is computed.
    let folder = Folder::open(&args.output, Report::is_report_file)?;
    let Known { text, json, field_t } = known(&film).map_err(failed)?;
    let results = PrintedResults { text: &text, json: &json };
    let report = Report::new(&film, field_t, results).map_err(|error| match error {
        ReportError::Film(error) => failed(error),
        error => Failure::Report { layout: args.layout.clone(), message: error.to_string() },
    })?;
    for (name, contents) in report.files() {
        folder.write(&name, contents)?;
    }
    folder.finish()?;
    progress.end();
    let page = args.output.join("report.html");
    let mut said = format!("{}: {} figures, each also as SVG and PNG\n", page.display(), report.figures.len());
    for what in &report.absent {
        let _ = writeln!(said, "absent: {what}");
    }
    output::print(&said)
}

/// What is known before anything is drawn.
struct Known {
    text: String,
    json: String,
    /// The field of the working volume, if there is one.
    field_t: Option<Vec<DVec3>>,
}

/// The numbers that the layout allows for.
fn known(film: &Film) -> Result<Known, FilmError> {
    if film.ideal().is_ok() && film.volume().is_ok() {
        let evaluated = Evaluated::of(film)?;
        let (text, json) = (evaluated.text()?, evaluated.json());
        return Ok(Known { text, json, field_t: Some(evaluated.into_field_t()) });
    }
    let json = text::json(&Source::of(film));
    let Ok(volume) = film.volume() else {
        let layout = film.layout();
        let tiles = text::tile_count(layout);
        let text = format!("{}: {tiles}, sha256 {}\n", layout.name, &layout.sha256[..12]);
        return Ok(Known { text, json, field_t: None });
    };
    let field_t = film.volume_field_t()?;
    let field = text::field(&field_t, volume, film.reference_field_t()?, None);
    Ok(Known { text: format!("{}\n{field}", text::header(film, volume)), json, field_t: Some(field_t) })
}

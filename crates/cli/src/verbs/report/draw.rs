//! The drawing of a report: figures and a page of one film, or of two side by side.

use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use magsplice::layout::Layout;
use magsplice::magnet::Accuracy;
use magsplice::results::Source;
use magsplice::{Film, FilmError};
use magsplice_report::{FilmSamples, PairReport, Print, Report, ReportError, ReportInput, SvgText, print_figure};

use super::destination::Destination;
use super::live::Engine;
use crate::failure::Failure;
use crate::output::json;
use crate::remarks;
use crate::session::Session;
use crate::text::number::counted;
use crate::verbs::{check, tolerance};

/// How a report is drawn.
pub(super) struct Drawing<'a> {
    pub(super) output: &'a Path,
    pub(super) text: SvgText,
    pub(super) accuracy: Accuracy,
    pub(super) engine: Engine,
    pub(super) quiet: bool,
}

impl Drawing<'_> {
    /// Draws the report of one layout, or of two.
    pub(super) fn draw(&self, layouts: &[PathBuf]) -> Result<(), Failure> {
        match layouts {
            [first, second] => self.draw_pair([first, second]),
            layouts => self.draw_one(layouts.first().map_or(Path::new(""), |layout| layout)),
        }
    }

    /// Writes one figure of the report of a film.
    pub(super) fn figure(&self, layouts: &[PathBuf], name: &str, print: Print) -> Result<(), Failure> {
        let [path] = layouts else {
            return Err(Failure::Refused("--figure draws one film: give one layout".to_owned()));
        };
        let session = Session::open(path, remarks::OF_COMPARISONS, self.quiet)?;
        let film = session.film()?.with_accuracy(self.accuracy);
        let file = session.figure(Some(self.output), [])?;
        let input = ReportInput { samples: samples(&session, &film)?, ..ReportInput::default() };
        let drawn = print_figure(&film, &input, name, print, self.text).map_err(|error| failure(&session, error))?;
        file.map_or(Ok(()), |file| file.write(Ok(drawn)))?;
        session.print(&format!("{}: {name}\n", self.output.display()))
    }

    fn draw_one(&self, path: &Path) -> Result<(), Failure> {
        let session = Session::open(path, remarks::OF_COMPARISONS, self.quiet)?;
        let film = session.film()?.with_accuracy(self.accuracy);
        let destination = Destination::open(self.output, &[path])?;
        let live_page = self.engine.page(&session.layout, path);
        let input = ReportInput { live_page, ..input(&session, &film)? };
        let report = Report::new(&film, &input, self.text).map_err(|error| failure(&session, error))?;
        let (page, beside) = destination.write(self.output, &report.html, report.files())?;
        let mut said = format!("{}: {}{beside}\n", page.display(), counted(report.figures.len(), "figure", "figures"));
        for absent in &report.absent {
            let _ = writeln!(said, "absent: {absent}");
        }
        session.print(&said)
    }

    fn draw_pair(&self, paths: [&Path; 2]) -> Result<(), Failure> {
        let first = Session::open(paths[0], remarks::OF_COMPARISONS, self.quiet)?;
        let progress = first.progress.clone();
        let sessions = [first, Session::begin(paths[1], remarks::OF_COMPARISONS, self.quiet, progress)?];
        let film = |session: &Session| Ok::<Film, Failure>(session.film()?.with_accuracy(self.accuracy));
        let films = [film(&sessions[0])?, film(&sessions[1])?];
        let destination = Destination::open(self.output, &paths)?;
        let inputs = [input(&sessions[0], &films[0])?, input(&sessions[1], &films[1])?];
        let labels = paths.map(|path| path.display().to_string());
        let labels = [labels[0].as_str(), labels[1].as_str()];
        let report = PairReport::new([&films[0], &films[1]], labels, &inputs, self.text);
        let report = report.map_err(|error| failure(&sessions[0], error))?;
        let (page, beside) = destination.write(self.output, &report.html, report.files())?;
        let [first, second] = report.figures.each_ref().map(Vec::len);
        let mut said =
            format!("{}: {first} and {} side by side{beside}\n", page.display(), counted(second, "figure", "figures"));
        for (label, absent) in labels.iter().zip(&report.absent) {
            for absent in absent {
                let _ = writeln!(said, "{label}: absent: {absent}");
            }
        }
        sessions[0].print(&said)
    }
}

/// What the page shows of a film beside its field.
fn input(session: &Session, film: &Film) -> Result<ReportInput, Failure> {
    let samples = samples(session, film)?;
    let made = samples.as_ref().map_or(&[][..], |samples| &samples.errors);
    let expectations = check::expectations(session, film, false, made, |_, _, _| ());
    let json = numbers(film).map_err(|error| session.failed(error))?;
    Ok(ReportInput { expectations, json, samples, live_page: None })
}

/// Samples of films as made, if the layout has their errors.
fn samples(session: &Session, film: &Film) -> Result<Option<FilmSamples>, Failure> {
    let layout = &*session.layout;
    let Layout { tolerance: Some(stated), ideal: Some(_), volume: Some(_), .. } = layout else { return Ok(None) };
    let failed = |error| tolerance::sampling::sampling_failure(session, error);
    let sampling = film.sampling().map_err(failed)?;
    let run = tolerance::sample_run(layout, None, stated.seed, 0, stated.samples);
    let mut errors = Vec::new();
    tolerance::draw(session, &sampling, &run, None, &mut errors, |_| Ok(ControlFlow::Continue(())))?;
    let found = sampling.statistics(run, None, &errors).map_err(failed)?;
    Ok(Some(FilmSamples { found, errors }))
}

fn failure(session: &Session, error: ReportError) -> Failure {
    match error {
        ReportError::Film(error) => session.failed(error),
        error => Failure::at(session.path, error),
    }
}

/// The numbers of the page as JSON, as `decouple` prints them: as many as the tables of the layout
/// allow.
fn numbers(film: &Film) -> Result<String, FilmError> {
    if film.ideal().is_ok() && film.volume().is_ok() {
        return Ok(json::pretty(&film.evaluate()?));
    }
    Ok(json::pretty(&Source::of(film)))
}

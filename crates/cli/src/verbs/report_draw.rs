//! The drawing of a report: figures and a page of one film, or of two side by side.

use std::fmt::Write;
use std::path::Path;

use magsplice::layout::Layout;
use magsplice::prelude::DVec3;
use magsplice::{Film, FilmError, Stage};
use magsplice_report::{FilmSamples, PairReport, PrintedResults, Report, ReportError};

use super::report_pair;
use crate::args::evaluate::ReportArgs;
use crate::evaluation::Evaluation;
use crate::failure::Failure;
use crate::json::decouple::DecoupleJson;
use crate::json::source::SourceJson;
use crate::output::destination::print;
use crate::output::folder::Folder;
use crate::prepared_film::prepare;
use crate::progress::ProgressLine;
use crate::sampling::run::SamplingRun;
use crate::sampling::sampled_film::SampledFilm;
use crate::sampling::scene::SampledScene;
use crate::sampling::source::SampleSource;
use crate::sensor::film_resolution::FilmResolution;
use crate::text::number::counted;
use crate::words::film_failure;
use crate::{json, remarks, text};

/// Draws the report once.
pub(super) fn draw(args: &ReportArgs, quiet: bool) -> Result<(), Failure> {
    match args.layouts.as_slice() {
        [first, second] => draw_pair(args, [first, second], quiet),
        layouts => draw_one(args, layouts.first().map_or(Path::new(""), |layout| layout), quiet),
    }
}

fn draw_one(args: &ReportArgs, path: &Path, quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let show = |stage: Stage| progress.show(stage);
    let layout = remarks::read_layout(path, remarks::OF_COMPARISONS, quiet, &progress)?;
    let film =
        prepare(path, &layout, &show, &remarks::teller(quiet, &progress))?.with_accuracy(args.accuracy.accuracy());
    // A folder that cannot be written is refused before the field is computed.
    let folder = Folder::open(&args.output, "report", &[path])?;
    let PageNumbers { mut text, json, field_t } = numbers(&film).map_err(|error| film_failure(path, &layout, error))?;
    let samples = samples(path, &layout, &progress, &mut text)?;
    of_sensor(&film, &mut text).map_err(|error| film_failure(path, &layout, error))?;
    let results = PrintedResults { text: &text, json: &json };
    let report = Report::new(&film, field_t, samples, results, args.text.into());
    let report = report.map_err(|error| report_failure(path, &layout, error))?;
    written(folder, report.files())?;
    progress.end();
    let page = args.output.join("report.html");
    let mut said = format!(
        "{}: {}, each also as SVG, PNG and CSV\n",
        page.display(),
        counted(report.figures.len(), "figure", "figures")
    );
    for absent in &report.absent {
        let _ = writeln!(said, "absent: {absent}");
    }
    print(&said)
}

/// Samples of the films that are made, if the layout states their errors. Appends their statistics
/// to `text`.
fn samples(
    path: &Path,
    layout: &Layout,
    progress: &ProgressLine,
    text: &mut String,
) -> Result<Option<FilmSamples>, Failure> {
    let Layout { tolerance: Some(tolerance), ideal: Some(_), volume: Some(_), .. } = layout else { return Ok(None) };
    let show = |stage: Stage| progress.show(stage);
    // What there is to say of the film has been said.
    let scene = SampledScene::new(path, layout, &show, &|_| {})?;
    let source = SampleSource::new(layout, None, tolerance.seed, 0, tolerance.samples);
    let sampler = scene.sampler(source.seed)?;
    let mut errors = Vec::new();
    let errors_of =
        |samples| sampler.errors_of_range(samples).map_err(|(sample, error)| scene.sample_failure(sample, &error));
    let run = SamplingRun { errors_of: &errors_of, source: &source };
    run.extend(&mut errors, |_| Ok(()), progress, None)?;
    let film = SampledFilm::new(&scene, source, &errors)?;
    let _ = write!(text, "\nfilms that are made: {}", text::tolerance::samples(&film));
    Ok(Some(FilmSamples { nominal: film.nominal, errors }))
}

/// Appends the resolution of the sensor to `text`, if the layout states one with noise.
fn of_sensor(film: &Film, text: &mut String) -> Result<(), FilmError> {
    let (Ok(volume), Some(_)) = (film.volume(), &film.layout().sensor) else { return Ok(()) };
    if let Some(resolution) = FilmResolution::new(film, volume, None)? {
        let _ = write!(text, "\nsensor: {}", text::resolution::resolution(&resolution));
    }
    Ok(())
}

fn draw_pair(args: &ReportArgs, paths: [&Path; 2], quiet: bool) -> Result<(), Failure> {
    let progress = ProgressLine::start(!quiet);
    let show = |stage: Stage| progress.show(stage);
    let read = |path| remarks::read_layout(path, remarks::OF_COMPARISONS, quiet, &progress);
    let layouts = [read(paths[0])?, read(paths[1])?];
    let film = |index: usize| -> Result<Film, Failure> {
        let tell = remarks::teller(quiet, &progress);
        Ok(prepare(paths[index], &layouts[index], &show, &tell)?.with_accuracy(args.accuracy.accuracy()))
    };
    let films = [film(0)?, film(1)?];
    let folder = Folder::open(&args.output, "report", &paths)?;
    let evaluated = |index: usize| {
        let failed = |error| film_failure(paths[index], &layouts[index], error);
        report_pair::evaluated(&films[index]).map_err(failed)
    };
    let evaluated = [evaluated(0)?, evaluated(1)?];
    let numbers = report_pair::numbers(&films, &evaluated);
    let labels = paths.map(|path| path.display().to_string());
    let fields_t = evaluated.map(|evaluation| evaluation.map(|evaluation| evaluation.field_t));
    let labels = [labels[0].as_str(), labels[1].as_str()];
    let report = PairReport::new([&films[0], &films[1]], labels, fields_t, &numbers, args.text.into());
    let report = report.map_err(|error| report_failure(paths[0], &layouts[0], error))?;
    written(folder, report.files())?;
    progress.end();
    let page = args.output.join("report.html");
    let [first, second] = report.figures.each_ref().map(Vec::len);
    let mut said = format!(
        "{}: {first} and {} side by side, each also as SVG, PNG and CSV\n",
        page.display(),
        counted(second, "figure", "figures")
    );
    for (label, absent) in labels.iter().zip(&report.absent) {
        for absent in absent {
            let _ = writeln!(said, "{label}: absent: {absent}");
        }
    }
    print(&said)
}

/// Writes all files and lets the folder appear.
fn written(mut folder: Folder, files: Vec<(String, &[u8])>) -> Result<(), Failure> {
    for (name, contents) in files {
        folder.write(&name, contents)?;
    }
    folder.finish()
}

fn report_failure(path: &Path, layout: &Layout, error: ReportError) -> Failure {
    match error {
        ReportError::Film(error) => film_failure(path, layout, error),
        error => Failure::Report { layout: path.to_owned(), message: error.to_string() },
    }
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

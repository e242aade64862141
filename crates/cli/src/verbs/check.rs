//! `magsplice check`: validates layouts, and checks films against their expectations.

use std::fmt;
use std::io;
use std::path::Path;
use std::time::Instant;

use anstream::{AutoStream, ColorChoice};
use magsplice::expect::{Baseline, BaselineDifference, Expectation};
use magsplice::layout::Layout;
use magsplice::magnet::Grid;
use magsplice::prelude::DVec3;
use magsplice::{Film, Stage};

use crate::args::check::CheckArgs;
use crate::args::formats::CheckFormat;
use crate::checked::{CheckStatus, CheckedExpectation, CheckedLayout};
use crate::failure::{self, Failure};
use crate::layout_files::{self, NO_LAYOUT, NamedFile};
use crate::output::destination::print;
use crate::progress::ProgressLine;
use crate::words::film_failure;
use crate::{baseline, json, junit, text};

/// Returns the worst status of all layouts, as an exit status.
pub(crate) fn run(args: &CheckArgs, quiet: bool) -> Result<u8, Failure> {
    let mut status = CheckStatus::Ok;
    // No colours in files and pipes, nor where NO_COLOR forbids them.
    let colours = AutoStream::choice(&io::stdout()) != ColorChoice::Never;
    let mut printed = Ok(());
    let mut all = Vec::new();
    let progress = ProgressLine::start(!quiet);
    let files = layout_files::expand(&args.layouts);
    let mut skipped = Vec::new();
    for (index, file) in files.iter().enumerate() {
        let checked = match file {
            NamedFile::Skipped(path) => {
                if !quiet {
                    progress.suspend(|| failure::tell(&format_args!("{}: skipped, {NO_LAYOUT}", path.display())));
                }
                skipped.push(path.as_path());
                continue;
            }
            NamedFile::Refused(path, message) => CheckedLayout::refused(path, message),
            NamedFile::Layout(path) => {
                if files.len() > 1 {
                    progress.set_prefix(format!("{} ({} of {}): ", path.display(), index + 1, files.len()));
                    progress.show(Stage::uncounted("reading the layout"));
                }
                check(path, args.update, quiet, &progress)
            }
        };
        status = status.max(checked.status());
        progress.suspend(|| {
            // Each layout as soon as it is checked. Findings go to standard error, also after the
            // reader of standard output has closed it.
            if args.format == CheckFormat::Text && printed.is_ok() {
                printed = print(&text::check::checked_layout(&checked, quiet, colours));
            }
            tell(&checked);
        });
        all.push(checked);
    }
    progress.end();
    let printed = match args.format {
        CheckFormat::Text => printed,
        CheckFormat::Json => print(&json::pretty(&json::check::CheckJson::new(&all, &skipped))),
        CheckFormat::Junit => print(&junit::xml(&all, &skipped)),
    };
    match printed {
        Ok(()) | Err(Failure::PipeClosed) => Ok(status as u8),
        Err(failure) => Err(failure),
    }
}

fn check(path: &Path, update: bool, quiet: bool, progress: &ProgressLine) -> CheckedLayout {
    let started = Instant::now();
    let layout = Layout::read(path).map_err(|e| e.to_string());
    let mut checked =
        CheckedLayout { path: path.to_owned(), layout, expectations: Vec::new(), reading: started.elapsed() };
    let Ok(layout) = &checked.layout else { return checked };
    if layout.expectations.is_empty() {
        return checked;
    }
    let show = |stage: Stage| progress.show(stage);
    let film = Film::new(layout).with_progress(&show);
    let mut started = Instant::now();
    let baseline = baseline(path, &film, update, |remark| {
        if !quiet {
            progress.suspend(|| failure::tell(&remark));
        }
    });
    let mut expectations = Vec::new();
    film.each_outcome(baseline.as_ref().and_then(|b| b.as_ref().ok()), |expectation, outcome| {
        let outcome = match (&baseline, expectation) {
            (Some(Err(failure)), Expectation::Field) => Err(failure.to_string()),
            _ => outcome.map_err(|error| film_failure(path, layout, error).to_string()),
        };
        expectations.push(CheckedExpectation { expectation, outcome, took: started.elapsed() });
        started = Instant::now();
    });
    checked.expectations = expectations;
    checked
}

/// The baseline of the layout, if it names one; with `update` it is rewritten first.
fn baseline(
    path: &Path,
    film: &Film,
    update: bool,
    remark: impl Fn(fmt::Arguments),
) -> Option<Result<Baseline, Failure>> {
    let expected = film.layout().expectations.field.as_ref()?;
    // The name is relative to the layout, not to the working directory.
    let file = path.parent().unwrap_or(Path::new("")).join(&expected.file);
    let rewrite = || -> Result<(), Failure> {
        let failed = |error| film_failure(path, film.layout(), error);
        baseline::check_replaceable(&file)?;
        let field_t = film.volume_field_t().map_err(failed)?;
        let grid = &film.volume().map_err(failed)?.grid;
        let moved = moved(&file, grid, &field_t);
        baseline::write(&file, path, grid, &field_t)?;
        remark(format_args!("wrote {}, {} points: {moved}", file.display(), grid.len()));
        Ok(())
    };
    let rewritten = if update { rewrite() } else { Ok(()) };
    Some(rewritten.and_then(|()| baseline::read(&file)))
}

/// How far a field is from the baseline in `file`, which it will replace.
fn moved(file: &Path, grid: &Grid, field_t: &[DVec3]) -> String {
    if !file.exists() {
        return "a new baseline".to_owned();
    }
    let Ok(earlier) = baseline::read(file) else {
        return "the earlier baseline could not be read".to_owned();
    };
    match earlier.difference(grid.points(), field_t) {
        Err(_) => "the earlier baseline had other points".to_owned(),
        Ok(BaselineDifference { relative: 0.0, .. }) => "the field is the same to the last digit".to_owned(),
        Ok(BaselineDifference { relative, at }) => {
            format!("the field moved by at most {relative:.3e} of |B|, at ({}, {}, {}) mm", at.x, at.y, at.z)
        }
    }
}

/// Prints errors and findings on standard error.
fn tell(checked: &CheckedLayout) {
    if let Err(message) = &checked.layout {
        failure::tell(message);
    }
    for finding in checked.findings() {
        failure::tell(&format_args!("{}: {finding}", checked.path.display()));
    }
    let mut told: Vec<&String> = Vec::new();
    for message in checked.expectations.iter().filter_map(|expectation| expectation.outcome.as_ref().err()) {
        // One cause can make several expectations fail; it is printed once.
        if !told.contains(&message) {
            failure::tell(message);
            told.push(message);
        }
    }
}

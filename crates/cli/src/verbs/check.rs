//! `magsplice check`: validates layouts, and checks films against their expectations.

use std::fmt;
use std::io;
use std::path::Path;

use anstream::{AutoStream, ColorChoice};
use magsplice::expect::{Baseline, Expectation};
use magsplice::layout::Layout;
use magsplice::{Film, Stage};

use crate::args::check::CheckArgs;
use crate::args::formats::CheckFormat;
use crate::checked::{CheckStatus, CheckedExpectation, CheckedLayout};
use crate::failure::{self, Failure};
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
    for (index, path) in args.layouts.iter().enumerate() {
        if args.layouts.len() > 1 {
            progress.set_prefix(format!("{} ({} of {}): ", path.display(), index + 1, args.layouts.len()));
            progress.show(Stage::uncounted("reading the layout"));
        }
        let checked = check(path, args.update, quiet, &progress);
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
        CheckFormat::Json => print(&json::pretty(&json::check::CheckJson::new(&all))),
        CheckFormat::Junit => print(&junit::xml(&all)),
    };
    match printed {
        Ok(()) | Err(Failure::PipeClosed) => Ok(status as u8),
        Err(failure) => Err(failure),
    }
}

fn check(path: &Path, update: bool, quiet: bool, progress: &ProgressLine) -> CheckedLayout {
    let layout = Layout::read(path).map_err(|e| e.to_string());
    let mut checked = CheckedLayout { path: path.to_owned(), layout, expectations: Vec::new() };
    let Ok(layout) = &checked.layout else { return checked };
    if layout.expectations.is_empty() {
        return checked;
    }
    let show = |stage: Stage| progress.show(stage);
    let film = Film::new(layout).with_progress(&show);
    let baseline = baseline(path, &film, update, |remark| {
        if !quiet {
            progress.suspend(|| failure::tell(&remark));
        }
    });
    for (expectation, outcome) in film.outcomes(baseline.as_ref().and_then(|b| b.as_ref().ok())) {
        let outcome = match (&baseline, expectation) {
            (Some(Err(failure)), Expectation::Field) => Err(failure.to_string()),
            _ => outcome.map_err(|error| film_failure(path, layout, error).to_string()),
        };
        checked.expectations.push(CheckedExpectation { expectation, outcome });
    }
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
        baseline::write(&file, path, grid, &field_t)?;
        remark(format_args!("wrote {}, {} points", file.display(), grid.len()));
        Ok(())
    };
    let rewritten = if update { rewrite() } else { Ok(()) };
    Some(rewritten.and_then(|()| baseline::read(&file)))
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

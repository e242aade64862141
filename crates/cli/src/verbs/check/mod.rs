//! `magsplice check`: read, validate, and hold films against what their layouts expect.

mod json;
mod junit;
mod text;

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use anstream::{AutoStream, ColorChoice};
use magsplice::expect::{Baseline, Expectation, Outcome};
use magsplice::layout::Layout;
use magsplice::{Film, Stage};

use crate::args::{CheckArgs, CheckFormat};
use crate::baseline;
use crate::failure::{self, Failure};
use crate::output;
use crate::progress::Progress;
use crate::text::film_failure;

/// What was found of one layout.
struct Checked {
    path: PathBuf,
    /// Or why it cannot be used.
    layout: Result<Layout, String>,
    lines: Vec<Line>,
}

/// One expectation.
struct Line {
    expectation: Expectation,
    /// Or why it cannot be evaluated.
    outcome: Result<Outcome, String>,
}

/// The worst that can be said of something; the numbers are exit statuses.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Status {
    Fine = 0,
    /// Allowed but rarely meant, or not as expected.
    Finding = 1,
    /// Could not be used or evaluated.
    Unusable = 2,
}

impl Line {
    fn status(&self) -> Status {
        match &self.outcome {
            Ok(outcome) if outcome.is_met() => Status::Fine,
            Ok(_) => Status::Finding,
            Err(_) => Status::Unusable,
        }
    }
}

impl Checked {
    fn status(&self) -> Status {
        let own = match &self.layout {
            Ok(layout) if layout.findings.is_empty() => Status::Fine,
            Ok(_) => Status::Finding,
            Err(_) => Status::Unusable,
        };
        self.lines.iter().map(Line::status).fold(own, Status::max)
    }

    fn findings(&self) -> &[String] {
        self.layout.as_ref().map_or(&[], |layout| &layout.findings)
    }
}

/// Exit status: the highest of 0 (fine), 1 (a finding), 2 (could not be used) over all layouts.
pub(crate) fn run(args: &CheckArgs, quiet: bool) -> u8 {
    let mut status = Status::Fine;
    // Not into files and pipes, nor where NO_COLOR forbids it.
    let colours = AutoStream::choice(&io::stdout()) != ColorChoice::Never;
    let mut printed = Ok(());
    let mut all = Vec::new();
    let progress = Progress::start(!quiet);
    for (number, path) in args.layouts.iter().enumerate() {
        if args.layouts.len() > 1 {
            progress.of(format!("{} ({} of {}): ", path.display(), number + 1, args.layouts.len()));
        }
        let checked = check(path, args.update, quiet, &progress);
        status = status.max(checked.status());
        progress.aside(|| {
            if args.format == CheckFormat::Text && printed.is_ok() {
                // Each as soon as it is known, findings even if nobody reads on.
                printed = output::print(&text::of(&checked, quiet, colours));
            }
            tell(&checked);
        });
        all.push(checked);
    }
    progress.end();
    let printed = match args.format {
        CheckFormat::Text => printed,
        CheckFormat::Json => output::print(&json::of(&all)),
        CheckFormat::Junit => output::print(&junit::of(&all)),
    };
    match printed {
        Ok(()) | Err(Failure::PipeClosed) => status as u8,
        Err(failure) => {
            failure::tell(&failure);
            Status::Unusable as u8
        }
    }
}

fn check(path: &Path, update: bool, quiet: bool, progress: &Progress) -> Checked {
    let mut checked =
        Checked { path: path.to_owned(), layout: Layout::read(path).map_err(|e| e.to_string()), lines: Vec::new() };
    let Ok(layout) = &checked.layout else { return checked };
    if layout.expectations.is_empty() {
        return checked;
    }
    let tell = |stage: Stage| progress.show(stage);
    let film = Film::new(layout).with_progress(&tell);
    let baseline = baseline(path, &film, update, |remark| {
        if !quiet {
            progress.aside(|| failure::tell(&remark));
        }
    });
    for (expectation, outcome) in film.outcomes(baseline.as_ref().and_then(|b| b.as_ref().ok())) {
        let outcome = match (&baseline, expectation) {
            (Some(Err(failure)), Expectation::Field) => Err(failure.to_string()),
            _ => outcome.map_err(|error| film_failure(path, layout, error).to_string()),
        };
        checked.lines.push(Line { expectation, outcome });
    }
    checked
}

/// The baseline of the layout, if it has one; written anew first if that is asked for.
fn baseline(
    path: &Path,
    film: &Film,
    update: bool,
    remark: impl Fn(fmt::Arguments),
) -> Option<Result<Baseline, Failure>> {
    let expected = film.layout().expectations.field.as_ref()?;
    // Relative to the layout, wherever the program was started.
    let file = path.parent().unwrap_or(Path::new("")).join(&expected.file);
    let rewrite = || -> Result<(), Failure> {
        let failed = |error| film_failure(path, film.layout(), error);
        let field_t = film.volume_field_t().map_err(failed)?;
        let grid = &film.volume().map_err(failed)?.grid;
        baseline::write(&file, path, grid, &field_t)?;
        remark(format_args!("wrote {}, {} points", file.display(), grid.len()));
        Ok(())
    };
    let rewritten = if update { rewrite() } else { Ok(()) };
    Some(rewritten.and_then(|()| baseline::read(&file)))
}

/// What a person at the terminal must know beside the results.
fn tell(checked: &Checked) {
    if let Err(message) = &checked.layout {
        failure::tell(message);
    }
    for finding in checked.findings() {
        failure::tell(&format_args!("{}: {finding}", checked.path.display()));
    }
    let mut told: Vec<&String> = Vec::new();
    for message in checked.lines.iter().filter_map(|line| line.outcome.as_ref().err()) {
        // One cause can keep several expectations from being evaluated.
        if !told.contains(&message) {
            failure::tell(message);
            told.push(message);
        }
    }
}

//! `magsplice check`: validates layouts, and checks films against their expectations.

/// Baselines: the field of a working volume as CSV.
mod baseline;
/// The layout files that arguments name.
mod layout_files;
/// The result as printed lines.
mod text;

use std::collections::HashMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use anstream::{AutoStream, ColorChoice};
use magsplice::decouple::Figures;
use magsplice::expect::{Baseline, BaselineDifference, Expectation};
use magsplice::layout::Layout;
use magsplice::magnet::Grid;
use magsplice::prelude::DVec3;
use magsplice::results::{Check, CheckStatus, CheckedExpectation, CheckedLayout, SkippedFile};
use magsplice::{Film, RecoilEstimate, Stage};
use magsplice_export::junit;

use self::layout_files::{NO_LAYOUT, NamedFile};
use crate::args::formats::CheckFormat;
use crate::failure::{self, Failure};
use crate::output::destination::print;
use crate::output::json;
use crate::progress::ProgressLine;
use crate::session::Session;
use crate::text::number::point;

/// Validate layouts, and check their films against their [expect] tables.
///
/// Prints one line per expectation: the value found, its bound and the margin. Exit status: 0 every
/// expectation is met; 1 an expectation is not met, or a layout has a finding, which is allowed but
/// rarely intended; 2 a layout cannot be used, or an expectation cannot be evaluated.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  magsplice check layouts/*.toml\n  magsplice check layouts --format junit > checks.xml"
)]
pub(crate) struct CheckArgs {
    /// Layout files, and folders with all layouts (*.toml) below them
    #[arg(required = true)]
    layouts: Vec<PathBuf>,
    /// Format of the result
    #[arg(long, value_enum, default_value = "text")]
    format: CheckFormat,
    /// First rewrite the field baselines that the layouts refer to, each complete or not at all
    #[arg(long)]
    update: bool,
}

/// Returns the worst status of all layouts, as an exit status.
pub(crate) fn run(args: &CheckArgs, quiet: bool) -> Result<u8, Failure> {
    let mut status = CheckStatus::Ok;
    // No colours in files and pipes, nor where NO_COLOR forbids them.
    let colours = AutoStream::choice(&io::stdout()) != ColorChoice::Never;
    let mut printed = Ok(());
    let mut all = Check::new();
    let progress = ProgressLine::start(!quiet);
    let files = layout_files::expand(&args.layouts);
    if args.update {
        refuse_shared_baselines(&files)?;
    }
    for (index, file) in files.iter().enumerate() {
        let checked = match file {
            NamedFile::Skipped(path) => {
                let remark = format!("{}: skipped, {NO_LAYOUT}", path.display());
                progress.suspend(|| match args.format {
                    _ if quiet => {}
                    CheckFormat::Text if printed.is_ok() => {
                        printed = print(&format!("{}\n", failure::escaped(&remark)));
                    }
                    CheckFormat::Text | CheckFormat::Json | CheckFormat::Junit => failure::tell(&remark),
                });
                all.skipped.push(SkippedFile { file: path.display().to_string(), reason: NO_LAYOUT });
                continue;
            }
            NamedFile::Refused(path, message) => {
                CheckedLayout::new(path, &Err(format!("{}: {message}", path.display())), Duration::ZERO)
            }
            NamedFile::Layout(path) => {
                if files.len() > 1 {
                    progress.set_prefix(&format!("{} ({} of {}): ", path.display(), index + 1, files.len()));
                    progress.show(Stage::uncounted("reading the layout"));
                }
                check(path, args.update, quiet, &progress)
            }
        };
        status = status.max(checked.status);
        progress.suspend(|| {
            // Each layout as soon as it is checked.
            if args.format == CheckFormat::Text && printed.is_ok() {
                printed = print(&text::checked_layout(&checked, quiet, colours));
            }
            // Beside a file of results, the log of a build has standard error only. A reader that
            // has closed standard output may still read it, too.
            if args.format != CheckFormat::Text || printed.is_err() {
                tell(&checked);
            }
        });
        all.layouts.push(checked);
    }
    progress.end();
    let printed = match args.format {
        CheckFormat::Text => printed.and_then(|()| print(&text::summary(&all))),
        CheckFormat::Json => print(&json::pretty(&all)),
        CheckFormat::Junit => print(&junit::xml(&all, &text::sentence)),
    };
    match printed {
        Ok(()) | Err(Failure::PipeClosed) => Ok(status as u8),
        Err(failure) => Err(failure),
    }
}

fn check(path: &Path, update: bool, quiet: bool, progress: &Arc<ProgressLine>) -> CheckedLayout {
    let started = Instant::now();
    let layout = Layout::read(path).map_err(|e| e.to_string());
    let mut checked = CheckedLayout::new(path, &layout, started.elapsed());
    let Ok(layout) = layout else { return checked };
    if layout.expectations.is_empty() {
        return checked;
    }
    let session = Session::of(path, layout, progress.clone(), quiet);
    let layout = &*session.layout;
    let film = match session.film() {
        Ok(film) => film,
        Err(failure) => {
            let stated = Expectation::stated_in(&layout.expectations).into_iter();
            let unusable =
                |expectation| CheckedExpectation::new(expectation, Err(failure.to_string()), layout, started.elapsed());
            return checked.with_expectations(stated.map(unusable).collect());
        }
    };
    let expectations = expectations(&session, &film, update, &[], |file, points, how_far| {
        session.tell(&format!("wrote {}, {points} points: {how_far}", file.display()));
        checked.moved = Some(how_far);
    });
    // Where a film has no estimate, its figures say so.
    checked.recoil_estimates = RecoilEstimate::of_stated(layout).unwrap_or_default();
    checked.with_expectations(expectations)
}

/// The expectations of a film, checked. `made` are the errors of the first films as made, as far as
/// they are known.
pub(super) fn expectations(
    session: &Session,
    film: &Film,
    update: bool,
    made: &[Figures],
    wrote: impl FnOnce(&Path, usize, String),
) -> Vec<CheckedExpectation> {
    let mut started = Instant::now();
    let baseline = baseline(session, film, update, wrote);
    let mut expectations = Vec::new();
    film.each_outcome(baseline.as_ref().and_then(|b| b.as_ref().ok()), made, |expectation, outcome| {
        let outcome = match (&baseline, expectation) {
            (Some(Err(failure)), Expectation::Field) => Err(failure.to_string()),
            _ => outcome.map_err(|error| session.failed(error).to_string()),
        };
        expectations.push(CheckedExpectation::new(expectation, outcome, &session.layout, started.elapsed()));
        started = Instant::now();
    });
    expectations
}

/// Refuses layouts with the same file as their baseline: the last would replace the results of the
/// others.
fn refuse_shared_baselines(files: &[NamedFile]) -> Result<(), Failure> {
    let mut owners: HashMap<PathBuf, (PathBuf, &Path)> = HashMap::new();
    for file in files {
        let NamedFile::Layout(path) = file else { continue };
        // What is wrong with a layout is told when it is checked.
        let Ok(layout) = Layout::read(path) else { continue };
        let Some(expected) = &layout.expectations.field else { continue };
        let baseline = baseline_path(path, &expected.file);
        // A layout that is named twice, or by a link, shares its baseline with itself only.
        let (baseline_id, layout_id) = (file_id(&baseline), file_id(path));
        let (owner_id, owner) = owners.entry(baseline_id).or_insert_with(|| (layout_id.clone(), path.as_path()));
        if *owner_id != layout_id {
            let message = format!(
                "the layouts {} and {} have the same baseline: give each its own (nothing was written)",
                owner.display(),
                path.display()
            );
            return Err(Failure::at(&baseline, message));
        }
    }
    Ok(())
}

/// The path without links, also of a file that does not exist yet.
fn file_id(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        folder.join(path.file_name().unwrap_or_default())
    })
}

/// The file of a baseline. Its name is relative to the layout, not to the working directory.
fn baseline_path(layout: &Path, name: &(impl AsRef<Path> + ?Sized)) -> PathBuf {
    layout.parent().unwrap_or(Path::new("")).join(name)
}

/// The baseline of the layout, if it names one; with `update` it is rewritten first.
fn baseline(
    session: &Session,
    film: &Film,
    update: bool,
    wrote: impl FnOnce(&Path, usize, String),
) -> Option<Result<Baseline, Failure>> {
    let expected = session.layout.expectations.field.as_ref()?;
    let file = baseline_path(session.path, &expected.file);
    let rewrite = || -> Result<(), Failure> {
        let failed = |error| session.failed(error);
        baseline::check_replaceable(&file)?;
        let field_t = film.volume_field_t().map_err(failed)?;
        let grid = &film.volume().map_err(failed)?.grid;
        let moved = moved(&file, grid, field_t);
        baseline::write(&file, session.path, grid, field_t)?;
        wrote(&file, grid.len(), moved);
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
            format!("the field moved by at most {relative:.3e} of |B|, at {} mm", point(at))
        }
    }
}

/// Prints errors, findings and expectations that are not met on standard error.
fn tell(checked: &CheckedLayout) {
    if let Some(message) = &checked.error {
        failure::tell(message);
    }
    for finding in &checked.findings {
        failure::tell(&format_args!("{}: {finding}", checked.file));
    }
    for expectation in checked.expectations.iter().filter(|expectation| expectation.status == CheckStatus::Finding) {
        let (key, sentence) = (expectation.expectation, text::sentence(expectation));
        failure::tell(&format_args!("{}: FAILED {key}: {sentence}", checked.file));
    }
    let mut told: Vec<&String> = Vec::new();
    for message in checked.expectations.iter().filter_map(|expectation| expectation.error.as_ref()) {
        // One cause can make several expectations fail; it is printed once.
        if !told.contains(&message) {
            failure::tell(message);
            told.push(message);
        }
    }
}

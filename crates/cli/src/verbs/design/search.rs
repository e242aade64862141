//! Shared parts of `design`, `design --front` and `splice`: the search, its progress, its result.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use indicatif::HumanDuration;
use magsplice::Stage;
use magsplice::design::{
    DesignError, DesignProblem, MadeFilms, ProgressUpdate, SearchEstimate, SearchResult, SearchStage, Shortfall,
    SpliceRequest, SpliceTrial,
};
use magsplice::layout::{FilmTolerance, Layout, TileForm};
use magsplice::magnet::Tile;
use magsplice::results::FoundFilm;

use super::text;
use crate::args::formats::TextOrJson;
use crate::failure::{self, Failure};
use crate::interrupt::{self, INTERRUPTED};
use crate::output::PROGRAM;
use crate::output::destination::{Output, print};
use crate::progress::ProgressLine;
use crate::text::number::counted;

/// What a search began with.
#[derive(Clone, Copy)]
pub(crate) enum Origin<'r> {
    /// A layout file, by `design`.
    Layout,
    /// The films of `design --front`.
    Front,
    /// The pattern of a request, by `splice`.
    Pattern(&'r SpliceRequest),
}

impl Origin<'_> {
    fn verb(self) -> &'static str {
        match self {
            Origin::Layout => "design",
            Origin::Front => "design --front",
            Origin::Pattern(_) => "splice",
        }
    }
}

/// Searches for a film and shows the progress. Ctrl-C ends the search with the best film so far.
pub(crate) fn search(problem: &DesignProblem, quiet: bool) -> Result<SearchResult, DesignError> {
    let stop = interrupt::defer();
    if !quiet {
        announce(&problem.estimate(rayon::current_num_threads())?);
    }
    let progress = ProgressLine::start_search(!quiet);
    problem.search(&|update| show(&progress, stop, update))
}

/// Samples films as made, and shows the progress.
pub(crate) fn sampled(
    problem: &DesignProblem,
    tiles: &[Tile],
    tolerance: &FilmTolerance,
    quiet: bool,
) -> Result<MadeFilms, Shortfall> {
    let stop = interrupt::defer();
    let progress = ProgressLine::start_search(!quiet);
    problem.found_film_as_made(tiles, tolerance, &|update| show(&progress, stop, update))
}

/// Searches that take longer than this are announced with their size.
const LONG: Duration = Duration::from_secs(10);

/// Prints the size of a long search and an estimate of its time.
fn announce(estimate: &SearchEstimate) {
    let SearchEstimate { tiles, variables, starts, step, total } = *estimate;
    if total >= LONG {
        failure::tell(&format_args!(
            "{}, {}, {}: about {}, estimated from the first step, which took {:.2} s",
            counted(tiles, "tile", "tiles"),
            counted(variables, "free parameter", "free parameters"),
            counted(starts, "start", "starts"),
            HumanDuration(total),
            step.as_secs_f64()
        ));
    }
}

/// Shows the progress of a search, and ends the search if `stop` is set.
pub(crate) fn show(progress: &ProgressLine, stop: &AtomicBool, update: ProgressUpdate) -> ControlFlow<()> {
    let ProgressUpdate { stage, done, of, best } = update;
    let (name, unit) = match stage {
        SearchStage::Starts => ("searching", "starts"),
        SearchStage::Head => ("searching", "spacings of the head"),
        SearchStage::Recoil => (stage.name(), "rounds"),
        SearchStage::Strengths => (stage.name(), "strengths"),
        SearchStage::Parts(_) => (stage.name(), "parts merged"),
        SearchStage::Rounding => ("rounding", ""),
        SearchStage::Samples => ("sampling", "samples"),
        _ => (stage.name(), ""),
    };
    if let Some(best) = best {
        progress.set_prefix(&format!("best error {best:.3e}, "));
    }
    progress.show(Stage { name, done, of: (of > 0).then_some(of), unit });
    if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

/// Writes the layout of the film to `output`, and prints a summary: on standard output if the
/// layout went to a file, else on standard error.
///
/// Returns exit status 130 if the search was interrupted, and 1 if the film misses a requirement.
pub(crate) fn finish(
    problem: &DesignProblem,
    result: SearchResult,
    origin: Origin,
    output: Output,
    path: Option<&Path>,
    format: TextOrJson,
    quiet: bool,
) -> Result<u8, Failure> {
    let folder = path.and_then(Path::parent).unwrap_or(Path::new(""));
    let layout = layout_of(problem, &result, origin);
    let text = in_toml(&layout, folder)?;
    let to_file = !output.is_standard();
    // Before other work, which may be interrupted.
    output.complete(&text)?;
    let mut found = FoundFilm::new(result.clone(), layout).unwrap_or_else(|error| {
        failure::tell(&format_args!("warning: the sensor cannot read the film found: {error}"));
        FoundFilm { search: result, out_of_range: None, trials: Vec::new() }
    });
    if let Origin::Pattern(request) = origin
        && !found.search.interrupted
        && found.search.short_of.iter().any(|short| matches!(short, Shortfall::Travel { .. }))
    {
        found.trials = trials(request, quiet);
    }
    let is_pattern = matches!(origin, Origin::Pattern(_));
    let summary = format.shown(&found, || text::found_film(problem, &found, path, is_pattern));
    if to_file {
        print(&summary)?;
    } else if !quiet {
        failure::print_escaped(&summary);
    }
    if found.search.interrupted {
        if !quiet {
            failure::tell(&"interrupted: this is the best film found so far");
        }
        return Ok(INTERRUPTED);
    }
    Ok(u8::from(!found.search.short_of.is_empty()))
}

/// Searches with one number of the request changed. Ctrl-C ends them.
fn trials(request: &SpliceRequest, quiet: bool) -> Vec<SpliceTrial> {
    if !quiet {
        failure::tell(&"the film found is useless; searching with one option changed at a time, Ctrl-C ends this");
    }
    let stop = interrupt::defer();
    let progress = ProgressLine::start_search(!quiet);
    request.trials(&|update| show(&progress, stop, update))
}

fn layout_of(problem: &DesignProblem, result: &SearchResult, origin: Origin) -> Layout {
    let program = format!("{PROGRAM} {}", origin.verb());
    match origin {
        Origin::Pattern(_) => problem.spliced_layout(result, &program),
        Origin::Layout | Origin::Front => problem.designed_layout(result, &program),
    }
}

/// The layout file of a film that was found, to be written into `folder`. Refuses a film that
/// breaks a rule of layouts.
fn in_toml(layout: &Layout, folder: &Path) -> Result<String, Failure> {
    Ok(layout.to_edited_toml(TileForm::Compact, folder, "the film found")?)
}

/// The layout file of a film of a front, to be written into `folder`.
pub(super) fn front_layout_text(
    problem: &DesignProblem,
    result: &SearchResult,
    folder: &Path,
) -> Result<String, Failure> {
    in_toml(&layout_of(problem, result, Origin::Front), folder)
}

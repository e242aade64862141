//! Shared parts of `design`, `design --front` and `splice`: the search, its progress, its result.

use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use indicatif::HumanDuration;
use magsplice::Stage;
use magsplice::design::{DesignError, DesignProblem, ProgressUpdate, SearchEstimate, SearchResult, SearchStage};
use magsplice::layout::TileForm;

use super::text;
use crate::args::formats::TextOrJson;
use crate::failure::{self, Failure};
use crate::interrupt::{self, INTERRUPTED};
use crate::output::PROGRAM;
use crate::output::destination::{Output, print};
use crate::progress::ProgressLine;
use crate::text::number::counted;

/// The verb that begins with a pattern instead of a layout file.
pub(crate) const SPLICE: &str = "splice";

/// Searches for a film and shows the progress. Ctrl-C ends the search with the best film so far.
pub(crate) fn search(problem: &DesignProblem, quiet: bool) -> Result<SearchResult, DesignError> {
    let stop = interrupt::defer();
    if !quiet {
        announce(&problem.estimate(rayon::current_num_threads())?);
    }
    let progress = ProgressLine::start_search(!quiet);
    problem.search(&|update| show(&progress, stop, update))
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
        SearchStage::Recoil => (stage.name(), "rounds"),
        SearchStage::Strengths => (stage.name(), "strengths"),
        SearchStage::Parts(_) => (stage.name(), "parts merged"),
        SearchStage::Rounding => ("rounding", ""),
        SearchStage::Samples => ("sampling", "samples"),
        _ => (stage.name(), ""),
    };
    if let Some(best) = best {
        progress.set_prefix(format!("best error {best:.3e}, "));
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
    result: &SearchResult,
    verb: &str,
    output: Output,
    path: Option<&Path>,
    format: TextOrJson,
    quiet: bool,
) -> Result<u8, Failure> {
    let folder = path.and_then(Path::parent).unwrap_or(Path::new(""));
    let layout = layout_text(problem, result, verb, folder)?;
    let to_file = !output.is_standard();
    output.complete(&layout)?;
    let summary = format.shown(result, || text::search_result(problem, result, path, verb == SPLICE));
    if to_file {
        print(&summary)?;
    } else if !quiet {
        let _ = std::io::stderr().write_all(summary.as_bytes());
    }
    if result.interrupted {
        if !quiet {
            failure::tell(&"interrupted: this is the best film found so far");
        }
        return Ok(INTERRUPTED);
    }
    Ok(u8::from(!result.short_of.is_empty()))
}

/// The layout file of a film that was found, to be written into `folder`. Refuses a film that
/// breaks a rule of layouts.
pub(crate) fn layout_text(
    problem: &DesignProblem,
    result: &SearchResult,
    verb: &str,
    folder: &Path,
) -> Result<String, Failure> {
    let program = format!("{PROGRAM} {verb}");
    let layout = if verb == SPLICE {
        problem.spliced_layout(result, &program)
    } else {
        problem.designed_layout(result, &program)
    };
    Ok(layout.to_edited_toml(TileForm::Compact, folder, "the film found")?)
}

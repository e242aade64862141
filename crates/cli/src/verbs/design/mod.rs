//! `magsplice design` and `magsplice splice`: films that are searched for.

mod found;
mod front;
mod text;

use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use magsplice::Stage;
use magsplice::design::{DesignProblem, ProgressUpdate, SearchResult, SearchStage};
use magsplice::layout::Layout;

use crate::args::{DesignArgs, Format, SplicedArgs};
use crate::failure::{self, Failure};
use crate::interrupt;
use crate::output::Output;
use crate::progress::Progress;
use crate::text::json;

/// What the program is called in the history of layouts.
const PROGRAM: &str = concat!("magsplice ", env!("CARGO_PKG_VERSION"));

/// Exit status 1 if something that was asked for was not reached.
pub(crate) fn run(args: &DesignArgs, quiet: bool) -> Result<u8, Failure> {
    let layout = Layout::read(&args.layout)?;
    let failed = |error| Failure::Design { place: args.layout.display().to_string(), error };
    if args.front {
        return front::run(args, &layout, quiet);
    }
    let setting = DesignProblem::new(&layout).map_err(failed)?;
    let output = Output::open(args.output.as_deref(), &[&args.layout])?;
    let outcome = searched(&setting, quiet).map_err(failed)?;
    finish(&setting, &outcome, "design", output, args.output.as_deref(), args.format, quiet)
}

/// From nothing.
pub(crate) fn splice(args: &SplicedArgs, quiet: bool) -> Result<u8, Failure> {
    let failed = |error| Failure::Design { place: "splice".to_owned(), error };
    let layout = args.request().layout().map_err(failed)?;
    let setting = DesignProblem::new(&layout).map_err(failed)?;
    let output = Output::open(args.output.as_deref(), &[])?;
    let outcome = searched(&setting, quiet).map_err(failed)?;
    finish(&setting, &outcome, "splice", output, args.output.as_deref(), args.format, quiet)
}

/// The search, with progress; Ctrl-C ends it with what it has.
fn searched(setting: &DesignProblem, quiet: bool) -> Result<SearchResult, magsplice::design::DesignError> {
    let progress = Progress::start(!quiet);
    let stop = interrupt::asked_kindly();
    setting.search(&|searched| told(&progress, stop, searched))
}

fn told(
    progress: &Progress,
    stop: &AtomicBool,
    ProgressUpdate { stage, done, of, best }: ProgressUpdate,
) -> ControlFlow<()> {
    let name = match stage {
        SearchStage::Starts => "searching",
        SearchStage::Rounding => "rounding",
        other => other.name(),
    };
    let unit = match stage {
        SearchStage::Starts => "starts",
        SearchStage::Strengths => "strengths",
        SearchStage::Parts(_) => "parts made one",
        _ => "",
    };
    if let Some(best) = best {
        progress.best(format!("best error {best:.3e}, "));
    }
    progress.show(Stage { name, done, of: (of > 0).then_some(of), unit });
    if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

/// Writes the film, and says what it is like: beside the file on standard output, beside standard output on standard error.
fn finish(
    setting: &DesignProblem,
    outcome: &SearchResult,
    verb: &str,
    mut output: Output,
    path: Option<&Path>,
    format: Format,
    quiet: bool,
) -> Result<u8, Failure> {
    let written = written(setting, outcome, verb)?;
    output.write(|writer| writer.write_all(written.as_bytes()))?;
    let to_file = !output.is_standard();
    output.finish()?;
    let said = match format {
        Format::Json => json(&found::Found::of(outcome)),
        Format::Text => text::outcome(setting, outcome, path),
    };
    if to_file {
        crate::output::print(&said)?;
    } else if !quiet {
        let _ = std::io::stderr().write_all(said.as_bytes());
    }
    if outcome.interrupted && !quiet {
        failure::tell(&"interrupted: this is the best film found until then");
    }
    Ok(u8::from(!outcome.short_of.is_empty()))
}

/// The layout of a film found, as text that can be read.
fn written(setting: &DesignProblem, outcome: &SearchResult, verb: &str) -> Result<String, Failure> {
    let text = setting.designed_layout(outcome, &format!("{PROGRAM} {verb}")).to_toml();
    // A film that breaks rules of layouts must not be written.
    Layout::parse(&text, "the film found")?;
    Ok(text)
}

//! `magsplice design --front`: searches the films of a trade-off.

use std::path::Path;
use std::sync::atomic::Ordering;

use magsplice::design::{DesignProblem, ParetoFront, SearchResult};
use magsplice::results::{FilmFront, FrontFilm};

use super::search::{front_layout_text, show};
use super::text;
use crate::args::formats::TextOrJson;
use crate::failure::{self, Failure};
use crate::interrupt;
use crate::output::destination::print;
use crate::output::folder::Folder;
use crate::output::json;
use crate::progress::ProgressLine;
use crate::session::Session;

/// Searches films with these amplitudes at least, and writes them into the folder `output`.
pub(super) fn run(
    session: &Session,
    amplitudes: &[f64],
    output: Option<&Path>,
    format: TextOrJson,
    quiet: bool,
) -> Result<u8, Failure> {
    let failed = |error| Failure::design(session.path, error);
    let layout = &session.layout;
    let problem = DesignProblem::new(layout).map_err(failed)?;
    let output = output.ok_or_else(|| Failure::Refused("--front writes a folder: give one with -o DIR".to_owned()))?;
    let mut folder = Folder::open(output, "design --front", &[session.path])?;
    let stop = interrupt::defer();
    let front = {
        let progress = ProgressLine::start_search(!quiet);
        problem.pareto_front(amplitudes, &|update| show(&progress, stop, update)).map_err(failed)?
    };
    // A film that misses its amplitude, or is useless, is not on the front.
    let missed: Vec<String> =
        front.by_amplitude.iter().filter(|(_, film)| !film.short_of.is_empty()).map(missed).collect();
    let front = ParetoFront {
        by_amplitude: front.by_amplitude.into_iter().filter(|(_, film)| film.short_of.is_empty()).collect(),
        ..front
    };
    let result = FilmFront::new(layout, &front);
    for FrontFilm { file, film } in &result.films {
        folder.write(file, front_layout_text(&problem, film, output)?.as_bytes())?;
    }
    let json = json::pretty(&result);
    folder.write("front.json", json.as_bytes())?;
    write_figures(&problem, &front, &mut folder)?;
    folder.finish()?;
    match format {
        TextOrJson::Json => print(&json)?,
        TextOrJson::Text => print(&text::front(&front))?,
    }
    if !quiet {
        for missed in missed {
            failure::tell(&missed);
        }
    }
    if stop.load(Ordering::Relaxed) {
        if !quiet {
            failure::tell(&"interrupted: these are the best films found so far");
        }
        return Ok(interrupt::INTERRUPTED);
    }
    Ok(0)
}

/// Why the film for an amplitude is not on the front.
fn missed((least, film): &(f64, SearchResult)) -> String {
    let reasons: Vec<String> = film.short_of.iter().map(ToString::to_string).collect();
    format!("no film with an amplitude of {least} was found: {}", reasons.join("; "))
}

#[cfg(not(feature = "report"))]
fn write_figures(_: &DesignProblem, _: &ParetoFront, _: &mut Folder) -> Result<(), Failure> {
    Ok(())
}

#[cfg(feature = "report")]
fn write_figures(problem: &DesignProblem, front: &ParetoFront, folder: &mut Folder) -> Result<(), Failure> {
    for figure in magsplice_report::front_figures(front, problem.ideal())? {
        folder.write_all(figure.files())?;
    }
    Ok(())
}

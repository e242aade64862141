//! `magsplice design --front`: searches the films of a trade-off.

use std::path::Path;
use std::sync::atomic::Ordering;

use magsplice::design::{DesignProblem, ParetoFront};
use magsplice::results::{FilmFront, FrontFilm};

use super::search::{layout_text, show};
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
    let output = output.ok_or_else(|| Failure::Refused("--front writes a folder: name one with -o DIR".to_owned()))?;
    let mut folder = Folder::open(output, "design --front", &[session.path])?;
    let stop = interrupt::defer();
    let front = {
        let progress = ProgressLine::start_search(!quiet);
        problem.pareto_front(amplitudes, &|update| show(&progress, stop, update)).map_err(failed)?
    };
    // A film that misses its amplitude is not on the front.
    let missed: Vec<f64> =
        front.by_amplitude.iter().filter(|(_, film)| !film.short_of.is_empty()).map(|(a, _)| *a).collect();
    let front = ParetoFront {
        by_amplitude: front.by_amplitude.into_iter().filter(|(_, film)| film.short_of.is_empty()).collect(),
        ..front
    };
    let result = FilmFront::new(layout, &front);
    for FrontFilm { file, film } in &result.films {
        folder.write(file, layout_text(&problem, film, "design --front", output)?.as_bytes())?;
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
        for least in missed {
            failure::tell(&format_args!("no film with an amplitude of {least} was found"));
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

#[cfg(not(feature = "report"))]
fn write_figures(_: &DesignProblem, _: &ParetoFront, _: &mut Folder) -> Result<(), Failure> {
    Ok(())
}

#[cfg(feature = "report")]
fn write_figures(problem: &DesignProblem, front: &ParetoFront, folder: &mut Folder) -> Result<(), Failure> {
    use magsplice::decouple::Figures;
    use magsplice::design::{Metrics, SearchResult};
    use magsplice::tolerance::Statistics;
    use magsplice_report::{FrontAxis, FrontFigure, FrontFilm};

    let film = |at: f64, metrics: &Metrics, made: Option<&Figures<Statistics>>| {
        let made_p95_mm = made.map(|made| made.displacement_rmse_mm.map(|axis| axis.p95.value));
        FrontFilm::new(at, &metrics.figures, made_p95_mm, problem.ideal())
    };
    let after = |at: f64, result: &SearchResult| film(at, &result.after, result.made.as_ref().map(|made| &made.after));
    let before = front.by_amplitude.first().map(|(_, result)| {
        film(result.before.figures.amplitude, &result.before, result.made.as_ref().map(|made| &made.before))
    });
    let by_amplitude =
        front.by_amplitude.iter().map(|(_, result)| after(result.after.figures.amplitude, result)).collect();
    let by_parts = front.by_parts.iter().map(|result| after(result.parts as f64, result)).collect();
    let figures = [
        FrontFigure { axis: FrontAxis::Amplitude, films: by_amplitude, before },
        FrontFigure { axis: FrontAxis::Parts, films: by_parts, before: None },
    ];
    for figure in figures.into_iter().filter(|figure| !figure.films.is_empty()) {
        folder.write_all(figure.draw()?.files())?;
    }
    Ok(())
}

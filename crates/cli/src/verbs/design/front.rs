//! `magsplice design --front`: tables, figures and films of the whole trade.

use magsplice::design::{DesignProblem, ParetoFront, SearchResult};
use magsplice::layout::Layout;
use serde::Serialize;

use super::found::Found;
use super::{PROGRAM, text, told, written};
use crate::args::{DesignArgs, Format};
use crate::failure::{self, Failure};
use crate::folder::Folder;
use crate::interrupt;
use crate::output;
use crate::progress::Progress;
use crate::text::json;

pub(super) fn run(args: &DesignArgs, layout: &Layout, quiet: bool) -> Result<u8, Failure> {
    let failed = |error| Failure::Design { place: args.layout.display().to_string(), error };
    let setting = DesignProblem::new(layout).map_err(failed)?;
    let output = args
        .output
        .as_deref()
        .ok_or_else(|| Failure::Format("--front writes a folder: name one with -o DIR".to_owned()))?;
    let folder = Folder::open(output, is_of_a_front)?;
    let front = {
        let progress = Progress::start(!quiet);
        let stop = interrupt::asked_kindly();
        setting.pareto_front(&args.amplitudes, &|searched| told(&progress, stop, searched)).map_err(failed)?
    };
    // An amplitude that was not reached is no point of the front.
    let missed: Vec<f64> = front.by_amplitude.iter().filter(|(_, o)| !o.short_of.is_empty()).map(|(a, _)| *a).collect();
    let front = ParetoFront {
        by_amplitude: front.by_amplitude.into_iter().filter(|(_, o)| o.short_of.is_empty()).collect(),
        ..front
    };
    let mut films: Vec<Film> = Vec::new();
    let mut add = |file: String, outcome: &SearchResult| {
        folder.write(&file, written(&setting, outcome, "design --front")?.as_bytes())?;
        films.push(Film { file, found: Found::of(outcome) });
        Ok::<(), Failure>(())
    };
    for (least, outcome) in &front.by_amplitude {
        add(format!("amplitude-{least}.toml"), outcome)?;
    }
    for (index, outcome) in front.by_parts.iter().enumerate() {
        add(format!("parts-{}-{}.toml", outcome.parts, index + 1), outcome)?;
    }
    let said = json(&Report { program: PROGRAM, layout: &layout.name, sha256: &layout.sha256, films });
    folder.write("front.json", said.as_bytes())?;
    figures(&setting, &front, &folder)?;
    folder.finish()?;
    match args.format {
        Format::Json => output::print(&said)?,
        Format::Text => output::print(&text::front(&front))?,
    }
    if !quiet {
        for least in missed {
            failure::tell(&format_args!("no film with an amplitude of {least} was found"));
        }
    }
    Ok(0)
}

#[derive(Serialize)]
struct Report<'a> {
    program: &'a str,
    layout: &'a str,
    sha256: &'a str,
    films: Vec<Film>,
}

#[derive(Serialize)]
struct Film {
    file: String,
    #[serde(flatten)]
    found: Found,
}

/// Files of a folder that may be replaced.
fn is_of_a_front(name: &str) -> bool {
    let film = (name.starts_with("amplitude-") || name.starts_with("parts-")) && name.ends_with(".toml");
    film || name == "front.json" || name.starts_with("front-") && (name.ends_with(".svg") || name.ends_with(".png"))
}

#[cfg(not(feature = "report"))]
fn figures(_: &DesignProblem, _: &ParetoFront, _: &Folder) -> Result<(), Failure> {
    Ok(())
}

#[cfg(feature = "report")]
fn figures(setting: &DesignProblem, front: &ParetoFront, folder: &Folder) -> Result<(), Failure> {
    use magsplice::design::Metrics;
    use magsplice_report::{FrontAxis, FrontFigure, FrontFilm};

    let film = |at: f64, figures: &Metrics| FrontFilm {
        at,
        displacement_rmse_mm: figures.displacement_rmse_mm,
        uniformity_rmse_mm: figures.uniformity_rmse.as_lengths(setting.ideal().wavenumber()).to_array(),
    };
    let before = front.by_amplitude.first().map(|(_, outcome)| film(outcome.before.amplitude, &outcome.before));
    let by_amplitude = front.by_amplitude.iter().map(|(_, o)| film(o.after.amplitude, &o.after)).collect();
    let by_parts = front.by_parts.iter().map(|o| film(o.parts as f64, &o.after)).collect();
    let drawn = [
        FrontFigure { axis: FrontAxis::Amplitude, films: by_amplitude, before },
        FrontFigure { axis: FrontAxis::Parts, films: by_parts, before: None },
    ];
    for drawn in drawn.into_iter().filter(|drawn| !drawn.films.is_empty()) {
        let figure = drawn.draw().map_err(|error| Failure::Format(error.to_string()))?;
        folder.write(&format!("{}.svg", figure.name), figure.svg.as_bytes())?;
        folder.write(&format!("{}.png", figure.name), &figure.png)?;
    }
    Ok(())
}

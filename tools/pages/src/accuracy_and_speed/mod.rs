//! Measures the time and the error of every way to evaluate a field, compared with magba and
//! magpylib, and writes `docs/accuracy-and-speed.md`.

/// The effort and the tolerances of measurements.
mod effort;
/// Time against error, one panel for each scene.
mod figure;
/// Time against the number of tiles and points.
mod growth_figure;
/// Colours and shapes of contenders.
mod marks;
/// Time and error of every contender at one place.
mod measure;
/// The text of the page.
mod page;
/// The Pareto front of contenders.
mod pareto;
/// Errors of the textbook formula in single and double precision.
mod single_precision;

use std::fs;
use std::path::Path;

use magsplice::field::Tolerance;
use magsplice_benches::{Growth, PlacedScene, growth, placed_scenes};

use crate::magpylib::magpylib_version;
use effort::{DialEffort, GROWTH_TOLERANCE};
use measure::{MeasuredScene, measure};

/// Writes the page and its pictures to the folder `docs`; without `python` magpylib is omitted.
pub(crate) fn write(docs: &Path, python: Option<&Path>, once: bool) -> Result<(), String> {
    let effort = if once { DialEffort::ONCE } else { DialEffort::FULL };
    let magpylib = python.map(magpylib_version).transpose()?;
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|e| e.to_string())?;
    let measured = |scene: PlacedScene| {
        let at = |place| measure(&scene.tiles, place, python, effort);
        let measurements = scene.places.iter().map(at).collect::<Result<_, _>>()?;
        Ok(MeasuredScene { scene, measurements })
    };
    let measured: Vec<MeasuredScene> =
        one_thread.install(|| placed_scenes(effort.sizes).into_iter().map(measured).collect::<Result<_, String>>())?;
    let tolerance = Tolerance::relative(GROWTH_TOLERANCE).expect("above zero");
    let films: Vec<Growth> =
        one_thread.install(|| effort.films.iter().map(|&(side, runs)| growth(side, tolerance, runs)).collect());
    let precision = single_precision::measure(effort)?;
    let pictures = docs.join("pictures");
    let io = |e: std::io::Error| e.to_string();
    fs::create_dir_all(&pictures).map_err(io)?;
    figure::draw(&pictures.join("accuracy-and-speed.svg"), &measured)?;
    growth_figure::draw(&pictures.join("accuracy-and-speed-growth.svg"), &films)?;
    let text = page::text(&measured, &films, &precision, magpylib.as_deref(), effort);
    fs::write(docs.join("accuracy-and-speed.md"), text).map_err(io)
}

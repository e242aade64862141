//! Measures the times of magsplice, magba and magpylib on the same scenes and writes
//! `docs/speed.md`.

/// The effort of measurements.
mod effort;
/// The two pictures.
mod figure;
/// Time by numbers of tiles, points and threads.
mod growth;
/// The smallest possible time of the operations of the closed form.
mod limit;
/// The text of the page.
mod page;
/// The same scenes by three programs.
mod peers;

use std::fs;
use std::path::Path;

use effort::SpeedEffort;

use crate::magpylib::magpylib_version;

/// Writes the page and its pictures to the folder `docs`; without `python` magpylib is omitted.
pub(crate) fn write(docs: &Path, python: Option<&Path>, once: bool) -> Result<(), String> {
    let effort = if once { SpeedEffort::ONCE } else { SpeedEffort::FULL };
    let magpylib = python.map(magpylib_version).transpose()?;
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|e| e.to_string())?;
    let scenes = one_thread.install(|| peers::measure(python, effort))?;
    let tiles = one_thread.install(|| growth::by_tiles(effort));
    let points = one_thread.install(|| growth::by_points(effort));
    let threads = growth::by_threads(effort);
    let limit = one_thread.install(|| limit::measure(effort));
    let pictures = docs.join("pictures");
    let io = |e: std::io::Error| e.to_string();
    fs::create_dir_all(&pictures).map_err(io)?;
    figure::draw_peers(&pictures.join("speed.svg"), &scenes)?;
    figure::draw_growth(&pictures.join("growth.svg"), &tiles, &points)?;
    let text = page::text(magpylib.as_deref(), effort, &scenes, &tiles, &points, &threads, &limit);
    fs::write(docs.join("speed.md"), text).map_err(io)
}

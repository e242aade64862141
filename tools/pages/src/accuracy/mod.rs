//! Measures the errors of magsplice, magba and magpylib at the same points and writes
//! `docs/accuracy.md`.

/// Worst errors by distance and by closeness to an edge.
mod curves;
/// The picture of both curves.
mod figure;
/// The text of the page.
mod page;
/// The same field from three programs.
mod peers;
/// Worst and median errors by region, on the reference tables.
mod regions;
/// Errors at the seam of two touching cubes.
mod seams;

use std::fs;
use std::path::Path;

use crate::magpylib::magpylib_version;

/// Random points at each distance, and with `--once`.
const POINTS: usize = 24;
const FEW_POINTS: usize = 2;

/// Writes the page and its picture to the folder `docs`; without `python` magpylib is omitted.
pub(crate) fn write(docs: &Path, python: Option<&Path>, once: bool) -> Result<(), String> {
    let points = if once { FEW_POINTS } else { POINTS };
    let magpylib = python.map(magpylib_version).transpose()?;
    let regions = regions::measure(python)?;
    let distance = curves::by_distance(python, points)?;
    let closeness = curves::by_closeness(python, points)?;
    let seams = seams::measure(python)?;
    let pictures = docs.join("pictures");
    let io = |e: std::io::Error| e.to_string();
    fs::create_dir_all(&pictures).map_err(io)?;
    figure::draw(&pictures.join("accuracy.svg"), &distance, &closeness)?;
    let text = page::text(magpylib.as_deref(), points, &regions, &distance, &closeness, &seams);
    fs::write(docs.join("accuracy.md"), text).map_err(io)
}

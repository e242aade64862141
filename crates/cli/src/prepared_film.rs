//! Films prepared for evaluation.

use std::path::Path;
use std::sync::Arc;

use magsplice::Film;
use magsplice::layout::Layout;

use crate::failure::Failure;
use crate::progress::ProgressLine;
use crate::text::recoil::beyond_knee;
use crate::words::film_failure;

/// The film of a layout, with the polarization of its tiles solved if they have a recoil
/// permeability. Cells beyond the knee of the material are told.
pub(crate) fn prepare(
    path: &Path,
    layout: &Layout,
    progress: &Arc<ProgressLine>,
    tell: &dyn Fn(&str),
) -> Result<Film, Failure> {
    let film = Film::with_progress(layout.clone(), progress.clone());
    let film = film.map_err(|error| film_failure(path, layout, error))?;
    tell_of_knee(path, &film, tell);
    Ok(film)
}

/// Tells of the part of a film that is beyond the knee of the material.
pub(crate) fn tell_of_knee(path: &Path, film: &Film, tell: &dyn Fn(&str)) {
    if let Some(found) = film.recoil().and_then(|recoil| beyond_knee(recoil, film.layout())) {
        tell(&format!("warning: {}: {found}", path.display()));
    }
}

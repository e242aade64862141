//! Films prepared for evaluation.

use std::path::Path;

use magsplice::layout::Layout;
use magsplice::magnet::Permeability;
use magsplice::{Film, RecoilEstimate, Stage};

use crate::failure::Failure;
use crate::text::recoil::beyond_knee;
use crate::words::film_failure;

/// The film of a layout, with the polarization of its tiles solved if they have a recoil
/// permeability. Cells beyond the knee of the material are told.
pub(crate) fn prepare<'a>(
    path: &Path,
    layout: &'a Layout,
    show: &'a (dyn Fn(Stage) + Sync),
    tell: &dyn Fn(&str),
) -> Result<Film<'a>, Failure> {
    let film = Film::with_progress(layout, show).map_err(|error| film_failure(path, layout, error))?;
    tell_of_knee(path, &film, tell);
    Ok(film)
}

/// Tells of the part of a film that is beyond the knee of the material.
pub(crate) fn tell_of_knee(path: &Path, film: &Film, tell: &dyn Fn(&str)) {
    if let Some(found) = film.recoil().and_then(|recoil| beyond_knee(recoil, film.layout())) {
        tell(&format!("warning: {}: {found}", path.display()));
    }
}

/// Permeabilities of a layout that states none: those of most rare-earth magnets, and of weak
/// bonded ones.
const TRIED_PERMEABILITIES: [f64; 2] = [1.05, 1.2];

/// What recoil changes in the figures of a film, to first order: for the permeabilities of the
/// layout, or if it states none, for those that magnets have. Empty without an ideal film and a
/// working volume.
pub(crate) fn recoil_estimates(path: &Path, layout: &Layout) -> Result<Vec<RecoilEstimate>, Failure> {
    let tried = if layout.has_recoil() { &TRIED_PERMEABILITIES[..1] } else { &TRIED_PERMEABILITIES };
    let mut estimates = Vec::new();
    for mu_r in tried {
        let permeability = Permeability::isotropic(*mu_r).expect("a permeability of magnets");
        let found = RecoilEstimate::new(layout, permeability).map_err(|error| film_failure(path, layout, error))?;
        estimates.extend(found);
    }
    Ok(estimates)
}

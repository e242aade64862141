//! What recoil changes in a film.

use serde::Serialize;

use crate::film_recoil::{FiguresWithRecoil, FilmRecoil};

/// What recoil changes in a film, with estimates of the errors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecoilSummary {
    /// Number of cells.
    pub cells: usize,
    /// Level of division.
    pub level: usize,
    /// Largest change of B; see [`FilmRecoil::change_t`].
    pub change_t: f64,
    /// Estimate of the largest error of B.
    pub error_t: f64,
    /// Figures over a few points of the working volume. `None` if they do not exist.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub figures: Option<FiguresWithRecoil>,
    /// Largest lost fraction of the magnitude of the polarization of a tile.
    pub largest_weakening: f64,
    /// Largest angle by which the mean polarization of a tile turns.
    pub largest_turn_deg: f64,
}

impl RecoilSummary {
    /// The summary of a solved film.
    pub fn new(recoil: &FilmRecoil) -> RecoilSummary {
        let changes = recoil.tile_changes();
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::NEG_INFINITY, f64::max);
        RecoilSummary {
            cells: recoil.magnetization().cells().len(),
            level: recoil.level(),
            change_t: recoil.change_t(),
            error_t: recoil.error_t(),
            figures: recoil.figures(),
            largest_weakening: largest(&mut changes.iter().map(|change| change.weakening)),
            largest_turn_deg: largest(&mut changes.iter().map(|change| change.angle.to_degrees())),
        }
    }
}

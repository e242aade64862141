//! A film with the tile of each place: the result of `assign`.

use magsplice::FilmRecoil;
use magsplice::layout::Layout;
use magsplice::making::{Assignment, MeasurementErrors};
use magsplice::prelude::Tile;
use magsplice::tolerance::Statistics;

use super::laying_plan::PlanRow;

/// The result of `assign`.
pub(crate) struct AssignedFilm<'a> {
    pub(crate) layout: &'a Layout,
    pub(crate) recoil: Option<FilmRecoil>,
    /// Numbers of the tiles that were measured and of the places.
    pub(crate) measured: usize,
    /// The film as ordered, by its RMS displacement error in mm.
    pub(crate) ordered_rms_mm: f64,
    pub(crate) found: Assignment,
    /// Errors of the measurements, and the RMS displacement errors with them.
    pub(crate) measurement: Option<(MeasurementErrors, Statistics)>,
    /// The tiles where they lie or will lie.
    pub(crate) tiles: Vec<Tile>,
    /// One for each place.
    pub(crate) plan: Vec<PlanRow>,
    /// Index and strength in tesla of each shim tile.
    pub(crate) shims: Vec<(usize, f64)>,
}

/// Starts whose end counts as the best one: within a tenth of it.
const NEAR_BEST: f64 = 1.1;

impl AssignedFilm<'_> {
    /// The median of the ends of all starts over the best, and the number of starts that ended near the
    /// best.
    pub(crate) fn starts(&self) -> (f64, usize) {
        let ends = &self.found.starts_rms_mm;
        let best = ends[0];
        let near = ends.iter().filter(|end| **end <= NEAR_BEST * best).count();
        (if best > 0.0 { ends[ends.len() / 2] / best } else { 1.0 }, near)
    }
}

//! A film with the tile of each place: the result of `assign`.

use magsplice::layout::Layout;
use magsplice::{FilmAssignment, FilmRecoil};

/// The result of `assign`.
pub(crate) struct AssignedFilm<'a> {
    pub(crate) layout: &'a Layout,
    pub(crate) recoil: Option<FilmRecoil>,
    /// Number of the tiles that were measured.
    pub(crate) measured: usize,
    pub(crate) assignment: FilmAssignment,
}

/// Starts whose end counts as the best one: within a tenth of it.
const NEAR_BEST: f64 = 1.1;

impl AssignedFilm<'_> {
    /// The median of the ends of all starts over the best, and the number of starts that ended near
    /// the best.
    pub(crate) fn starts(&self) -> (f64, usize) {
        let ends = &self.assignment.found.starts_rms_mm;
        let best = ends[0];
        let near = ends.iter().filter(|end| **end <= NEAR_BEST * best).count();
        (if best > 0.0 { ends[ends.len() / 2] / best } else { 1.0 }, near)
    }
}

//! Forces and torques of the tiles of a film on each other.

use std::sync::atomic::{AtomicUsize, Ordering};

use magsplice_force::{FilmForces, FilmForcesError};
use magsplice_recoil::{Magnetization, RefinementError};
use serde::Serialize;

use crate::film::Film;
use crate::film_error::FilmError;
use crate::film_recoil::recoil_tiles;
use crate::stage::Stage;

/// Levels of division of tiles with a recoil permeability: 8 and 27 cells for a compact tile.
const RECOIL_LEVELS: [usize; 2] = [2, 3];

/// Error of forces at the higher level over what the levels are apart. In five or six tiles of
/// three films, with permeabilities of 1.05 and 1.2, levels 7 to 10 are 0.9 to 1.7 times as far
/// from it, and the limit probably up to 2.2 times (docs/recoil.md).
const ERROR_OF_DIFFERENCE: f64 = 3.0;

/// From the unit of [`Load`](magsplice_force::Load) with lengths in mm to N, and to N mm.
pub(crate) const PER_MM2: f64 = 1e-6;

/// Forces and torques of the tiles of a film on each other, and what recoil changes in them.
#[derive(Clone, Debug, PartialEq)]
pub struct SolvedForces {
    /// The loads of all pairs.
    pub loads: FilmForces,
    /// `None` without recoil.
    pub recoil: Option<ForceChange>,
}

/// What recoil changes in the forces on tiles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ForceChange {
    /// Number of cells.
    pub cells: usize,
    /// The level of division.
    pub level: usize,
    /// The largest change of the force on a tile by all others.
    pub change_n: f64,
    /// The estimate of the largest error of such a force.
    pub error_n: f64,
}

impl Film {
    /// The loads of all pairs of tiles. `turned_error` is the largest relative error of the force
    /// of two tiles that are turned against each other.
    ///
    /// Tiles with a recoil permeability are divided into 27 cells or more, with the polarization
    /// that they have in the whole film, also while the film is laid.
    ///
    /// # Errors
    /// [`FilmError::Forces`] for too many tiles, and for turned tiles so close that their force
    /// does not converge; [`FilmError::Recoil`] if the polarization of the cells is not known.
    pub fn pair_forces(&self, turned_error: f64) -> Result<SolvedForces, FilmError> {
        let layout = self.layout();
        let tiles = layout.bare_tiles();
        let passes = if layout.has_recoil() { 1 + RECOIL_LEVELS.len() } else { 1 };
        let (done, of) = (AtomicUsize::new(0), Some(passes * tiles.len()));
        let counted = || {
            let done = done.fetch_add(1, Ordering::Relaxed);
            self.tell(Stage { name: "forces", done, of, unit: "tiles" });
        };
        let failed = |error: FilmForcesError| {
            let tiles = match &error {
                FilmForcesError::Pair { first, second, .. } => vec![*first, *second],
                _ => Vec::new(),
            };
            let tiles = tiles.into_iter().map(|index| layout.tiles[index].name.clone()).collect();
            FilmError::Forces { error, tiles }
        };
        let rigid = FilmForces::new(&tiles, turned_error, counted).map_err(failed)?;
        if !layout.has_recoil() {
            return Ok(SolvedForces { loads: rigid, recoil: None });
        }
        let recoil_tiles = recoil_tiles(layout, None);
        let at_level = |level: usize| {
            let stage = Stage { name: "polarization, level", done: level, of: None, unit: "" };
            let solved = Magnetization::solve(&recoil_tiles, level, |_| self.tell(stage))
                .map_err(|error| FilmError::from_recoil(RefinementError::Recoil(error), layout))?;
            let means = solved.mean_tiles();
            let loads = FilmForces::of_cells(&means, solved.cells(), solved.owners(), turned_error, counted);
            Ok((loads.map_err(failed)?, solved.cells().len()))
        };
        let [(coarse, _), (loads, cells)] = [at_level(RECOIL_LEVELS[0])?, at_level(RECOIL_LEVELS[1])?];
        let apart = |other: &FilmForces| {
            let pairs = loads.by_all().into_iter().zip(other.by_all());
            pairs.map(|(load, other)| (load.force - other.force).length()).fold(0.0, f64::max)
        };
        let (change_n, error_n) = (PER_MM2 * apart(&rigid), PER_MM2 * (ERROR_OF_DIFFERENCE * apart(&coarse)));
        let recoil = Some(ForceChange { cells, level: RECOIL_LEVELS[1], change_n, error_n });
        Ok(SolvedForces { loads, recoil })
    }
}

#[cfg(test)]
mod tests {
    use magsplice_layout::Layout;

    use super::*;

    fn layout(permeability: f64, second: &str) -> Layout {
        let tile = "size_mm = [1, 1, 1]\npolarization_t = [1, 0, 0]\n";
        let text = format!(
            "format = 1\nname = \"pair\"\n[material]\nrecoil_permeability = {permeability}\n\
             [[tile]]\nname = \"a\"\nposition_mm = [0, 0, 0]\n{tile}[[tile]]\nname = \"b\"\n{second}\n{tile}"
        );
        Layout::parse(&text, "layout").unwrap()
    }

    /// The error contains the force of finer cells.
    #[test]
    fn recoil_weakens_the_force_of_two_cubes() {
        let force = |permeability| {
            let layout = layout(permeability, "position_mm = [1.1, 0, 0]");
            let found = Film::rigid(layout.clone()).pair_forces(1e-9).unwrap();
            let finer = Magnetization::solve(&recoil_tiles(&layout, None), 6, |_| {}).unwrap();
            let finer = FilmForces::of_cells(&finer.mean_tiles(), finer.cells(), finer.owners(), 1e-9, || {}).unwrap();
            (found.loads.by_one(0, 1).force.x, finer.by_one(0, 1).force.x, found.recoil)
        };
        let (rigid, _, none) = force(1.0);
        assert_eq!(none, None);
        let (with, finer, recoil) = force(1.2);
        let recoil = recoil.unwrap();
        assert!((0.8..0.98).contains(&(with / rigid)), "{with} {rigid}");
        assert!((PER_MM2 * (rigid - with).abs() / recoil.change_n - 1.0).abs() < 1e-9, "{recoil:?}");
        assert!(
            PER_MM2 * (with - finer).abs() < recoil.error_n && recoil.error_n < recoil.change_n,
            "{with} {finer} {recoil:?}"
        );
    }

    #[test]
    fn turned_tiles_that_touch_are_named() {
        let layout = layout(1.0, "position_mm = [1, 0, 0]\nrotation = { axis = [1, 0, 0], angle_deg = 20 }");
        let error = Film::rigid(layout.clone()).pair_forces(1e-13).unwrap_err();
        assert!(error.to_string().starts_with("tiles \"a\" and \"b\": their force is known to"), "{error}");
    }
}

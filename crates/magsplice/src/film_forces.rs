//! Forces and torques of the tiles of a film on each other.

use magsplice_force::{FilmForces, FilmForcesError};
use magsplice_recoil::{Magnetization, RefinementError};

use crate::film::Film;
use crate::film_error::FilmError;
use crate::film_recoil::recoil_tiles;

/// Level of division of tiles with a recoil permeability: eight cells for a compact tile. The next level has ten
/// times as many pairs. What it changes in the forces has not been measured.
const RECOIL_LEVEL: usize = 2;

impl Film<'_> {
    /// The loads of all pairs of tiles. `turned_error` is the largest relative error of the force of two tiles
    /// that are turned against each other. `progress` is told, from any thread, when those of a tile are known.
    ///
    /// Tiles with a recoil permeability are divided into eight cells, with the polarization that they have in the
    /// whole film, also while the film is laid.
    ///
    /// # Errors
    /// [`FilmError::Forces`] for too many tiles, and for turned tiles so close that their force does not converge;
    /// [`FilmError::Recoil`] if the polarization of the cells is not known.
    pub fn forces(&self, turned_error: f64, progress: impl Fn() + Sync) -> Result<FilmForces, FilmError> {
        let layout = self.layout();
        let tiles = layout.bare_tiles();
        let cells = if layout.has_recoil() {
            let solved = Magnetization::solve(&recoil_tiles(layout, None), RECOIL_LEVEL, || {});
            Some(solved.map_err(|error| FilmError::from_recoil(RefinementError::Recoil(error), layout))?)
        } else {
            None
        };
        let forces = match &cells {
            Some(found) => FilmForces::of_cells(&tiles, found.cells(), found.owners(), turned_error, progress),
            None => FilmForces::new(&tiles, turned_error, progress),
        };
        forces.map_err(|error| {
            let owner = |index: usize| cells.as_ref().map_or(index, |found| found.owners()[index]);
            let tiles = match &error {
                FilmForcesError::Pair { first, second, .. } => vec![*first, *second],
                _ => Vec::new(),
            };
            let tiles = tiles.into_iter().map(|index| layout.tiles[owner(index)].name.clone()).collect();
            FilmError::Forces { error, tiles }
        })
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

    #[test]
    fn recoil_weakens_the_force_of_two_cubes() {
        let force = |permeability| {
            let layout = layout(permeability, "position_mm = [1.5, 0, 0]");
            Film::rigid(&layout).forces(1e-9, || {}).unwrap().by_one(0, 1).force.x
        };
        // Each cube loses its susceptibility times its demagnetizing factor, 0.2 / 3, but for the other's field.
        let ratio = force(1.2) / force(1.0);
        assert!((0.87..0.95).contains(&ratio), "{ratio}");
    }

    #[test]
    fn turned_tiles_that_touch_are_named() {
        let layout = layout(1.0, "position_mm = [1, 0, 0]\nrotation = { axis = [1, 0, 0], angle_deg = 20 }");
        let error = Film::rigid(&layout).forces(1e-13, || {}).unwrap_err();
        assert!(error.to_string().starts_with("tiles \"a\" and \"b\": their force is known to"), "{error}");
    }
}

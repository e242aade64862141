//! The field that recoil adds to a film in a search.
//!
//! B with recoil is B of the polarizations J_r plus that of what the field adds to them. A descent
//! holds the second part constant. It is then computed anew for the film found, until it stays: it
//! changes by the susceptibility times the change of the film, so that each round is nearer by
//! about this factor.

use glam::DVec3;
use magsplice_field::Scene;
use magsplice_layout::FilmTolerance;
use magsplice_magnet::{Quantity, Tile};
use magsplice_recoil::{Magnetization, RecoilTile};
use magsplice_tolerance::{RealFilm, Weakening};

use crate::error::DesignError;
use crate::problem::design_problem::DesignProblem;
use crate::problem::least_squares::Candidate;
use crate::problem::pattern::Pattern;
use crate::progress::{ProgressUpdate, SearchStage, Watch};
use crate::tolerances::{MOST_STEPS, RECOIL_LEVEL, RECOIL_STAYS, ROUNDS_OF_RECOIL};

impl DesignProblem<'_> {
    /// The cells of a film with the polarization that agrees with their field; without recoil the
    /// tiles.
    ///
    /// # Errors
    /// If the polarization is not known.
    pub(crate) fn cells(&self, tiles: &[Tile]) -> Result<Vec<Tile>, DesignError> {
        Ok(self.magnetization(tiles)?.map_or_else(|| tiles.to_vec(), |solution| solution.cells().to_vec()))
    }

    /// A film with its errors, whose tiles have the mean polarizations of their cells.
    ///
    /// # Errors
    /// If the polarization is not known.
    pub(crate) fn real_film(&self, tiles: &[Tile], tolerance: &FilmTolerance) -> Result<RealFilm, DesignError> {
        let film = RealFilm::new(tiles, tolerance).with_iron(self.layout.iron.clone());
        let film = film.with_head(self.layout.head().cloned());
        Ok(match self.magnetization(tiles)? {
            None => film,
            Some(solution) => {
                let remainder = self.scene(&solution.deviations())?;
                film.with_weakening(Weakening::new(tiles, &solution.mean_tiles(), remainder))
            }
        })
    }

    /// Tiles before the iron of the layout.
    fn scene(&self, tiles: &[Tile]) -> Result<Scene, DesignError> {
        Scene::new(tiles).with_planes(&self.layout.iron).map_err(DesignError::InIron)
    }

    /// The polarization of a film; `None` without recoil.
    fn magnetization(&self, tiles: &[Tile]) -> Result<Option<Magnetization>, DesignError> {
        if !self.layout.has_recoil() {
            return Ok(None);
        }
        let tiles: Vec<RecoilTile> = tiles
            .iter()
            .zip(self.layout.permeabilities())
            .map(|(tile, permeability)| RecoilTile { tile: *tile, permeability })
            .collect();
        Magnetization::extrapolated(&tiles, &self.layout.iron, RECOIL_LEVEL, |_| {})
            .map(Some)
            .map_err(DesignError::Recoil)
    }

    /// Holds the field that recoil adds to this film. Returns the largest change of what was
    /// held, relative to the largest field.
    ///
    /// # Errors
    /// If the polarization or the field is not known.
    pub(crate) fn hold_recoil(&mut self, tiles: &[Tile]) -> Result<f64, DesignError> {
        if !self.layout.has_recoil() {
            return Ok(0.0);
        }
        let places = self.least_squares.sampling.places().to_vec();
        let field_t = |tiles: &[Tile]| {
            self.scene(tiles)?.field_at(Quantity::FluxDensity, &places).map_err(|_| DesignError::NoField)
        };
        let (rigid_t, with_t) = (field_t(tiles)?, field_t(&self.cells(tiles)?)?);
        let added_t: Vec<DVec3> = with_t.iter().zip(&rigid_t).map(|(with, rigid)| *with - *rigid).collect();
        let held_t = &mut self.least_squares.sampling.recoil_t;
        let largest = |vectors: &mut dyn Iterator<Item = DVec3>| vectors.map(DVec3::length).fold(0.0, f64::max);
        let change_t = largest(&mut added_t.iter().zip(held_t.iter()).map(|(new, old)| *new - *old));
        *held_t = added_t;
        Ok(change_t / largest(&mut with_t.into_iter()))
    }

    /// Descends until the field that recoil adds belongs to the film found.
    ///
    /// # Errors
    /// If the polarization or the field is not known.
    pub(crate) fn settle_recoil(
        &mut self,
        pattern: &Pattern,
        mut candidate: Candidate,
        watch: &Watch,
    ) -> Result<Candidate, DesignError> {
        if !self.layout.has_recoil() {
            return Ok(candidate);
        }
        for done in 0..ROUNDS_OF_RECOIL {
            let best = Some(candidate.root_mean_square());
            let update = ProgressUpdate { stage: SearchStage::Recoil, done, of: ROUNDS_OF_RECOIL, best };
            let tiles = pattern.all_tiles(&candidate.variables).ok_or(DesignError::NoField)?;
            if self.hold_recoil(&tiles)? <= RECOIL_STAYS || watch.show(update).is_break() {
                break;
            }
            candidate = self
                .least_squares
                .descend(pattern, candidate.variables, MOST_STEPS, &mut |_| watch.show(update))
                .ok_or(DesignError::Singular)?;
        }
        self.least_squares.candidate_at(pattern, candidate.variables).ok_or(DesignError::Singular)
    }
}

#[cfg(test)]
mod tests {
    use magsplice_layout::Layout;

    use super::*;
    use crate::progress::ignore_progress;

    fn layout(recoil_permeability: f64) -> Layout {
        let text = format!(
            "format = 1\nname = \"film\"\n[material]\nrecoil_permeability = {recoil_permeability}\n\
             [ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
             [volume]\nx_mm = [-2.0, 2.0]\ny_mm = [-2.0, 2.0]\nz_mm = [-5.0, -3.0]\nstep_mm = 2.0\n\
             [design]\nvary = [\"position\"]\noutline_mm = {{ x = [-5.0, 5.0], y = [-4.0, 4.0] }}\n\
             [[tile]]\nposition_mm = [-1.7, 0.3, 0.5]\nsize_mm = [3.0, 2.0, 1.0]\npolarization_t = [-0.1, 0.05, 0.0]\n\
             [[tile]]\nposition_mm = [1.7, 0.1, 0.5]\nsize_mm = [3.1, 2.5, 1.0]\npolarization_t = [0.1, 0.06, 0.0]\n"
        );
        Layout::parse(&text, "film").unwrap_or_else(|e| panic!("{e}"))
    }

    fn field_t(problem: &DesignProblem, tiles: &[Tile]) -> Vec<DVec3> {
        let points = problem.least_squares.sampling.computed();
        Scene::new(tiles).field_at(Quantity::FluxDensity, points).expect("outside")
    }

    fn largest(vectors: impl IntoIterator<Item = DVec3>) -> f64 {
        vectors.into_iter().map(DVec3::length).fold(0.0, f64::max)
    }

    /// The field of the cells without the field of the tiles is held, and its change is measured by
    /// the largest field.
    #[test]
    fn added_field_is_held() {
        let layout = layout(1.2);
        let mut problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
        let tiles = layout.bare_tiles();
        let cells = problem.cells(&tiles).expect("cells");
        assert!(cells.len() > tiles.len());
        let (with_t, rigid_t) = (field_t(&problem, &cells), field_t(&problem, &tiles));
        let added_t: Vec<DVec3> = with_t.iter().zip(&rigid_t).map(|(with, rigid)| *with - *rigid).collect();
        let change = problem.hold_recoil(&tiles).expect("a field");
        let known = largest(added_t.iter().copied()) / largest(with_t.iter().copied());
        assert!(known > 0.01 && (change / known - 1.0).abs() < 1e-12, "{change}, not {known}");
        assert_eq!(problem.least_squares.sampling.recoil_t, added_t);
        assert_eq!(problem.hold_recoil(&tiles), Ok(0.0));
        // The film of a search has the field of its cells.
        let field = problem.least_squares.sampling.field(&problem.pattern, &problem.pattern.start, false);
        let field_t = field.expect("a field").flux_density_t;
        assert!(field_t.iter().zip(&with_t).all(|(found, known)| found.distance(*known) < 1e-15));
        let film = problem.real_film(&tiles, &FilmTolerance::default()).expect("a film");
        let means = film.in_film(&tiles).expect("tiles").into_owned();
        assert!(means.iter().zip(&tiles).all(|(mean, tile)| mean.polarization_t() != tile.polarization_t()));
    }

    #[test]
    fn recoil_settles_at_the_film_found() {
        let layout = layout(1.2);
        let mut problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
        let start = problem.least_squares.nearest(&problem.pattern, &problem.pattern.start).expect("a film");
        let start = problem.least_squares.candidate_at(&problem.pattern, start).expect("a field");
        let pattern = problem.pattern.clone();
        let found = problem.settle_recoil(&pattern, start, &Watch::new(&ignore_progress)).expect("a film");
        let tiles = pattern.all_tiles(&found.variables).expect("sides above 0");
        assert!(problem.hold_recoil(&tiles).expect("a field") < 1e-5);
        assert!(problem.least_squares.nearest(&pattern, &found.variables).is_ok());
    }

    #[test]
    fn rigid_films_have_no_added_field() {
        let layout = layout(1.0);
        let mut problem = DesignProblem::new(&layout).unwrap_or_else(|e| panic!("{e}"));
        let tiles = layout.bare_tiles();
        assert_eq!(problem.cells(&tiles).as_deref(), Ok(&tiles[..]));
        assert_eq!(problem.hold_recoil(&tiles), Ok(0.0));
        let film = problem.real_film(&tiles, &FilmTolerance::default()).expect("a film");
        assert_eq!(film.in_film(&tiles).expect("tiles").as_ref(), tiles);
    }
}

//! The polarization to first order in the susceptibility.

use glam::DVec3;
use magsplice_magnet::{IronPlanes, Tile};
use rayon::prelude::*;

use crate::division::Division;
use crate::error::RecoilError;
use crate::magnetization::Magnetization;
use crate::material::RecoilTile;
use crate::pair_sums::PairSums;
use crate::tolerances::MOST_CELLS_OF_TENSORS;

impl Magnetization {
    /// The polarization J = J_r + chi mu0 H in the field H of the polarizations J_r, with each tile
    /// divided into cells at a level. `iron` is around them. It is an estimate without the solution
    /// of equations. 56 tiles of one cell each take milliseconds.
    ///
    /// # Accuracy
    /// The neglected terms are at most chi times the change, in the root mean square over the
    /// volume: a twentieth of it for a permeability of 1.05. The division has larger errors. At
    /// level 1 the error of the change of B outside a film is tens of percent. Where the fields of
    /// the tiles of a designed film cancel, the remainder may be wrong by a factor.
    ///
    /// # Errors
    /// The errors of [`Magnetization::solve`], except the errors of the solution.
    pub fn first_order(
        tiles: &[RecoilTile],
        iron: &IronPlanes,
        level: usize,
        progress: impl Fn(usize) + Sync,
    ) -> Result<Magnetization, RecoilError> {
        let division = Division::new(tiles, iron, level)?;
        let rigid: Vec<DVec3> = division.cells.iter().map(Tile::scene_polarization_t).collect();
        let fields_t = mean_fields_t(&division, &rigid, progress)?;
        let induced: Vec<DVec3> =
            fields_t.iter().zip(&division.owners).map(|(h_t, owner)| tiles[*owner].susceptibility() * *h_t).collect();
        Magnetization::new(tiles, division, &induced, fields_t)
    }
}

/// The mean of mu0 H over each cell, in tesla: pair by pair for few cells, by a tree for many.
fn mean_fields_t(
    division: &Division,
    rigid: &[DVec3],
    progress: impl Fn(usize) + Sync,
) -> Result<Vec<DVec3>, RecoilError> {
    if rigid.len() > MOST_CELLS_OF_TENSORS {
        return Ok(PairSums::by_tree(division, progress)?.mean_fields_t(rigid));
    }
    let field = |i: usize| {
        progress(1);
        let mut sum = DVec3::ZERO;
        for (j, j_t) in rigid.iter().enumerate() {
            sum += division.mean_tensor(i, j)? * *j_t;
        }
        Ok(-sum)
    };
    (0..rigid.len()).into_par_iter().map(field).collect()
}

#[cfg(test)]
mod tests {
    use magsplice_magnet::Permeability;

    use super::*;

    /// The difference from the solution is of second order in chi.
    #[test]
    fn first_order_has_an_error_of_second_order() {
        let error = |chi: f64| {
            let permeability = Permeability::isotropic(1.0 + chi).unwrap();
            let tiles = [(DVec3::ZERO, DVec3::Z), (DVec3::new(1.2, 0.3, 0.0), DVec3::X)].map(|(position, j_t)| {
                RecoilTile { tile: Tile::new(position, DVec3::ONE, j_t).unwrap(), permeability }
            });
            let estimate = Magnetization::first_order(&tiles, &IronPlanes::default(), 2, |_| {}).unwrap();
            let solution = Magnetization::solve(&tiles, &IronPlanes::default(), 2, |_| {}).unwrap();
            let pairs = estimate.cells().iter().zip(solution.cells());
            pairs.map(|(a, b)| (a.polarization_t() - b.polarization_t()).length()).fold(0.0, f64::max)
        };
        let [coarse, fine] = [error(1e-2), error(1e-3)];
        assert!(coarse < 1e-4, "{coarse:e}");
        assert!((coarse / fine / 100.0 - 1.0).abs() < 0.02, "{coarse:e} {fine:e}");
    }

    #[test]
    fn unit_permeability_keeps_every_bit() {
        let permeability = Permeability::isotropic(1.0).unwrap();
        let tile = Tile::new(DVec3::ZERO, DVec3::ONE, DVec3::new(0.1, 0.2, -0.3)).unwrap();
        let estimate =
            Magnetization::first_order(&[RecoilTile { tile, permeability }], &IronPlanes::default(), 1, |_| {})
                .unwrap();
        assert_eq!(estimate.cells(), [tile]);
    }
}

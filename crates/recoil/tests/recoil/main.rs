//! Tiles with a recoil permeability: solutions and refinements against references and laws.

use magsplice_magnet::{Permeability, Tile};
use magsplice_recoil::RecoilTile;

/// Flat iron.
mod iron;
/// Values and their errors.
mod refinement;
/// Polarizations.
mod solutions;

fn magnet(size: [f64; 3], position: [f64; 3], polarization_t: [f64; 3], mu_r: f64) -> RecoilTile {
    let tile = Tile::new(position.into(), size.into(), polarization_t.into()).unwrap();
    RecoilTile { tile, permeability: Permeability::isotropic(mu_r).unwrap() }
}

//! The polarization of cells that agrees with their field.
//!
//! J_i = J_r,i + chi_i mu0 H_i with mu0 H_i = -sum of N_ij J_j. With J = J_r + V^(-1/2) chi^(1/2) x and
//! T = V^(1/2) N V^(-1/2) this is
//!
//! ```text
//! (1 + chi^(1/2) T chi^(1/2)) x = -chi^(1/2) T V^(1/2) J_r
//! ```
//!
//! T is symmetric with eigenvalues between 0 and 1, so that the matrix is symmetric with eigenvalues
//! between 1 and mu_r. Conjugate gradients converge within about 6 / log10((s + 1) / (s - 1)) iterations,
//! s = sqrt(mu_r), to 12 digits. Where mu_r is 1, x is 0 and J is J_r to the last bit.

use glam::{DMat3, DVec3};
use magsplice_magnet::Tile;

use crate::division::Division;
use crate::error::RecoilError;
use crate::magnetization::Magnetization;
use crate::material::RecoilTile;
use crate::pair_tensors::PairTensors;
use crate::tolerances::{MOST_ITERATIONS, RESIDUAL};

impl Magnetization {
    /// The self-consistent polarization of tiles, each divided into cells at a level.
    ///
    /// Time and memory are proportional to the square of the number of cells: 1.2 GB for
    /// [`crate::tolerances::MAX_CELLS`]. The result does not depend on the number of threads.
    /// `progress` is told, from any thread, once for each cell.
    ///
    /// # Accuracy
    /// The equations of the cells are solved to about [`crate::tolerances::TENSOR_ERROR`]. The division
    /// itself has larger errors: see [`crate::refine`].
    ///
    /// # Errors
    /// Level 0, tiles that overlap, too many cells, tiles turned against each other whose field does not
    /// converge.
    pub fn solve(tiles: &[RecoilTile], level: usize, progress: impl Fn() + Sync) -> Result<Magnetization, RecoilError> {
        let division = Division::new(tiles, level)?;
        let tensors = PairTensors::new(&division, progress)?;
        let of_tiles: Vec<DMat3> = tiles.iter().map(RecoilTile::root_of_susceptibility).collect();
        let roots: Vec<DMat3> = division.owners.iter().map(|owner| of_tiles[*owner]).collect();
        let rigid: Vec<DVec3> = division.cells.iter().map(Tile::scene_polarization_t).collect();
        let right: Vec<DVec3> = tensors
            .mean_fields_t(&rigid)
            .into_iter()
            .zip(&tensors.roots_of_volume)
            .zip(&roots)
            .map(|((h_t, root_of_volume), root)| *root * (h_t * *root_of_volume))
            .collect();
        let x = conjugate_gradients(&right, |x| {
            let inner: Vec<DVec3> = x.iter().zip(&roots).map(|(x, root)| *root * *x).collect();
            let sums = tensors.apply(&inner);
            x.iter().zip(&roots).zip(sums).map(|((x, root), sum)| *x + *root * sum).collect()
        })?;
        let induced = |i: usize| roots[i] * x[i] / tensors.roots_of_volume[i];
        let induced: Vec<DVec3> = (0..x.len()).map(induced).collect();
        let total: Vec<DVec3> = rigid.iter().zip(&induced).map(|(j, d)| *j + *d).collect();
        let fields_t = tensors.mean_fields_t(&total);
        Magnetization::new(tiles, division, &induced, fields_t)
    }
}

/// The solution of A x = b for a symmetric positive definite A.
fn conjugate_gradients(right: &[DVec3], matrix: impl Fn(&[DVec3]) -> Vec<DVec3>) -> Result<Vec<DVec3>, RecoilError> {
    let product = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a.dot(*b));
    let mut x = vec![DVec3::ZERO; right.len()];
    let (mut residual, mut direction) = (right.to_vec(), right.to_vec());
    let start = product(right, right);
    let mut square = start;
    for _ in 0..MOST_ITERATIONS {
        if square <= RESIDUAL * RESIDUAL * start {
            return Ok(x);
        }
        let image = matrix(&direction);
        let step = square / product(&direction, &image);
        for (i, x) in x.iter_mut().enumerate() {
            *x += step * direction[i];
            residual[i] -= step * image[i];
        }
        let next = product(&residual, &residual);
        let ratio = next / square;
        for (direction, residual) in direction.iter_mut().zip(&residual) {
            *direction = *residual + ratio * *direction;
        }
        square = next;
        if !square.is_finite() {
            break;
        }
    }
    Err(RecoilError::NotSolved { residual: (square / start).sqrt() })
}

#[cfg(test)]
mod peer_fields;
#[cfg(test)]
mod tests;

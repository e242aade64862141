//! The polarization of cells, consistent with their field.
//!
//! J_i = J_r,i + chi_i mu0 H_i with mu0 H_i = -sum of N_ij J_j. With J = J_r + V^(-1/2) chi^(1/2) x
//! and T = V^(1/2) N V^(-1/2) this is
//!
//! ```text
//! (1 + chi^(1/2) T chi^(1/2)) x = -chi^(1/2) T V^(1/2) J_r
//! ```
//!
//! T is symmetric with eigenvalues between 0 and 1, so the matrix is symmetric with eigenvalues
//! between 1 and mu_r. With planes of iron N has the images of the cells too. T keeps its
//! properties: a reflection maps a tensor to itself, and -J H integrates to mu0 mu_r H^2 over all
//! space. Conjugate gradients converge within about 6 / log10((s + 1) / (s - 1))
//! iterations, s = sqrt(mu_r), to 12 digits. Where mu_r is 1, x is 0 and J is J_r to the last bit.

use glam::{DMat3, DVec3};
use magsplice_magnet::IronPlanes;

use crate::division::Division;
use crate::error::RecoilError;
use crate::magnetization::Magnetization;
use crate::material::RecoilTile;
use crate::pair_sums::PairSums;
use crate::tolerances::MOST_ITERATIONS;

impl Magnetization {
    /// The self-consistent polarization of tiles before flat `iron`, each divided into cells at a
    /// level.
    ///
    /// Up to [`MOST_CELLS_OF_TENSORS`](crate::tolerances::MOST_CELLS_OF_TENSORS) cells, time and
    /// memory are proportional to the square of their number. In films with one, two or three
    /// mirror planes one cell represents two, four or eight. With more cells, time and memory are
    /// proportional to their number. The result does not depend on the number of threads.
    /// `progress` receives, from any thread, the number of cells that begin, and 0 when an
    /// iteration begins. A panic of `progress` ends the work and reaches the caller.
    ///
    /// # Accuracy
    /// The error of the equations, relative to the change of B outside by the permeability, is
    /// about [`TENSOR_ERROR`](magsplice_pair::tolerances::TENSOR_ERROR) for few cells and
    /// [`TREE_ERROR`](crate::tolerances::TREE_ERROR) for many. The division has larger errors: see
    /// [`crate::refine`].
    ///
    /// # Errors
    /// Level 0, overlapping tiles, too many cells or near pairs of cells, tiles turned against each
    /// other whose field does not converge, many cells with a permeability above
    /// [`MOST_PERMEABILITY_OF_TREE`](crate::tolerances::MOST_PERMEABILITY_OF_TREE).
    pub fn solve(
        tiles: &[RecoilTile],
        iron: &IronPlanes,
        level: usize,
        progress: impl Fn(usize) + Sync,
    ) -> Result<Magnetization, RecoilError> {
        let division = Division::new(tiles, iron, level)?;
        let sums = PairSums::new(tiles, &division, iron, level, &progress)?;
        Magnetization::from_sums(tiles, division, &sums, progress)
    }

    /// The polarization of cells from their tensors.
    fn from_sums(
        tiles: &[RecoilTile],
        division: Division,
        sums: &PairSums,
        progress: impl Fn(usize),
    ) -> Result<Magnetization, RecoilError> {
        let PairSums { orbits, roots_of_volume, .. } = sums;
        let of_tiles: Vec<DMat3> = tiles.iter().map(RecoilTile::root_of_susceptibility).collect();
        let cells = &orbits.representatives;
        let roots: Vec<DMat3> = cells.iter().map(|cell| of_tiles[division.owners[*cell]]).collect();
        let rigid: Vec<DVec3> = cells.iter().map(|cell| division.cells[*cell].scene_polarization_t()).collect();
        let right: Vec<DVec3> = sums
            .mean_fields_t(&rigid)
            .into_iter()
            .zip(roots_of_volume)
            .zip(&roots)
            .map(|((h_t, root_of_volume), root)| *root * (h_t * *root_of_volume))
            .collect();
        let x = conjugate_gradients(&right, sums.residual(), |x| {
            progress(0);
            let inner: Vec<DVec3> = x.iter().zip(&roots).map(|(x, root)| *root * *x).collect();
            let sums = sums.apply(&inner);
            x.iter().zip(&roots).zip(sums).map(|((x, root), sum)| *x + *root * sum).collect()
        })?;
        let induced = |i: usize| roots[i] * x[i] / roots_of_volume[i];
        let induced: Vec<DVec3> = (0..x.len()).map(induced).collect();
        let total: Vec<DVec3> = rigid.iter().zip(&induced).map(|(j, d)| *j + *d).collect();
        let fields_t = orbits.expand(&sums.mean_fields_t(&total));
        Magnetization::new(tiles, division, &orbits.expand(&induced), fields_t)
    }
}

/// The solution of A x = b for a symmetric positive definite A.
fn conjugate_gradients(
    right: &[DVec3],
    allowed: f64,
    matrix: impl Fn(&[DVec3]) -> Vec<DVec3>,
) -> Result<Vec<DVec3>, RecoilError> {
    let product = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a.dot(*b));
    let mut x = vec![DVec3::ZERO; right.len()];
    let (mut residual, mut direction) = (right.to_vec(), right.to_vec());
    let start = product(right, right);
    let mut square = start;
    for _ in 0..MOST_ITERATIONS {
        if square <= allowed * allowed * start {
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
mod tests;

//! The mean tensors of all pairs of cells.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::division::Division;
use crate::error::RecoilError;
use crate::symmetry::Orbits;

/// The tensors T_ij of all pairs of representatives of orbits; T_ji is the transpose of T_ij.
///
/// T_ij is the sum over all products g of mirrors of sqrt(V_i / V_j) N_ig(j) D_g, over sqrt(s_i
/// s_j), where N_ij has the images of j in planes of iron too, and s is the number of mirrors that
/// keep a cell in its place. D_g holds the signs of components of polarizations. Vectors are
/// vectors of cells times sqrt(o), with the orbit's size o.
pub(crate) struct PairTensors {
    /// Row i holds the representatives up to i.
    rows: Vec<Vec<DMat3>>,
}

impl PairTensors {
    /// The tensors of all pairs. `progress` receives, from any thread, the number of cells of an
    /// orbit when the pairs of its representative with all earlier representatives begin.
    pub(crate) fn new(
        division: &Division,
        orbits: &Orbits,
        progress: impl Fn(usize) + Sync,
    ) -> Result<PairTensors, RecoilError> {
        let cells = &division.cells;
        let stabilizers: Vec<f64> = orbits.representatives.iter().map(|cell| orbits.stabilizer(*cell) as f64).collect();
        let volume = |cell: usize| cells[cell].size().element_product();
        let row = |row: usize| {
            let i = orbits.representatives[row];
            let tensor = |column: usize| {
                let j = orbits.representatives[column];
                let mut sum = DMat3::ZERO;
                for (images, signs) in &orbits.images {
                    sum += division.mean_tensor(i, images[j])? * DMat3::from_diagonal(*signs);
                }
                Ok(sum * (volume(i) / (volume(j) * stabilizers[row] * stabilizers[column])).sqrt())
            };
            progress(orbits.images.len() / stabilizers[row] as usize);
            (0..=row).map(tensor).collect::<Result<Vec<_>, RecoilError>>()
        };
        let rows = (0..orbits.representatives.len()).into_par_iter().map(row).collect::<Result<Vec<_>, _>>()?;
        Ok(PairTensors { rows })
    }

    /// The sums of T_ij v_j over j, each in the order of the representatives.
    pub(crate) fn apply(&self, v: &[DVec3]) -> Vec<DVec3> {
        let sum = |i: usize| {
            let row = self.rows[i].iter().zip(v);
            let before = row.fold(DVec3::ZERO, |sum, (tensor, v)| sum + *tensor * *v);
            let after = self.rows[i + 1..].iter().zip(&v[i + 1..]);
            after.fold(before, |sum, (row, v)| sum + row[i].transpose() * *v)
        };
        (0..v.len()).into_par_iter().map(sum).collect()
    }
}

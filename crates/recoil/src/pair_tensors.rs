//! The mean tensors of all pairs of cells.

use glam::DVec3;
use rayon::prelude::*;

use crate::division::Division;
use crate::error::RecoilError;
use crate::interaction::mean_tensor;
use crate::symmetric_tensor::SymmetricTensor;

/// The tensors T_ij = sqrt(V_i / V_j) N_ij of all pairs, which are the same for i and j exchanged.
pub(crate) struct PairTensors {
    /// Row i holds the cells up to i.
    rows: Vec<Vec<SymmetricTensor>>,
    /// Roots of the volumes of the cells, relative to the largest.
    pub(crate) roots_of_volume: Vec<f64>,
}

impl PairTensors {
    /// The tensors of all pairs. `progress` is told, from any thread, when those of a cell with all
    /// before it are done.
    pub(crate) fn new(division: &Division, progress: impl Fn() + Sync) -> Result<PairTensors, RecoilError> {
        let cells = &division.cells;
        let largest = cells.iter().map(|cell| cell.size().element_product()).fold(f64::MIN_POSITIVE, f64::max);
        let roots_of_volume: Vec<f64> =
            cells.iter().map(|cell| (cell.size().element_product() / largest).sqrt()).collect();
        let row = |i: usize| {
            let tensor = |j: usize| {
                let tensor = mean_tensor(&cells[i], &cells[j]).map_err(|source| RecoilError::Turned {
                    receiver: division.owners[i],
                    source_tile: division.owners[j],
                    source,
                })?;
                Ok(tensor * (roots_of_volume[i] / roots_of_volume[j]))
            };
            let row = (0..=i).map(tensor).collect::<Result<Vec<_>, RecoilError>>();
            progress();
            row
        };
        let rows = (0..cells.len()).into_par_iter().map(row).collect::<Result<Vec<_>, _>>()?;
        Ok(PairTensors { rows, roots_of_volume })
    }

    /// The sums of T_ij v_j over j, each in the order of the cells.
    pub(crate) fn apply(&self, v: &[DVec3]) -> Vec<DVec3> {
        let sum = |i: usize| {
            let row = self.rows[i].iter().zip(v);
            let before = row.fold(DVec3::ZERO, |sum, (tensor, v)| sum + tensor.apply(*v));
            let after = self.rows[i + 1..].iter().zip(&v[i + 1..]);
            after.fold(before, |sum, (row, v)| sum + row[i].apply(*v))
        };
        (0..v.len()).into_par_iter().map(sum).collect()
    }

    /// The mean of mu0 H over each cell, in tesla, of these polarizations.
    pub(crate) fn mean_fields_t(&self, polarizations_t: &[DVec3]) -> Vec<DVec3> {
        let weighted: Vec<DVec3> =
            polarizations_t.iter().zip(&self.roots_of_volume).map(|(j, root)| *j * *root).collect();
        let sums = self.apply(&weighted);
        sums.into_iter().zip(&self.roots_of_volume).map(|(sum, root)| -sum / *root).collect()
    }
}

//! The sums of the mean tensors of all pairs of cells.

use glam::{DMat3, DVec3};
use magsplice_magnet::{IronPlanes, Tile};

use crate::division::Division;
use crate::error::RecoilError;
use crate::fast_sum::cell_sum::CellSum;
use crate::material::RecoilTile;
use crate::pair_tensors::PairTensors;
use crate::symmetry::Orbits;
use crate::tolerances::{MAX_CELLS, MOST_CELLS_OF_TENSORS, MOST_PERMEABILITY_OF_TREE, RESIDUAL, RESIDUAL_OF_TREE};

/// The matrix of the tensors T_ij of representatives of orbits ([`PairTensors`]). Without mirrors,
/// each cell is the only one of its orbit, and T_ij is sqrt(V_i / V_j) N_ij. N_ij has the images of
/// j in planes of iron too.
pub(crate) struct PairSums {
    method: Method,
    /// The cells with computed sums.
    pub(crate) orbits: Orbits,
    /// Roots of the volumes of orbits, relative to the largest cell.
    pub(crate) roots_of_volume: Vec<f64>,
}

/// Images of a cell in three mirror planes.
const MOST_IMAGES: usize = 8;

enum Method {
    /// The tensors of all pairs.
    Tensors(PairTensors),
    /// The tensors of near pairs, and expansions, of the cells and their images, with the matrices
    /// of the polarizations of images.
    Tree(Box<CellSum>, Vec<DMat3>),
}

impl PairSums {
    /// The tensors of all pairs of few cells, or the tree of many. `progress` receives, from any
    /// thread, the number of cells that begin.
    ///
    /// # Errors
    /// If tensors do not converge, if they do not fit in memory, or if a permeability multiplies
    /// the error of the tree too much.
    pub(crate) fn new(
        tiles: &[RecoilTile],
        division: &Division,
        iron: &IronPlanes,
        level: usize,
        progress: impl Fn(usize) + Sync,
    ) -> Result<PairSums, RecoilError> {
        let count = division.cells.len();
        let pairs = count * count * (1 + division.images.len());
        // With eight images the number of pairs is divided by eight.
        let takes_tensors = |images: usize| pairs <= images * MOST_CELLS_OF_TENSORS * MOST_CELLS_OF_TENSORS;
        if takes_tensors(MOST_IMAGES) {
            let orbits = Orbits::new(tiles, division, iron, level);
            if takes_tensors(orbits.images.len()) {
                return PairSums::by_tensors(division, orbits, progress);
            }
        }
        let largest = |each: &RecoilTile| each.permeability.along().max(each.permeability.across());
        let permeability = tiles.iter().map(largest).fold(1.0, f64::max);
        if permeability > MOST_PERMEABILITY_OF_TREE {
            return Err(RecoilError::TooPermeable { permeability, cells: count });
        }
        PairSums::by_tree(division, progress)
    }

    /// The tensors of all pairs.
    pub(crate) fn by_tensors(
        division: &Division,
        orbits: Orbits,
        progress: impl Fn(usize) + Sync,
    ) -> Result<PairSums, RecoilError> {
        let method = Method::Tensors(PairTensors::new(division, &orbits, progress)?);
        Ok(PairSums { method, roots_of_volume: roots_of_volume(division, &orbits), orbits })
    }

    /// The tensors of near pairs, and expansions.
    pub(crate) fn by_tree(division: &Division, progress: impl Fn(usize) + Sync) -> Result<PairSums, RecoilError> {
        let orbits = Orbits::trivial(division.cells.len());
        let roots_of_volume = roots_of_volume(division, &orbits);
        let all = division.with_images();
        if all.cells.len() > MAX_CELLS {
            return Err(RecoilError::TooManyCells { count: all.cells.len() });
        }
        let roots_of_all = roots_of_volume.repeat(1 + division.images.len());
        let images = division.images.iter().map(|(reflection, _)| reflection.of_polarization()).collect();
        let method = Method::Tree(Box::new(CellSum::new(&all, &roots_of_all, progress)?), images);
        Ok(PairSums { method, orbits, roots_of_volume })
    }

    /// The sums of T_ij v_j over j.
    pub(crate) fn apply(&self, v: &[DVec3]) -> Vec<DVec3> {
        match &self.method {
            Method::Tensors(tensors) => tensors.apply(v),
            Method::Tree(tree, images) => {
                let of_images = images.iter().flat_map(|image| v.iter().map(move |v| *image * *v));
                let all: Vec<DVec3> = v.iter().copied().chain(of_images).collect();
                let mut sums = tree.apply(&all);
                sums.truncate(v.len());
                sums
            }
        }
    }

    /// The mean of mu0 H over each representative, in tesla, for the polarizations of
    /// representatives.
    pub(crate) fn mean_fields_t(&self, polarizations_t: &[DVec3]) -> Vec<DVec3> {
        let weighted: Vec<DVec3> =
            polarizations_t.iter().zip(&self.roots_of_volume).map(|(j, root)| *j * *root).collect();
        let sums = self.apply(&weighted);
        sums.into_iter().zip(&self.roots_of_volume).map(|(sum, root)| -sum / *root).collect()
    }

    /// The residual of solutions of equations with this matrix.
    pub(crate) fn residual(&self) -> f64 {
        match self.method {
            Method::Tensors(_) => RESIDUAL,
            Method::Tree(..) => RESIDUAL_OF_TREE,
        }
    }
}

/// Roots of the volumes of orbits, relative to the largest cell.
fn roots_of_volume(division: &Division, orbits: &Orbits) -> Vec<f64> {
    let volume = |cell: &Tile| cell.size().element_product();
    let largest = division.cells.iter().map(volume).fold(f64::MIN_POSITIVE, f64::max);
    let of_orbit = |cell: &usize| {
        let count = orbits.images.len() / orbits.stabilizer(*cell);
        (volume(&division.cells[*cell]) / largest * count as f64).sqrt()
    };
    orbits.representatives.iter().map(of_orbit).collect()
}

//! The tree, its expansions and the tensors of near pairs.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;
use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::{DMat3, DVec3};
use magsplice_expansion::matrices::{COEFFICIENTS, Coefficients, MATRIX_DEGREE, Translation, coefficients};
use magsplice_expansion::moments::Moments;
use magsplice_expansion::source::CuboidSource;
use magsplice_magnet::Tile;
use magsplice_pair::SymmetricTensor;
use rayon::prelude::*;

use super::interactions::{Interactions, Offset};
use super::octree::{Node, Octree};
use super::tensor_cache::TensorCache;
use crate::division::Division;
use crate::error::RecoilError;
use crate::tolerances::MOST_BYTES;

/// Number of groups of receivers whose translations are sorted by their matrix. With fewer groups
/// each matrix is read from memory fewer times; more groups divide the work more evenly.
const RECEIVER_GROUPS: usize = 16;

/// Number of simultaneous translations by one matrix.
const TOGETHER: usize = 4;

/// Number of cells whose moments are computed at a time.
const CELLS_AT_ONCE: usize = 64;

/// The tensors T_ij = sqrt(V_i / V_j) N_ij of near pairs, and expansions in place of the tensors of
/// far pairs.
pub(crate) struct CellSum {
    tree: Octree,
    /// The moments of each cell for the three directions of its polarization, in the order of the
    /// tree.
    moments: Vec<[Coefficients; 3]>,
    /// The translations to all nodes.
    far: Vec<FarGroup>,
    matrices: Vec<Translation>,
    to_parent: Vec<Translation>,
    near: Vec<NearBlock>,
    /// The blocks of each leaf.
    blocks_of: Vec<Vec<usize>>,
}

/// The translations to a group of receivers.
struct FarGroup {
    receivers: Range<usize>,
    /// Matrix, source and receiver, in this order.
    pairs: Vec<[u32; 3]>,
}

impl FarGroup {
    /// Adds the local expansions from the moments of all nodes.
    #[inline(always)]
    fn translate<S: Simd>(
        &self,
        simd: S,
        matrices: &[Translation],
        moments: &[Coefficients],
        locals: &mut [Coefficients],
    ) {
        let mut add = |receiver: u32, product: &Coefficients| {
            let to = &mut locals[receiver as usize - self.receivers.start];
            to.iter_mut().zip(product).for_each(|(to, part)| *to += part);
        };
        for of_matrix in self.pairs.chunk_by(|[first, ..], [second, ..]| first == second) {
            let matrix = &matrices[of_matrix[0][0] as usize];
            let (several, rest) = of_matrix.as_chunks::<TOGETHER>();
            for pairs in several {
                let products = matrix.products(simd, pairs.each_ref().map(|[_, source, _]| &moments[*source as usize]));
                pairs.iter().zip(&products).for_each(|([.., receiver], product)| add(*receiver, product));
            }
            for [_, source, receiver] in rest {
                let [product] = matrix.products(simd, [&moments[*source as usize]]);
                add(*receiver, &product);
            }
        }
    }
}

/// The tensors of the cells of two leaves.
struct NearBlock {
    leaves: [usize; 2],
    /// Row after row, one row for each cell of the first leaf.
    tensors: Vec<SymmetricTensor>,
}

impl CellSum {
    /// The tree and all tensors.
    pub(crate) fn new(
        division: &Division,
        roots_of_volume: &[f64],
        progress: impl Fn(usize) + Sync,
    ) -> Result<CellSum, RecoilError> {
        let cells = &division.cells;
        let tree = Octree::new(cells);
        let Interactions { far, near } = Interactions::new(&tree);
        let bytes = bytes(&tree, &far, &near);
        if bytes > MOST_BYTES {
            return Err(RecoilError::TooManyNearPairs { count: cells.len(), bytes });
        }
        let (far, matrices) = far_groups(&tree, &far);
        let moments = moments(&tree, cells);
        let to_parent = (0..8).map(|octant| Translation::to_parent(shift_of(octant))).collect();
        let block = |cache: &mut TensorCache, leaves: &[usize; 2]| {
            let [rows, columns] = leaves.map(|leaf| &tree.order[tree.nodes[leaf].cells.clone()]);
            let is_own = leaves[0] == leaves[1];
            // Each cell is in one leaf.
            progress(if is_own { rows.len() } else { 0 });
            let mut tensors: Vec<SymmetricTensor> = Vec::with_capacity(rows.len() * columns.len());
            for (row, &i) in rows.iter().enumerate() {
                for (column, &j) in columns.iter().enumerate() {
                    // Tensors within a leaf are bit-identical for i and j exchanged.
                    if is_own && column < row {
                        tensors.push(tensors[column * columns.len() + row]);
                        continue;
                    }
                    let tensor =
                        cache.mean_tensor(&cells[i], &cells[j]).map_err(|error| division.turned(i, j, error))?;
                    tensors.push(tensor * (roots_of_volume[i] / roots_of_volume[j]));
                }
            }
            Ok(NearBlock { leaves: *leaves, tensors })
        };
        let cache = || TensorCache::new(tree.side(0));
        let near = near.par_iter().map_init(cache, block).collect::<Result<Vec<_>, RecoilError>>()?;
        let mut blocks_of = vec![Vec::new(); tree.nodes.len()];
        for (index, block) in near.iter().enumerate() {
            let [a, b] = block.leaves;
            blocks_of[a].push(index);
            if a != b {
                blocks_of[b].push(index);
            }
        }
        Ok(CellSum { tree, moments, far, matrices, to_parent, near, blocks_of })
    }

    /// The sums of T_ij v_j over j. They do not depend on the number of threads.
    pub(crate) fn apply(&self, v: &[DVec3]) -> Vec<DVec3> {
        let nodes = &self.tree.nodes;
        let level = Level::new();
        let sorted: Vec<DVec3> = self.tree.order.iter().map(|index| v[*index]).collect();
        let moment_of_leaf = |node: usize| {
            let mut sum = [0.0; COEFFICIENTS];
            for cell in nodes[node].cells.clone().filter(|_| self.tree.is_leaf(node)) {
                for (moments, factor) in self.moments[cell].iter().zip(sorted[cell].to_array()) {
                    sum.iter_mut().zip(moments).for_each(|(sum, moment)| *sum += moment * factor);
                }
            }
            sum
        };
        let mut moments: Vec<Coefficients> = (0..nodes.len()).into_par_iter().map(moment_of_leaf).collect();
        for parent in (0..nodes.len()).rev() {
            for child in nodes[parent].children.clone() {
                let from = moments[child];
                let matrix = &self.to_parent[self.octant(child)];
                let [product] = dispatch!(level, simd => matrix.products(simd, [&from]));
                moments[parent].iter_mut().zip(product).for_each(|(sum, part)| *sum += part);
            }
        }
        let group = |group: &FarGroup| {
            let mut locals = vec![[0.0; COEFFICIENTS]; group.receivers.len()];
            dispatch!(level, simd => group.translate(simd, &self.matrices, &moments, &mut locals));
            for (node, local) in group.receivers.clone().zip(&mut locals) {
                let factor = 1.0 / (4.0 * PI * self.tree.side(nodes[node].level));
                local.iter_mut().for_each(|part| *part *= factor);
            }
            locals
        };
        let mut locals: Vec<Coefficients> = self.far.par_iter().flat_map_iter(group).collect();
        for parent in 0..nodes.len() {
            let from = locals[parent];
            for child in nodes[parent].children.clone() {
                self.to_parent[self.octant(child)].add_transposed_product(&from, &mut locals[child]);
            }
        }
        let leaves: Vec<usize> = (0..nodes.len()).filter(|node| self.tree.is_leaf(*node)).collect();
        let sums = leaves.par_iter().map(|leaf| self.sums_of_leaf(*leaf, &sorted, &locals[*leaf]));
        let sums: Vec<Vec<DVec3>> = sums.collect();
        let mut all = vec![DVec3::ZERO; v.len()];
        for (leaf, sums) in leaves.iter().zip(sums) {
            for (cell, sum) in nodes[*leaf].cells.clone().zip(sums) {
                all[self.tree.order[cell]] = sum;
            }
        }
        all
    }

    /// The sums of the cells of a leaf.
    fn sums_of_leaf(&self, leaf: usize, v: &[DVec3], local: &Coefficients) -> Vec<DVec3> {
        let own = self.tree.nodes[leaf].cells.clone();
        let mut sums: Vec<DVec3> = self.moments[own]
            .iter()
            .map(|moments| {
                DVec3::from_array(moments.each_ref().map(|m| m.iter().zip(local).map(|(m, local)| m * local).sum()))
            })
            .collect();
        for index in &self.blocks_of[leaf] {
            let NearBlock { leaves, tensors } = &self.near[*index];
            let [rows, columns] = leaves.map(|leaf| &v[self.tree.nodes[leaf].cells.clone()]);
            if leaves[0] == leaf {
                for (sum, row) in sums.iter_mut().zip(tensors.chunks(columns.len())) {
                    *sum = row.iter().zip(columns).fold(*sum, |sum, (tensor, v)| sum + tensor.apply(*v));
                }
            } else {
                for (row, v) in tensors.chunks(columns.len()).zip(rows) {
                    sums.iter_mut().zip(row).for_each(|(sum, tensor)| *sum += tensor.apply(*v));
                }
            }
        }
        sums
    }

    /// The octant of a node within its parent.
    fn octant(&self, node: usize) -> usize {
        let bits = self.tree.nodes[node].place & 1;
        (bits.x + 2 * bits.y + 4 * bits.z) as usize
    }
}

/// Memory of the moments, translations and tensors.
fn bytes(tree: &Octree, far: &[[usize; 2]], near: &[[usize; 2]]) -> usize {
    let cells = |leaf: usize| tree.nodes[leaf].cells.len();
    let tensors: usize = near.iter().map(|[a, b]| cells(*a) * cells(*b)).sum();
    let offsets: BTreeSet<Offset> =
        far.iter().flat_map(|[a, b]| [Offset::new(tree, *a, *b), Offset::new(tree, *b, *a)]).collect();
    tree.order.len() * size_of::<[Coefficients; 3]>()
        + 2 * far.len() * size_of::<[u32; 3]>()
        + offsets.len() * COEFFICIENTS * size_of::<Coefficients>()
        + tensors * size_of::<SymmetricTensor>()
}

/// Vector from the centre of a cube to the centre of one of its octants, in sides.
fn shift_of(octant: usize) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|axis: usize| if octant >> axis & 1 == 1 { 0.25 } else { -0.25 }))
}

/// The translations to all nodes, and their matrices.
fn far_groups(tree: &Octree, far: &[[usize; 2]]) -> (Vec<FarGroup>, Vec<Translation>) {
    let mut of_offset: BTreeMap<Offset, u32> = BTreeMap::new();
    let mut matrices = Vec::new();
    let count = tree.nodes.len();
    let together = count.div_ceil(RECEIVER_GROUPS);
    let starts = (0..count).step_by(together);
    let mut groups: Vec<FarGroup> =
        starts.map(|start| FarGroup { receivers: start..(start + together).min(count), pairs: Vec::new() }).collect();
    for [a, b] in far {
        for [receiver, source] in [[*a, *b], [*b, *a]] {
            let offset = Offset::new(tree, receiver, source);
            let matrix = *of_offset.entry(offset).or_insert_with(|| {
                let ratio = 0.5_f64.powi(offset.levels);
                let half = 0.5 * ratio.min(1.0);
                let halves = DVec3::from_array(offset.halves.map(|half| half as f64));
                matrices.push(Translation::to_local(half * halves, ratio));
                matrices.len() as u32 - 1
            });
            groups[receiver / together].pairs.push([matrix, source as u32, receiver as u32]);
        }
    }
    groups.par_iter_mut().for_each(|group| group.pairs.sort_unstable());
    (groups, matrices)
}

/// The moments of each cell for each direction of its polarization: the means over the cell of the
/// gradients of the harmonics times the root of its volume, in sides of its leaf.
fn moments(tree: &Octree, cells: &[Tile]) -> Vec<[Coefficients; 3]> {
    let mut sources = Vec::with_capacity(3 * cells.len());
    let mut leaves: Vec<&Node> = tree.nodes.iter().filter(|node| node.children.is_empty()).collect();
    leaves.sort_by_key(|leaf| leaf.cells.start);
    for leaf in leaves {
        let (centre, side) = (tree.centre(leaf), tree.side(leaf.level));
        for cell in tree.order[leaf.cells.clone()].iter().map(|index| &cells[*index]) {
            let (at, rotation) = ((cell.position() - centre) / side, DMat3::from_quat(cell.rotation()));
            // Moments are 1 / 4 pi of integrals over the volume.
            let strength = 4.0 * PI * side * side / cell.size().element_product().sqrt();
            let source = |axis: DVec3| CuboidSource::new(at, cell.size() / side, Some(&rotation), strength * axis);
            sources.extend(DVec3::AXES.map(source));
        }
    }
    let level = Level::new();
    let of_cells = |sources: &[CuboidSource]| {
        let groups: Vec<&[CuboidSource]> = sources.chunks(1).collect();
        let moments = Moments::from_groups(level, &groups, MATRIX_DEGREE);
        moments.chunks(3).map(|axes| [0, 1, 2].map(|axis: usize| coefficients(&axes[axis]))).collect::<Vec<_>>()
    };
    sources.par_chunks(3 * CELLS_AT_ONCE).flat_map_iter(of_cells).collect()
}

#[cfg(test)]
mod tests {
    use magsplice_magnet::{IronPlanes, Permeability, Tile};

    use super::*;
    use crate::material::RecoilTile;

    /// The memory counted before the work is the memory of what is kept. One group of cells is far
    /// from the other, and each has several leaves.
    #[test]
    fn memory_is_the_size_of_moments_translations_and_tensors() {
        let tile = |x: f64| RecoilTile {
            tile: Tile::new(DVec3::X * x, DVec3::new(3.0, 2.0, 1.0), DVec3::Z).unwrap(),
            permeability: Permeability::isotropic(1.2).unwrap(),
        };
        let division = Division::new(&[tile(0.0), tile(9.0)], &IronPlanes::default(), 7).unwrap();
        let kept = CellSum::new(&division, &vec![1.0; division.cells.len()], |_| {}).unwrap();
        let Interactions { far, near } = Interactions::new(&kept.tree);
        let [moments, translations] = [size_of_val(&kept.moments[..]), kept.matrices.len()];
        let pairs: usize = kept.far.iter().map(|group| size_of_val(&group.pairs[..])).sum();
        let tensors: usize = kept.near.iter().map(|block| size_of_val(&block.tensors[..])).sum();
        let matrices = translations * COEFFICIENTS * size_of::<Coefficients>();
        assert!(pairs > 0 && tensors > 0 && matrices > 0);
        assert_eq!(bytes(&kept.tree, &far, &near), moments + pairs + matrices + tensors);
    }
}

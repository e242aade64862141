//! The sums of the mean tensors of all pairs of cells, in time proportional to the number of cells.
//!
//! Near pairs have their tensors. Far pairs interact by multipole expansions of the cells of whole
//! nodes of an octree: Greengard and Rokhlin, A fast algorithm for particle simulations, J. Comput.
//! Phys. 73, 325 (1987). Moments of a cell are exact means over its volume, and the mean of a local
//! expansion over a cell is the transpose of them, so that the matrix is symmetric to round-off.

/// The tree, its expansions and the tensors of near pairs.
pub(crate) mod cell_sum;
/// Pairs of nodes that interact by expansions, and pairs of leaves whose cells have tensors.
mod interactions;
/// Cells in cubes that are halved.
mod octree;
/// Tensors of pairs of cells of which most have been met before.
mod tensor_cache;

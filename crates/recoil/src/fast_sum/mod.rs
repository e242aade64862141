//! The sums of the mean tensors of all pairs of cells, in time proportional to the number of cells.
//!
//! Near pairs use their tensors. Far pairs interact by multipole expansions of the cells of whole
//! nodes of an octree: Greengard and Rokhlin, A fast algorithm for particle simulations, J. Comput.
//! Phys. 73, 325 (1987). Moments of a cell are exact means over its volume, and their transpose
//! gives the mean of a local expansion over the cell, so the matrix is symmetric to round-off.

/// The tree, its expansions and the tensors of near pairs.
pub(crate) mod cell_sum;
/// Pairs of nodes that interact by expansions, and pairs of leaves whose cells have tensors.
mod interactions;
/// Cells in an octree of cubes.
mod octree;
/// A cache of tensors of pairs of cells.
mod tensor_cache;

//! Fast summation to a tolerance: a tree over all tiles, interaction lists, and truncation errors
//! (docs/physics.md, section 5.2).
//!
//! The scheme follows Dehnen, A fast multipole method for stellar dynamics, Comput. Astrophys. 1, 1
//! (2014): expansions about the nodes of a binary tree, with the degree chosen per node and batch
//! of points from a bound of the truncation error.

/// The contents of a tree: blocks in the frame of the scene, and items.
mod blocks;
/// Building of a tree by bisection.
mod build;
/// Interactions of nodes with points: multipole, local, direct, ignored.
pub(crate) mod interaction;
/// The interaction list of a batch of points.
pub(crate) mod interaction_list;
/// A tree built when first needed.
pub(crate) mod lazy_tree;
/// Moments and expansions of the nodes.
mod node_moments;
/// The tree, its nodes, and bounds of their fields.
pub(crate) mod nodes;
/// Rounds of evaluation until every point keeps the tolerance.
pub(crate) mod rounds;
/// The field of an interaction list.
mod sum;
/// Truncation errors, and the degrees that keep an allowed error.
mod truncation;

#[cfg(test)]
mod tests;

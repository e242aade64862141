//! Fast summation to a tolerance: a tree over all tiles, interaction lists, and truncation errors
//! (docs/physics.md, section 5.2).
//!
//! The scheme is that of Dehnen, A fast multipole method for stellar dynamics, Comput. Astrophys. 1, 1
//! (2014): expansions about the nodes of a binary tree, with the degree chosen per node and batch of
//! points from a bound of the truncation error.

/// How a node acts on points.
pub(crate) mod interaction;
/// The interaction list of a batch of points.
pub(crate) mod interaction_list;
/// A tree that is built when it is first needed.
pub(crate) mod lazy_tree;
/// The nodes of the tree, their moments and expansions.
pub(crate) mod nodes;
/// Rounds of evaluation until every point keeps the tolerance.
pub(crate) mod rounds;
/// The field of an interaction list.
mod sum;
/// The degree of an expansion that keeps a truncation error.
mod truncation;

#[cfg(test)]
mod tests;

//! Two uniformly magnetized cuboids: the mean field of one in the other, force and torque.
//!
//! * [`mean_tensor`]: the mean over one tile of the field of another, a [`SymmetricTensor`].
//! * [`pair_loads`]: forces and torques of two tiles, a [`Load`] on each.
//!
//! Both choose the method by the positions of the tiles. With parallel edges they sum functions of
//! the 64 differences of corners, or far away dipoles at the nodes of Gauss rules. For tiles turned
//! against each other they integrate with Gauss-Legendre rules on successively divided parts.
//!
//! The magnetization is fixed: the field of the other tile does not change it.
//!
//! # Units
//! Polarization in tesla. Lengths are in any one unit; with lengths in metres, forces are in
//! newtons and torques in newton metres. See [`Load`] for other units of length.
//!
//! # Features
//! `serde` (off by default): `Serialize` for results.

// Rules are written as `!(x <= limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// Two cuboids with parallel edges, in the frame of their edges.
mod aligned_pair;
/// Mean tensor, force and torque of two cuboids with parallel edges, in closed form.
mod closed_form;
/// The functions of the distance of two corners whose sums are tensors, forces and torques.
mod corner;
/// Mean tensor, force and torque of two distant cuboids with parallel edges.
mod distant;
/// Numbers of about 32 digits.
mod double_double;
/// Logarithm and arctangent of about 31 digits.
mod functions;
/// Gauss rules.
mod gauss;
/// Force and torque on a tile.
mod load;
/// An integral over turned cuboids that does not converge.
mod not_converged;
/// The choice of method for two tiles.
mod pair;
/// The number types of the functions of corners.
mod real;
/// Tables of `tests/reference`.
#[cfg(test)]
#[path = "../tests/pair/reference.rs"]
mod reference;
/// Symmetric tensors of the second rank.
mod symmetric_tensor;
/// Tolerances and tuning constants.
pub mod tolerances;
/// Mean tensor, force and torque of two cuboids turned against each other.
mod turned;

pub use load::Load;
pub use not_converged::{NotConverged, PairIntegral};
pub use pair::{load_in_f64, mean_tensor, mean_tensor_of_boxes, mean_tensor_within, pair_loads};
pub use symmetric_tensor::SymmetricTensor;

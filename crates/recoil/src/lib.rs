//! Self-consistent magnetization of cuboid tiles with a linear recoil line.
//!
//! The polarization of a tile is J = J_r + chi mu0 H, chi = mu_r - 1, where H is the field of all tiles,
//! its own demagnetizing field included.
//!
//! * [`mean_tensor`]: the mean over one tile of the field of another.
//!
//! # Units
//! Lengths are in any one unit, polarizations in tesla. This crate reads no files and prints nothing.

// Rules are written as `!(x <= limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// The mean tensor of two boxes in closed form.
mod corner_sum;
/// The mean tensor of two distant boxes.
mod distant;
/// The mean tensor of two tiles.
mod interaction;
/// Symmetric tensors of the second rank.
mod symmetric_tensor;
/// Tolerances and tuning constants.
pub mod tolerances;
/// The mean tensor of two boxes that are turned against each other.
mod turned;

pub use interaction::mean_tensor;
pub use symmetric_tensor::SymmetricTensor;
pub use turned::TurnedNotConverged;

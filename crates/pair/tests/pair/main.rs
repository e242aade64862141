//! Mean tensors, forces and torques of two cuboids against references and laws.

/// Forces and torques.
mod loads;
/// Tables of `tests/reference`.
mod reference;
/// Mean tensors.
mod tensors;

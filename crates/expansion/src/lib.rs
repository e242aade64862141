//! Fields of many cuboids as expansions in solid harmonics.
//!
//! * [`moments`]: moments of sources (P2M), moved and added (M2M).
//! * [`multipole`]: the field outside a sphere around the sources (M2P).
//! * [`m2l`]: multipole expansions translated to local ones (M2L).
//! * [`local`]: the field around a point away from the sources (L2P).
//!
//! Equations are those of docs/physics.md, sections 2.8 and 5.2; the operators' names are those of
//! Greengard and Rokhlin, A fast algorithm for particle simulations, J. Comput. Phys. 73, 325 (1987).
//!
//! # Units
//! Lengths are scaled by a power of two that the caller chooses; polarization and mu0 H in tesla.

#![allow(missing_docs)]

/// The field around a point away from the sources (L2P).
pub mod local;
/// Multipole expansions translated to local ones (M2L).
pub mod m2l;
/// Moments of sources (P2M), moved and added (M2M).
pub mod moments;
/// The field outside a sphere around the sources (M2P).
pub mod multipole;
/// Sums over degrees and orders, shared by multipole and local expansions.
mod rows;
/// A cuboid as a source of an expansion.
pub mod source;
/// Tuning constants.
pub mod tolerances;
/// Complex numbers by degree and order, and their recurrences.
pub mod triangle;

#[cfg(test)]
mod tests;

//! Fields of many cuboids as expansions in solid harmonics.
//!
//! * [`moments`]: moments of sources (P2M), translated and added (M2M).
//! * [`multipole`]: the field outside a sphere around the sources (M2P).
//! * [`m2l`]: multipole expansions translated to local ones (M2L).
//! * [`matrices`]: translations of one low degree as matrices (M2M, M2L, L2L).
//! * [`local`]: the field around a point away from the sources (L2P).
//!
//! The equations are in docs/physics.md, sections 2.8 and 5.2. The operators are named as by
//! Greengard and Rokhlin, A fast algorithm for particle simulations, J. Comput. Phys. 73, 325
//! (1987).
//!
//! # Units
//! The caller scales lengths by a power of two. Polarization and mu0 H are in tesla.

/// The field around a point away from the sources (L2P).
pub mod local;
/// Multipole expansions translated to local ones (M2L).
pub mod m2l;
/// Constant factors of the M2L operator.
mod m2l_factors;
/// Translations of expansions of one low degree as matrices (M2M, M2L, L2L).
pub mod matrices;
/// Moments of sources (P2M), translated and added (M2M).
pub mod moments;
/// The field outside a sphere around the sources (M2P).
pub mod multipole;
/// Sums over degrees and orders, shared by multipole and local expansions.
mod rows;
/// A cuboid as a source of an expansion.
pub mod source;
/// Tuning constants.
pub mod tolerances;
/// Complex coefficients by degree and order, and the recurrences of solid harmonics.
pub mod triangle;

#[cfg(test)]
mod tests;

//! Force and torque of uniformly magnetized cuboids on each other.
//!
//! * [`pair_loads`]: forces and torques of two tiles.
//! * [`FilmForces`]: those of all pairs of the tiles of a film.
//! * [`LayingOrder`]: an order in which tiles are laid, and the force on each while it is being
//!   laid.
//! * [`LeastHolding`]: the order with the least of these forces, with a bound that none is below.
//!
//! The magnetization is as given: a tile is not magnetized by the field of the others. Tiles of
//! NdFeB have a recoil permeability of 1.05 or so, which changes forces by a few percent.
//! [`FilmForces::of_cells`] takes the cells of tiles whose polarization follows the field, which
//! `magsplice-recoil` computes.
//!
//! # Units
//! Polarization in tesla. With lengths in metres, forces are in newtons and torques in newton
//! metres; see [`Load`] for other units of length. This crate reads no files and prints nothing.
//!
//! # Features
//! `serde` (off by default): `Serialize` for results.

// Rules are written as `!(x <= limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// Two cuboids with parallel edges, in the frame of their edges.
mod aligned_pair;
/// Force and torque of two cuboids with parallel edges, in closed form.
mod closed_form;
/// The functions of the distance of two corners whose sums are forces and torques.
mod corner;
/// Force and torque of two distant cuboids with parallel edges.
mod distant;
/// Numbers of about 32 digits.
mod double_double;
/// Forces on all tiles of a film.
mod film_forces;
/// Logarithms and arctangents of 60 digits.
#[cfg(test)]
mod function_values;
/// Logarithm and arctangent of about 31 digits.
mod functions;
/// Orders in which the tiles of a film are laid.
mod laying_order;
/// Force and torque on a tile.
mod load;
/// A bound of the holding that no order of laying is below.
mod order_bound;
/// The order of laying with the least holding.
mod order_search;
/// Force and torque of two tiles.
mod pair;
/// The two kinds of numbers in which the closed form is evaluated.
mod real;
/// Force and torque of two cuboids that are turned against each other.
mod turned;

pub use film_forces::{FilmForces, FilmForcesError};
pub use laying_order::{LayingOrder, OrderError};
pub use load::Load;
pub use order_search::{LeastHolding, OrderSettings};
pub use pair::pair_loads;
pub use turned::NotConverged;

//! Force and torque of the tiles of a film on each other.
//!
//! * [`FilmForces`]: the loads of all pairs of tiles.
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

/// Forces on all tiles of a film.
mod film_forces;
/// Orders in which the tiles of a film are laid.
mod laying_order;
/// A bound of the holding that no order of laying is below.
mod order_bound;
/// The order of laying with the least holding.
mod order_search;
pub use film_forces::{FilmForces, FilmForcesError};
pub use laying_order::{LayingOrder, OrderError};
pub use magsplice_pair::{Load, NotConverged};
pub use order_search::{LeastHolding, OrderSettings};

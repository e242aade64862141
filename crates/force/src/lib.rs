//! Force and torque of the tiles of a film on each other.
//!
//! * [`FilmForces`]: the loads of all pairs of tiles.
//! * [`PlacementOrder`]: a placement order of tiles, and the force on each during its placement.
//! * [`LeastHolding`]: the order with the smallest of these forces, with a lower bound for all
//!   orders.
//!
//! The magnetization is fixed: fields of other tiles do not change it. NdFeB tiles have a recoil
//! permeability of about 1.05, which changes forces by a few percent. [`FilmForces::of_cells`]
//! takes the cells of tiles whose polarization follows the field, computed by `magsplice-recoil`.
//!
//! # Units
//! Polarization in tesla. With lengths in metres, forces are in newtons and torques in newton
//! metres; see [`Load`] for other units of length. This crate reads no files and prints nothing.
//!
//! # Features
//! `serde` (off by default): `Serialize` for results.

/// Forces on all tiles of a film.
mod film_forces;
/// A lower bound of the holding force of all placement orders.
mod order_bound;
/// The placement order with the smallest holding force.
mod order_search;
/// Placement orders of the tiles of a film.
mod placement_order;
pub use film_forces::{FilmForces, FilmForcesError};
pub use magsplice_pair::{Load, NotConverged};
pub use order_search::{LeastHolding, OrderSettings};
pub use placement_order::{OrderError, PlacementOrder};

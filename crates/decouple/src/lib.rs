//! Self-decoupling: three parameters of the flux density that each follow one coordinate, and how far a film is from that.
//!
//! * [`Parameters`]: R_x, R_y, S_z of a field value, and displacement from their change (Dai 2024, Eqs. 14 and 15).
//! * [`Decoupling`]: their errors over a working volume.
//!
//! Flux densities in tesla; lengths in any one unit. This crate computes no field, reads no files and prints nothing.
//!
//! ```
//! use glam::DVec3;
//! use magsplice_decouple::{Branch, Parameters};
//! use magsplice_field::IdealFilm;
//!
//! let film = IdealFilm::new(10.0, 1.0, 0.12).unwrap(); // millimetres and tesla
//! let on_axis = film.flux_density_t(DVec3::new(0.0, 0.0, -5.0)).unwrap();
//! let sheared = film.flux_density_t(DVec3::new(1.5, 0.0, -5.0)).unwrap();
//! let branch = Branch::from_axis_field(on_axis).unwrap();
//! let before = Parameters::of(on_axis, branch).unwrap();
//! let after = Parameters::of(sheared, branch).unwrap();
//! let moved = after.displacement_from(&before, film.wavenumber());
//! assert!((moved - DVec3::new(1.5, 0.0, 0.0)).length() < 1e-12);
//! ```

// Rules are written as `!(x > limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod decoupling;
mod parameters;

pub use decoupling::{Decoupling, DecouplingError, OverPlane, PerParameter};
pub use parameters::{Branch, ParameterSlopes, Parameters};

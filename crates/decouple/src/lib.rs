//! Self-decoupling of magnetic films: three parameters of the flux density, each of which depends
//! on one coordinate.
//!
//! * [`Parameters`]: R_x, R_y, S_z of a field value, and displacement from their change (Dai 2024,
//!   Eqs. 13 to 15).
//! * [`Decoupling`]: the parameters over a working volume, and their errors.
//! * [`Figures`]: the errors of a film over its working volume, and its amplitude.
//! * [`uniformity_by_planes`]: the uniformity of parameters at points on planes.
//! * [`PointDecoupling`]: the parameters at given points, and their errors.
//!
//! Flux densities in tesla; lengths in any one unit. This crate computes no field, reads no files
//! and prints nothing.
//!
//! # Features
//! `serde` (off by default): `Serialize` for values and results, `Deserialize` for values.
//!
//! # Example
//! ```
//! use glam::DVec3;
//! use magsplice_decouple::{Branch, Parameters};
//! use magsplice_ideal::IdealFilm;
//!
//! let film = IdealFilm::new(10.0, 1.0, 0.12).unwrap(); // millimetres and tesla
//! let on_axis = film.flux_density_t(DVec3::new(0.0, 0.0, -5.0)).unwrap();
//! let sheared = film.flux_density_t(DVec3::new(1.5, 0.0, -5.0)).unwrap();
//! let branch = Branch::from_axis_field(on_axis).unwrap();
//! let before = Parameters::from_field(on_axis, branch).unwrap();
//! let after = Parameters::from_field(sheared, branch).unwrap();
//! let moved = after.displacement_from(&before, film.wavenumber());
//! assert!((moved - DVec3::new(1.5, 0.0, 0.0)).length() < 1e-12);
//! ```
//!
//! # Reference
//! Dai et al., "A Magnet Splicing Method for Constructing a Three-Dimensional Self-Decoupled
//! Magnetic Tactile Sensor", Magnetochemistry 2024, 10(1), 6.

// Rules are written as `!(x > limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// The parameters at given points, and their errors.
mod at_points;
/// The uniformity of parameters at points on planes.
mod by_planes;
/// The parameters over a working volume, and their errors.
mod decoupling;
/// Seven measures of a film's decoupling.
mod figures;
/// The error of a parameter's change against the ideal film.
mod ideal_error;
/// The parameters of one field value, and displacement from their change.
mod parameters;
/// One value for each axis.
mod per_axis;
/// One value for each parameter.
mod per_parameter;
/// Displacements that the parameters show, minus the true ones.
mod residuals;
/// Second derivatives of the parameters.
mod second_derivatives;

pub use at_points::PointDecoupling;
pub use by_planes::{NoPlanes, uniformity_by_planes};
pub use decoupling::{Decoupling, DecouplingError, PlaneStatistics};
pub use figures::{Figure, Figures};
pub use parameters::{Branch, ParameterDerivatives, Parameters};
pub use per_axis::PerAxis;
pub use per_parameter::{Parameter, PerParameter};
pub use residuals::PlaneResidual;
pub use second_derivatives::ParameterSecondDerivatives;

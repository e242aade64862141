//! The position of a Hall sensor below magnets, from its reading of the flux density.
//!
//! * [`SensedField`]: the readings of a Hall sensor, averaged over its plates.
//! * [`Locator`]: positions from readings, by the exact field and its gradient.
//! * [`HeadLocator`]: positions and stray fields from all readings of a head.
//! * [`experiment()`]: readings and positions of a moving film.
//! * [`Stiffness`]: the force of an elastic layer from displacements.
//! * [`DisplacementPolynomial`]: positions without the tiles, for small computers.
//! * [`Noise`]: standard deviations of positions from standard deviations of readings.
//!
//! The equations are in docs/physics.md, section 8.
//!
//! Flux densities are in tesla, lengths in any one unit, the unit of the tiles. This crate reads no
//! files and prints nothing.
//!
//! # Features
//! `serde` (off by default): `Serialize` for results and values, `Deserialize` for values.
//!
//! # Example
//! ```
//! use glam::DVec3;
//! use magsplice_field::Scene;
//! use magsplice_magnet::{Grid, Quantity, Tile};
//! use magsplice_sensor::Locator;
//!
//! let tile = Tile::new(DVec3::ZERO, DVec3::new(3.0, 3.0, 1.0), DVec3::new(0.0, 0.0, 0.12))?;
//! let scene = Scene::new(&[tile]);
//! let volume = Grid::new(DVec3::new(-2.0, -2.0, -5.0), DVec3::new(2.0, 2.0, -3.0), [9, 9, 5])?;
//! let locator = Locator::new(&scene, volume)?;
//! let place = DVec3::new(0.7, -1.2, -3.9);
//! let reading_t = scene.field(Quantity::FluxDensity, place).unwrap();
//! let found = locator.locate(&[reading_t]).remove(0)?;
//! assert!((found.position - place).length() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// Rules are written as `!(x > limit)` so that NaN breaks them.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

/// Gauss-Newton steps for many readings at once.
mod descent;
/// Readings of a sensor below a moving film.
mod experiment;
/// What the readings of all sensors of a head tell.
mod head_fit;
/// Positions from the readings of all sensors of a head.
mod head_locator;
/// Positions from readings.
mod locator;
/// Standard deviations of positions.
mod noise;
/// The normal equations of the fit of a head.
mod normal_equations;
/// Positions as polynomials of the parameters.
mod polynomial;
/// The mean of readings at rest.
mod rest;
/// The readings of a sensor in a field.
mod sensed_field;
/// Starting points of the search.
mod starts;
/// Forces from displacements.
mod stiffness;

pub use experiment::{ExperimentSettings, ExperimentStep, displacements, experiment};
pub use head_fit::{HeadFit, HeadResolution, HeadUnknowns};
pub use head_locator::{HeadLocator, HeadLocatorError};
pub use locator::{LocateError, Located, Locator};
pub use noise::Noise;
pub use polynomial::{DisplacementPolynomial, PolynomialError};
pub use rest::mean_at_rest;
pub use sensed_field::{SensedField, SensedFieldError};
pub use stiffness::{Stiffness, StiffnessError};

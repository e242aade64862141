//! Errors of a film to first order: exact derivatives of the displacement errors by every error of
//! every tile and of the surroundings, and their consequences (docs/physics.md, section 7).

/// Mean squares of the displacement errors along one axis, divided into causes and tiles.
mod axis_errors;
/// The model against exact samples.
mod check;
/// Displacement errors as a linear function of the readings.
mod displacement;
/// Samples of the linear model.
mod linear_samples;
/// The model: residuals and sensitivities.
mod model;
/// The errors of a film as one list.
mod sources;
/// Displacement errors as functions of J and of the sides of tiles.
mod tile_changes;
/// The derivatives of the field of one tile by its errors.
mod tile_response;

pub use axis_errors::{AxisErrors, Contribution, Share};
pub use check::{AxisCheck, FirstOrderCheck};
pub use model::{ErrorTerm, FirstOrder};
pub use sources::{Cause, ErrorSource, SensorError};
pub use tile_changes::TileChanges;
pub use tile_response::TileResponse;

#[cfg(test)]
mod tests;

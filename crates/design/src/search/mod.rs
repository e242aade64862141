//! The search from several starts, its stages, and the film found.

/// The time that a search will take.
pub(crate) mod estimate;
/// The spacing of the head that goes with a film.
mod head_spacing;
/// Errors of films as made, by samples.
pub(crate) mod made_films;
/// Errors of a film over a grid.
pub(crate) mod metrics;
/// Rounding to the resolution.
mod rounding;
/// The film that a search returns.
pub(crate) mod search_result;
/// Demands that the film misses.
pub(crate) mod shortfall;
/// The search, stage by stage.
mod stages;
/// The displacement error compared with the travel of the sensor.
pub(crate) mod travel;
/// The film found, as a layout.
mod write_layout;

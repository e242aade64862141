//! Laying a film from a box of measured tiles: the result and the plan of `assign`.

/// A film with the tile of each place: the result of `assign`.
pub(crate) mod assigned_film;
/// The plan as a file.
pub(crate) mod laying_plan;

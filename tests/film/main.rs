//! Layout files, the shipped films, and their known numbers.

/// Discs as strips and waves in slices.
mod approximate_shapes;
/// Error budgets, against exact samples.
mod budget;
/// The rules of `docs/design.md` for the designed films.
mod designed;
/// The published film against its expectations, and changed films against them.
mod expectations;
/// Errors to first order, against exact samples.
mod first_order;
/// Random edits of layouts, and arbitrary text.
mod fuzz;
/// The rules of layout files and their error messages.
mod layout_files;
/// The published film against known numbers.
mod published;
/// Films with errors of their tiles, against known percentiles.
mod real_films;
mod recoil;
/// The descriptions of keys in the JSON Schema.
mod schema_descriptions;
/// The shipped layouts: their paths, and a round trip of each.
mod shipped;

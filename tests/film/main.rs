//! Layout files, the shipped films, and the numbers known of them.

/// The rules that `docs/design.md` states for the designed films.
mod designed;
/// The published film against its expectations, and changed films against them.
mod expectations;
/// The rules of layout files and their error messages.
mod layout_files;
/// The published film against numbers known of it.
mod published;
/// The JSON Schema of layout files against documents.
mod schema;
/// Paths of the shipped layouts, and a round trip of each.
mod shipped;

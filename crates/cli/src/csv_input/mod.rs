//! Tables of numbers that users bring: lines with names of columns, then rows.

/// A reader of the lines that have content.
pub(crate) mod content_lines;
/// A reader that fails at a line without an end.
pub(crate) mod limited_lines;
/// Names of columns with units.
pub(crate) mod names;
/// Marks between the cells of a line.
pub(crate) mod separator;
/// An open table, read row by row.
pub(crate) mod table;

//! Tables of numbers that users bring: lines with names of columns, then rows.

/// Numbers of a row in groups of columns.
pub(crate) mod cells;
/// A reader of the lines that have content.
pub(crate) mod content_lines;
/// Groups of columns, found by their names.
pub(crate) mod finder;
/// A reader that fails at a line without an end.
pub(crate) mod limited_lines;
/// Names of columns with units.
pub(crate) mod names;
/// Marks between the cells of a line.
pub(crate) mod separator;
/// An open table, read row by row.
pub(crate) mod table;

//! Tables of numbers that users bring: lines with names of columns, then rows.
//!
//! A table is declared by its [`form::Form`] and by groups of columns, such as
//! [`quantities::POSITION`]. [`rows::Rows`] finds the columns, and reads the rows.

/// A reader of the lines that have content.
mod content_lines;
/// Groups of columns, found by their names.
pub(crate) mod finder;
/// A reader that fails at a line without an end.
pub(crate) mod limited_lines;
/// Names of columns with units.
mod names;
/// The line with the names.
mod names_line;
/// The quantities of columns: their names and units.
pub(crate) mod quantities;
/// The rows of a table as values.
pub(crate) mod rows;
/// Marks between the cells of a line.
mod separator;
/// An open table, read row by row.
pub(crate) mod table;

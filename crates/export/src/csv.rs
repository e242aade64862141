//! Tables as CSV: a row of names, then one row per point. Metadata are not written.

use std::io::{self, Write};

use magsplice::results::{Rows, Table};

/// Writes the table: the header, then the rows.
///
/// A table that does not fit into memory can be written in pieces: [`header`] once, then [`rows`]
/// for each piece.
///
/// # Accuracy
/// Numbers have the shortest digits that read back to the same number.
///
/// # Errors
/// Errors of the writer.
pub fn write(table: &Table, w: &mut dyn Write) -> io::Result<()> {
    header(table, w)?;
    rows(table, w)
}

/// Writes the names of the columns.
///
/// # Errors
/// Errors of the writer.
pub fn header(table: &Table, w: &mut dyn Write) -> io::Result<()> {
    let names: Vec<&str> = table.columns().iter().map(|column| column.name).collect();
    writeln!(w, "{}", names.join(","))
}

/// Writes the rows.
///
/// # Accuracy
/// Numbers have the shortest digits that read back to the same number.
///
/// # Errors
/// Errors of the writer.
pub fn rows(table: &Table, w: &mut dyn Write) -> io::Result<()> {
    let columns = table.columns();
    let (first, others) = columns.split_first().expect("a table has a column of its rows");
    for row in 0..table.rows().len() {
        // Debug writes an exponent where that is shorter; Display never does.
        match table.rows() {
            Rows::Numbered { first, .. } => write!(w, "{}", first + row as u64)?,
            Rows::Points(_) => write!(w, "{:?}", first.get(row))?,
        }
        others.iter().try_for_each(|column| write!(w, ",{:?}", column.get(row)))?;
        writeln!(w)?;
    }
    Ok(())
}

//! Tables as CSV, which can be written piece by piece.

use std::io::{self, Write};

use crate::table::Table;

/// Writes the names of the columns.
///
/// # Errors
/// Those of the writer.
pub fn header(table: &Table, w: &mut dyn Write) -> io::Result<()> {
    let names: Vec<&str> = table.columns().iter().map(|column| column.name).collect();
    writeln!(w, "{}", names.join(","))
}

/// Writes the rows.
///
/// # Accuracy
/// The shortest digits that read back to the same number, with an exponent where that is shorter.
///
/// # Errors
/// Those of the writer.
pub fn rows(table: &Table, w: &mut dyn Write) -> io::Result<()> {
    let columns = table.columns();
    let (first, others) = columns.split_first().expect("coordinates are always there");
    for row in 0..table.points.len() {
        // Debug prints such digits; Display never has an exponent.
        write!(w, "{:?}", first.get(row))?;
        others.iter().try_for_each(|column| write!(w, ",{:?}", column.get(row)))?;
        writeln!(w)?;
    }
    Ok(())
}

//! Tables as CSV: a row of names, then one row per point. Metadata are not written. Loads on tiles,
//! which have names.

use std::io::{self, Write};

use magsplice::results::{FilmLoads, LoadN, Rows, Table, TileLoad};

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

/// The loads on tiles: one line per tile, in the order of laying where there is one. Forces are in
/// N, torques in N mm.
pub fn loads(loads: &FilmLoads) -> String {
    let numbers = |load: &LoadN| {
        let numbers = load.force_n.to_array().into_iter().chain(load.torque_n_mm.to_array());
        numbers.map(|number| format!(",{number:e}")).collect::<String>()
    };
    let columns = |prefix: &str| {
        let force = ["x", "y", "z"].map(|axis| format!(",{prefix}force_{axis}_n"));
        let torque = ["x", "y", "z"].map(|axis| format!(",{prefix}torque_{axis}_n_mm"));
        force.concat() + &torque.concat()
    };
    let name = |tile: &TileLoad| format!("\"{}\"", tile.name.replace('"', "\"\""));
    let mut csv = format!("tile{}", columns(""));
    let Some(order) = &loads.order else {
        csv.push('\n');
        for tile in &loads.tiles {
            csv += &format!("{}{}\n", name(tile), numbers(&tile.load));
        }
        return csv;
    };
    csv += &format!(",step{}\n", columns("laying_"));
    for (step, tile) in order.steps.iter().enumerate() {
        let by_all = &loads.tiles[tile.tile].load;
        csv += &format!("{}{},{}{}\n", name(tile), numbers(by_all), step + 1, numbers(&tile.load));
    }
    csv
}

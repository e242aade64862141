//! Tables as CSV: a row of names, then one row per point, without metadata. Loads on tiles.

use std::io::{self, Write};

use magsplice::results::{FilmLoads, LoadN, Table, TileLoad};

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
    for row in 0..table.rows().len() {
        for (index, column) in columns.iter().enumerate() {
            let comma = if index == 0 { "" } else { "," };
            // Debug writes an exponent where that is shorter; Display never does.
            match column.is_whole() {
                true => write!(w, "{comma}{}", column.get(row))?,
                false => write!(w, "{comma}{:?}", column.get(row))?,
            }
        }
        writeln!(w)?;
    }
    Ok(())
}

/// The loads on tiles: one line per tile, in placement order if there is one. Forces are in N,
/// torques in N mm.
pub fn loads(loads: &FilmLoads) -> String {
    let columns = |prefix: &str| {
        ["force_x_n", "force_y_n", "force_z_n", "torque_x_n_mm", "torque_y_n_mm", "torque_z_n_mm"]
            .map(|name| format!(",{prefix}{name}"))
            .concat()
    };
    let numbers = |LoadN { force_n, torque_n_mm }: &LoadN| {
        [force_n, torque_n_mm].map(|of| of.to_array().map(|number| format!(",{number:e}")).concat()).concat()
    };
    // The tile, the load by all others, and the step with the load by tiles placed before.
    let line = |tile: &TileLoad, by_all: &LoadN, placement: String| {
        format!("\"{}\"{}{placement}\n", tile.name.replace('"', "\"\""), numbers(by_all))
    };
    let Some(order) = &loads.order else {
        let lines = loads.tiles.iter().map(|tile| line(tile, &tile.load, String::new()));
        return format!("tile{}\n{}", columns(""), lines.collect::<String>());
    };
    let lines =
        order.steps.iter().enumerate().map(|(step, tile)| {
            line(tile, &loads.tiles[tile.tile].load, format!(",{}{}", step + 1, numbers(&tile.load)))
        });
    format!("tile{},step{}\n{}", columns(""), columns("placement_"), lines.collect::<String>())
}

//! Orders of laying from a CSV file.

use std::collections::HashMap;
use std::path::Path;

use magsplice::layout::Layout;

use crate::csv_input::limited_lines::shown;
use crate::csv_input::table::{CsvTable, Row};
use crate::failure::Failure;
use crate::faults::FaultList;
use crate::text::number::counted;

/// Name of the column with the names of the tiles.
const COLUMN: &str = "tile";

/// The tile of each step: the lines of the file, by the column `tile`.
pub(crate) fn read(path: &Path, layout: &Layout) -> Result<Vec<usize>, Failure> {
    let failed = |message: String| Failure::Points { path: path.to_owned(), message };
    let is_column = |name: &String| name.trim().eq_ignore_ascii_case(COLUMN);
    let mut table = CsvTable::open(path, |names| names.iter().any(is_column), COLUMN).map_err(failed)?;
    let Some(column) = table.names.iter().position(is_column) else {
        return Err(failed(format!("line {}: has no column {COLUMN} with the names of the tiles", table.names_line)));
    };
    let tiles: HashMap<&str, usize> =
        layout.tiles.iter().enumerate().map(|(index, named)| (named.name.as_str(), index)).collect();
    let mut lines = vec![None; layout.tiles.len()];
    let (mut order, mut faults) = (Vec::new(), FaultList::default());
    while let Some(row) = table.next_row().map_err(failed)? {
        let line = match row {
            Row::Cells(line) => line,
            Row::Fault(line, fault) => {
                faults.add(line, fault);
                continue;
            }
        };
        let name = table.cell(column);
        match tiles.get(name).map(|&tile| (tile, lines[tile])) {
            None => faults.add(line, format!("line {line}: the layout has no tile {}", shown(name))),
            Some((_, Some(before))) => {
                faults.add(line, format!("line {line}: tile {} is laid at line {before} already", shown(name)));
            }
            Some((tile, None)) => {
                lines[tile] = Some(line);
                order.push(tile);
            }
        }
    }
    if !faults.is_empty() {
        return Err(faults.failure(path.display().to_string()));
    }
    if let Some(missing) = lines.iter().position(Option::is_none) {
        let count = lines.iter().filter(|line| line.is_none()).count();
        return Err(failed(format!(
            "{} missing, such as {}: each tile must be laid once",
            counted(count, "tile of the layout is", "tiles of the layout are"),
            layout.tiles[missing].name
        )));
    }
    Ok(order)
}

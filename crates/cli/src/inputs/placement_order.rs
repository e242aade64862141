//! Placement orders from a CSV file.

use std::collections::HashMap;
use std::path::Path;

use magsplice::layout::Layout;

use crate::csv_input::limited_lines::shown;
use crate::csv_input::quantities::TILE;
use crate::csv_input::rows::{Form, Rows};
use crate::failure::Failure;
use crate::text::number::counted;

/// The tile of each step: the lines of the file, by the column `tile`.
pub(crate) fn read(path: &Path, layout: &Layout) -> Result<Vec<usize>, Failure> {
    let form = Form { rows: "", most: usize::MAX, too_many: "", is_log: false };
    let rows = Rows::open(
        path,
        form,
        "tile",
        None,
        |names| TILE.fit(names),
        |finder| finder.required(&TILE).map(|[column]| column),
    )?;
    let tiles: HashMap<&str, usize> =
        layout.tiles.iter().enumerate().map(|(index, named)| (named.name.as_str(), index)).collect();
    let mut lines = vec![None; layout.tiles.len()];
    let (order, _) = rows.read_all(&|_| {}, |column, cells| {
        let (name, line) = (shown(cells.text(*column)), cells.line);
        match tiles.get(cells.text(*column)).map(|&tile| (tile, lines[tile])) {
            None => cells.fault(format!("the layout has no tile {name}")),
            Some((_, Some(before))) => cells.fault(format!("tile {name} is already placed at line {before}")),
            Some((tile, None)) => {
                lines[tile] = Some(line);
                return Some(tile);
            }
        }
        None
    })?;
    if let Some(missing) = lines.iter().position(Option::is_none) {
        let count = lines.iter().filter(|line| line.is_none()).count();
        let message = format!(
            "{} missing, such as {}: each tile must be placed once",
            counted(count, "tile of the layout is", "tiles of the layout are"),
            layout.tiles[missing].name
        );
        return Err(Failure::at(path, message));
    }
    Ok(order)
}

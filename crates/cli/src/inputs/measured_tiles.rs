//! Measured tiles from a CSV file.

use std::collections::HashMap;
use std::path::Path;

use magsplice::layout::Layout;
use magsplice::making::{MeasuredBox, MeasuredTile, PlaceGroup};

use super::magnet_columns::{self, MagnetColumns, MagnetForm};
use crate::csv_input::finder::{Column, Finder};
use crate::csv_input::limited_lines::shown;
use crate::csv_input::quantities::{SIZE, TILE, text};
use crate::csv_input::rows::{Cells, Form, Rows};
use crate::failure::Failure;

const FORM: Form = Form { rows: "tiles", most: 100_000, too_many: "", is_log: false };

/// The tiles of a box.
pub(crate) struct MeasuredTiles {
    /// For each part of the layout: its places and its tiles.
    pub(crate) groups: Vec<PlaceGroup>,
    /// Whether the sides of any tile were measured.
    pub(crate) has_sizes: bool,
    /// Names of columns that were not read.
    pub(crate) ignored: Vec<String>,
}

/// The columns of all properties.
struct Columns {
    tile: Column,
    part: Option<Column>,
    size: [Option<Column>; 3],
    magnet: MagnetColumns,
}

/// Reads a box of tiles for the parts of a layout. The failure lists all rows that break rules.
///
/// A tile without a measured magnetization cannot be assigned: it is left out, which `tell` prints.
pub(crate) fn read(path: &Path, layout: &Layout, tell: &dyn Fn(&str)) -> Result<MeasuredTiles, Failure> {
    let fit = |names: &[String]| TILE.fit(names).min(magnet_columns::fit(names));
    let mut measured = MeasuredBox::new(layout);
    let parts = measured.part_count();
    let find = |finder: &mut Finder| columns(finder, parts);
    let rows = Rows::open(path, FORM, "tile,part,jx_t,jy_t,jz_t", None, fit, find)?;
    let ignored = rows.ignored.clone();
    let mut lines = HashMap::new();
    rows.read_all(tell, |columns, cells| {
        let name = cells.text(columns.tile).to_owned();
        match lines.insert(name.clone(), cells.line) {
            Some(first) if !name.is_empty() => {
                cells.fault(format!("tile \"{}\" is in line {first} already", shown(&name)));
            }
            _ => add(&mut measured, &name, columns, cells),
        }
        Some(())
    })?;
    Ok(MeasuredTiles { has_sizes: measured.has_sizes(), groups: measured.into_groups(), ignored })
}

/// Finds the columns, or adds all that is wrong with the names.
fn columns(finder: &mut Finder, parts: usize) -> Option<Columns> {
    let tile = finder.required(&TILE).map(|[column]| column);
    let part = finder.column(&text("part", &["part", "kind"]));
    let size = finder.partial_group(&SIZE);
    if part.is_none() && size.iter().all(Option::is_none) && parts > 1 {
        finder.fault(format!(
            "no column part with the part of each tile, 1 to {parts} as `magsplice tiles` lists them, or columns of sizes"
        ));
    }
    let magnet = magnet_columns::find(finder, MagnetForm::Any);
    Some(Columns { tile: tile?, part, size, magnet: magnet? })
}

/// Adds the tile of a row, or what is wrong with its numbers, else with the tile.
fn add(measured: &mut MeasuredBox, name: &str, columns: &Columns, cells: &mut Cells) {
    let part = columns.part.map(|column| cells.text(column).to_owned()).filter(|part| !part.is_empty());
    if cells.is_any_missing(&columns.magnet.columns()) {
        cells.leave_out(format!("the magnetization of tile \"{}\" is missing", shown(name)));
        return;
    }
    // Sides that are not given were not measured.
    let size_mm = cells.measured(&columns.size).filter(|size_mm| size_mm.to_array().iter().any(|side| !side.is_nan()));
    let magnet = columns.magnet.of_row(cells);
    if let Some(magnet) = magnet.filter(|_| cells.faults.is_empty())
        && let Err(found) = measured.add(&MeasuredTile { name, part: part.as_deref(), size_mm, magnet })
    {
        cells.faults = found;
    }
}

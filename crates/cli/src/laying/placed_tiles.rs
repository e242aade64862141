//! Tiles that lie already, from a CSV file with the columns of a plan.

use std::path::Path;

use magsplice::layout::Layout;
use magsplice::making::{Laying, LyingTile, PartlyLaid, PlaceGroup};

use crate::csv_input::cells::{number, vector};
use crate::csv_input::finder::{ANGLES, Column, Finder, NO_UNIT};
use crate::csv_input::limited_lines::shown;
use crate::csv_input::table::{CsvTable, Row};
use crate::failure::Failure;
use crate::faults::FaultList;
use crate::units::LENGTHS;

/// The line of names that messages show.
const EXAMPLE: &str = "place,tile,x_mm,y_mm,z_mm,up,mark_deg";

struct Columns {
    place: Column,
    tile: Column,
    position: Option<[Column; 3]>,
    up: Option<Column>,
    mark: Column,
    laid: Option<Column>,
}

/// Reads which of the tiles of `groups` lie in the film of a layout. The failure lists all rows
/// that break rules.
pub(crate) fn read(path: &Path, layout: &Layout, groups: &[PlaceGroup]) -> Result<PartlyLaid, Failure> {
    let failed = |message: String| Failure::Points { path: path.to_owned(), message };
    let has_names = |names: &[String]| {
        ["place", "tile"].iter().all(|wanted| names.iter().any(|name| name.trim().eq_ignore_ascii_case(wanted)))
    };
    let mut table = CsvTable::open(path, has_names, EXAMPLE).map_err(failed)?;
    let place = path.display().to_string();
    let mut faults = FaultList::default();
    let columns = match columns(&table.names) {
        Ok(columns) => columns,
        Err(found) => {
            let line = table.names_line;
            found.into_iter().for_each(|fault| faults.add(line, format!("line {line}: {fault}")));
            return Err(faults.failure(place));
        }
    };
    let mut laying = Laying::new(layout, groups);
    while let Some(row) = table.next_row().map_err(failed)? {
        match row {
            Row::Fault(line, fault) => faults.add(line, fault),
            Row::Cells(line) => {
                let laid = columns.laid.map_or("yes", |column| table.cell(column.index)).to_lowercase();
                match laid.as_str() {
                    "yes" => {
                        if let Err(found) = lay(&mut laying, &columns, &mut table, line) {
                            faults.add(line, format!("line {line}: {}", found.join("; ")));
                        }
                    }
                    "no" => {}
                    other => {
                        faults.add(line, format!("line {line}: laid = \"{}\", must be yes or no", shown(other)));
                    }
                }
            }
        }
    }
    if faults.is_empty() { Ok(laying.finish()) } else { Err(faults.failure(place)) }
}

fn columns(names: &[String]) -> Result<Columns, Vec<String>> {
    let mut finder = Finder::new(names);
    let mut text = |name: &str| finder.group(name, [[name]], &NO_UNIT, None).map(|[column]| column);
    let (place, tile, up, laid) = (text("place"), text("tile"), text("up"), text("laid"));
    let position = finder.group("position", [["x"], ["y"], ["z"]], &LENGTHS, None);
    // The axis of the mark is in a column of its own, which follows from the side that is up.
    let angles: Vec<String> =
        names.iter().map(|name| if name.trim() == "mark" { String::new() } else { name.clone() }).collect();
    let mut of_angles = Finder::new(&angles);
    let mark = of_angles.group("direction of the mark", [["mark"]], &ANGLES, None).map(|[column]| column);
    finder.faults.append(&mut of_angles.faults);
    if mark.is_none() {
        finder.missing("direction of the mark: mark_deg");
    }
    match (place, tile, mark) {
        (Some(place), Some(tile), Some(mark)) if finder.faults.is_empty() => {
            Ok(Columns { place, tile, position, up, mark, laid })
        }
        _ => Err(finder.faults),
    }
}

/// Lays the tile of a row, or tells what is wrong with its numbers, else with the tile.
fn lay(laying: &mut Laying, columns: &Columns, table: &mut CsvTable, line: u64) -> Result<(), Vec<String>> {
    let mut faults = Vec::new();
    let position_mm = columns.position.and_then(|columns| vector(&columns, table, line, &mut faults));
    let mark_deg = number(columns.mark, table, line, &mut faults);
    if !faults.is_empty() {
        return Err(faults);
    }
    let up = columns.up.map_or("+z", |column| table.cell(column.index));
    let (place, tile) = (table.cell(columns.place.index), table.cell(columns.tile.index));
    laying.lay(&LyingTile { place, tile, position_mm, up, mark_deg })
}

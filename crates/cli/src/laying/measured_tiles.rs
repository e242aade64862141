//! Measured tiles from a CSV file.

use std::collections::HashMap;
use std::path::Path;

use magsplice::layout::{Layout, direction_from_degrees};
use magsplice::magnet::MU_0;
use magsplice::making::{MeasuredBox, MeasuredMagnet, MeasuredTile, PlaceGroup};

use super::measured_columns::{self, MagnetColumns, MeasuredColumns};
use crate::csv_input::cells::{number, numbers, vector};
use crate::csv_input::limited_lines::shown;
use crate::csv_input::table::{CsvTable, Row};
use crate::failure::{Failure, PRINTED_FAULTS};
use crate::faults::FaultList;

/// Largest number of tiles of a box.
const MAX_TILES: usize = 100_000;

/// The tiles of a box.
pub(crate) struct MeasuredTiles {
    /// For each part of the layout: its places and its tiles.
    pub(crate) groups: Vec<PlaceGroup>,
    /// Whether the sides of any tile were measured.
    pub(crate) has_sizes: bool,
    /// Names of columns that were not read.
    pub(crate) ignored: Vec<String>,
}

/// Reads a box of tiles for the parts of a layout. The failure lists all rows that break rules.
pub(crate) fn read(path: &Path, layout: &Layout) -> Result<MeasuredTiles, Failure> {
    let failed = |message: String| Failure::Points { path: path.to_owned(), message };
    let mut table = CsvTable::open(path, measured_columns::has_names, measured_columns::EXAMPLE).map_err(failed)?;
    let place = path.display().to_string();
    let mut faults = FaultList::default();
    let columns = match measured_columns::find(&table.names) {
        Ok(columns) => columns,
        Err(found) => {
            let line = table.names_line;
            found.into_iter().for_each(|fault| faults.add(line, format!("line {line}: {fault}")));
            return Err(faults.failure(place));
        }
    };
    let mut measured = MeasuredBox::new(layout);
    let mut lines = HashMap::new();
    while let Some(row) = table.next_row().map_err(failed)? {
        if lines.len() >= MAX_TILES {
            return Err(failed(format!("has more than {MAX_TILES} tiles")));
        }
        let line = match row {
            Row::Cells(line) => line,
            Row::Fault(line, fault) => {
                faults.add(line, fault);
                continue;
            }
        };
        let name = table.cell(columns.tile.index).to_owned();
        if let Some(first) = lines.insert(name.clone(), line).filter(|_| !name.is_empty()) {
            faults.add(line, format!("line {line}: tile \"{}\" is in line {first} already", shown(&name)));
        } else if let Err(found) = add(&mut measured, &name, &columns, &mut table, line) {
            faults.add(line, format!("line {line}: {}", found.join("; ")));
        }
    }
    if !faults.is_empty() {
        return Err(faults.failure(place));
    }
    if lines.is_empty() {
        return Err(failed("has no tiles below its names of columns".to_owned()));
    }
    let ignored = columns.ignored.into_iter().take(PRINTED_FAULTS).collect();
    Ok(MeasuredTiles { has_sizes: measured.has_sizes(), groups: measured.into_groups(), ignored })
}

/// Adds the tile of a row, or tells what is wrong with its numbers, else with the tile.
fn add(
    measured: &mut MeasuredBox,
    name: &str,
    columns: &MeasuredColumns,
    table: &mut CsvTable,
    line: u64,
) -> Result<(), Vec<String>> {
    let mut faults = Vec::new();
    let part = columns.part.map(|column| table.cell(column.index).to_owned()).filter(|part| !part.is_empty());
    // Sides that are not given were not measured.
    let sides = columns.size.filter(|sides| sides.iter().any(|side| !table.cell(side.index).is_empty()));
    let size_mm = sides.and_then(|sides| vector(&sides, table, line, &mut faults));
    let magnet = match &columns.magnet {
        MagnetColumns::Polarization(columns) => {
            vector(columns, table, line, &mut faults).map(MeasuredMagnet::Polarization)
        }
        MagnetColumns::Magnetization(columns) => {
            vector(columns, table, line, &mut faults).map(|m| MeasuredMagnet::Polarization(MU_0 * m))
        }
        MagnetColumns::Moment(columns) => vector(columns, table, line, &mut faults).map(MeasuredMagnet::Moment),
        MagnetColumns::Strength(strength, angles) => {
            let strength_t = number(*strength, table, line, &mut faults);
            match angles {
                Some(angles) => numbers(angles, table, line, &mut faults)
                    .map(|angles_deg| MeasuredMagnet::Polarization(strength_t * direction_from_degrees(angles_deg))),
                None => Some(MeasuredMagnet::Strength(strength_t)),
            }
        }
    };
    match magnet {
        Some(magnet) if faults.is_empty() => {
            measured.add(&MeasuredTile { name, part: part.as_deref(), size_mm, magnet })
        }
        _ => Err(faults),
    }
}

//! The rows of a table of blocks as tiles.

use std::collections::HashMap;
use std::path::Path;

use magsplice::layout::{NamedTile, Rotation, RotationFaults};
use magsplice::magnet::{MU_0, TileFault};
use magsplice::prelude::{DQuat, DVec3, Tile};

use super::columns::{self, BlockColumns, MagnetColumns};
use super::rotation::RotationColumns;
use crate::args::import::ImportArgs;
use crate::csv_input::cells::{number, numbers, vector};
use crate::csv_input::finder::Column;
use crate::csv_input::limited_lines::shown;
use crate::csv_input::table::{CsvTable, Row};
use crate::failure::{Failure, PRINTED_FAULTS};
use crate::faults::FaultList;

/// Largest number of blocks. A layout file, of at most 64 MiB, holds fewer.
const MAX_BLOCKS: usize = 1_000_000;

/// Length in mm below which no block of a magnet is made. Blocks of up to 20 mm, written in metres,
/// are smaller numbers.
pub(crate) const SMALLEST_MAGNET_MM: f64 = 0.02;

/// The line of names that messages show.
const EXAMPLE: &str = "x_mm,y_mm,z_mm,size_x_mm,size_y_mm,size_z_mm,jx_t,jy_t,jz_t";

/// The blocks of a file.
pub(crate) struct Blocks {
    pub(crate) tiles: Vec<NamedTile>,
    /// The line of each block, by its name.
    pub(crate) lines: HashMap<String, u64>,
    /// Names of columns that were not read.
    pub(crate) ignored: Vec<String>,
    /// The largest size in mm, if it is one that only metres under a name with mm have.
    pub(crate) suspicious_size_mm: Option<f64>,
}

/// Reads all blocks of a file. The failure lists all rows that break rules.
pub(crate) fn read(path: &Path, args: &ImportArgs) -> Result<Blocks, Failure> {
    let failed = |message: String| Failure::Points { path: path.to_owned(), message };
    let mut table = CsvTable::open(path, columns::has_names, EXAMPLE).map_err(failed)?;
    let place = path.display().to_string();
    let mut faults = FaultList::default();
    let columns = match columns::find(&table.names, args) {
        Ok(columns) => columns,
        Err(found) => {
            let line = table.names_line;
            found.into_iter().for_each(|fault| faults.add(line, format!("line {line}: {fault}")));
            return Err(faults.failure(place));
        }
    };
    let (mut tiles, mut lines) = (Vec::new(), HashMap::new());
    let mut count = 0;
    while let Some(row) = table.next_row().map_err(failed)? {
        count += 1;
        if count > MAX_BLOCKS {
            return Err(failed(format!("has more than {MAX_BLOCKS} blocks, too many for a layout")));
        }
        match row {
            Row::Fault(line, fault) => faults.add(line, fault),
            Row::Cells(line) => match tile(&columns, &mut table, line, count) {
                Ok(tile) => {
                    lines.entry(tile.name.clone()).or_insert(line);
                    tiles.push(tile);
                }
                Err(found) => faults.add(line, format!("line {line}: {}", found.join("; "))),
            },
        }
    }
    if count == 0 {
        return Err(failed("has no blocks below its names of columns".to_owned()));
    }
    if !faults.is_empty() {
        return Err(faults.failure(place));
    }
    let in_mm = columns.size.iter().all(|column| column.exponent == 0);
    let largest_mm = tiles.iter().map(|tile| tile.tile.size().max_element()).fold(0.0, f64::max);
    let suspicious_size_mm = (in_mm && largest_mm < SMALLEST_MAGNET_MM).then_some(largest_mm);
    Ok(Blocks { tiles, lines, suspicious_size_mm, ignored: columns.ignored.into_iter().take(PRINTED_FAULTS).collect() })
}

/// The tile of a row, or everything that is wrong with it. `number` counts the rows from 1.
fn tile(columns: &BlockColumns, table: &mut CsvTable, line: u64, number: usize) -> Result<NamedTile, Vec<String>> {
    let mut faults = Vec::new();
    let position = vector(&columns.position, table, line, &mut faults);
    let size = vector(&columns.size, table, line, &mut faults);
    let (magnet_columns, to_tesla) = match &columns.magnet {
        MagnetColumns::Polarization(columns) => (columns, 1.0),
        MagnetColumns::Magnetization(columns) => (columns, MU_0),
    };
    let polarization_t = vector(magnet_columns, table, line, &mut faults).map(|v| v * to_tesla);
    let rotation = match &columns.rotation {
        Some(columns) => rotation(columns, table, line, &mut faults),
        None => None,
    };
    let name = columns.name.map_or("", |column| table.cell(column.index));
    let name = if name.is_empty() { format!("tile-{number}") } else { name.to_owned() };
    // Values that are no numbers are faults already; the rules of the others are still checked.
    let checked =
        Tile::new(position.unwrap_or(DVec3::ZERO), size.unwrap_or(DVec3::ONE), polarization_t.unwrap_or(DVec3::ZERO));
    match checked {
        Ok(tile) if faults.is_empty() => {
            let rotation = rotation.filter(|rotation| rotation.quaternion() != DQuat::IDENTITY);
            let turned = rotation.map_or(Ok(tile), |rotation| tile.rotated(rotation.quaternion()));
            let tile = turned.map_err(|faults| vec![faults.to_string()])?;
            Ok(NamedTile { name, kind: None, rotation, tile, permeability: None })
        }
        Ok(_) => Err(faults),
        Err(broken) => {
            faults.extend(broken.0.iter().map(|fault| in_columns(fault, columns, magnet_columns, table)));
            Err(faults)
        }
    }
}

/// A broken rule with the column and the text of the cell.
fn in_columns(fault: &TileFault, columns: &BlockColumns, magnet: &[Column; 3], table: &CsvTable) -> String {
    let column = match fault {
        TileFault::Position { axis, .. } => columns.position[*axis],
        TileFault::Size { axis, .. } => columns.size[*axis],
        TileFault::Polarization { axis, .. } => magnet[*axis],
        other => return other.to_string(),
    };
    format!("{} = \"{}\", {}", table.names[column.index], shown(table.cell(column.index)), fault.rule())
}

/// The rotation of a row. `None` if its cells are empty, or after adding faults.
fn rotation(columns: &RotationColumns, table: &mut CsvTable, line: u64, faults: &mut Vec<String>) -> Option<Rotation> {
    if columns.columns().iter().all(|column| table.cell(column.index).is_empty()) {
        return None;
    }
    let rotation = match columns {
        RotationColumns::Quaternion(columns) => Rotation::from_quaternion(numbers(columns, table, line, faults)?),
        RotationColumns::AxisAngle(columns) => {
            let [x, y, z, angle_deg] = numbers(columns, table, line, faults)?;
            Rotation::from_axis_angle([x, y, z], angle_deg)
        }
        RotationColumns::Euler(columns, order) => {
            let before = faults.len();
            let angles_deg = columns.map(|column| column.map_or(0.0, |column| number(column, table, line, faults)));
            if faults.len() > before {
                return None;
            }
            Rotation::from_euler(angles_deg, *order)
        }
        RotationColumns::Matrix(columns) => {
            let [a, b, c, d, e, f, g, h, i] = numbers(columns, table, line, faults)?;
            Rotation::from_matrix([[a, b, c], [d, e, f], [g, h, i]])
        }
    };
    rotation.map_err(|RotationFaults(broken)| faults.extend(broken.iter().map(ToString::to_string))).ok()
}

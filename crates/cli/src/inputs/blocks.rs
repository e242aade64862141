//! Blocks from a CSV file, one tile per row.

use std::collections::HashMap;
use std::path::Path;

use magsplice::layout::{EulerOrder, NamedTile};
use magsplice::magnet::TileFault;
use magsplice::prelude::{DQuat, DVec3, Tile};

use super::magnet_columns::{self, MagnetColumns, MagnetForm};
use super::rotation::{self, RotationColumns};
use crate::args::given_units::GivenUnits;
use crate::csv_input::finder::{Column, Finder};
use crate::csv_input::quantities::{POSITION, SIZE, text};
use crate::csv_input::rows::{Cells, Form, Rows};
use crate::failure::Failure;

/// A layout file, of at most 64 MiB, holds fewer blocks.
const FORM: Form = Form { rows: "blocks", most: 1_000_000, too_many: ", too many for a layout", is_log: false };

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

/// The columns of all properties.
struct Columns {
    name: Option<Column>,
    position: [Column; 3],
    size: [Column; 3],
    magnet: MagnetColumns,
    rotation: Option<RotationColumns>,
}

/// Reads all blocks of a file. The failure lists all rows that break rules.
pub(crate) fn read(path: &Path, units: Option<&GivenUnits>, euler: Option<EulerOrder>) -> Result<Blocks, Failure> {
    let no_units = GivenUnits::default();
    let units = Some(units.unwrap_or(&no_units));
    let rows = Rows::open(path, FORM, EXAMPLE, units, |names| POSITION.fit(names), |finder| columns(finder, euler))?;
    let (ignored, in_mm) = (rows.ignored.clone(), rows.columns.size.iter().all(|column| column.unit.name == "mm"));
    let mut count = 0;
    let (tiles, lines) = rows.read_all(&|_| {}, |columns, cells| {
        count += 1;
        tile(columns, cells, count)
    })?;
    let mut line_of = HashMap::new();
    for (tile, line) in tiles.iter().zip(lines) {
        line_of.entry(tile.name.clone()).or_insert(line);
    }
    let largest_mm = tiles.iter().map(|tile| tile.tile.size().max_element()).fold(0.0, f64::max);
    let suspicious_size_mm = (in_mm && largest_mm < SMALLEST_MAGNET_MM).then_some(largest_mm);
    Ok(Blocks { tiles, lines: line_of, ignored, suspicious_size_mm })
}

/// Finds the columns, or adds all that is wrong with the names.
fn columns(finder: &mut Finder, euler: Option<EulerOrder>) -> Option<Columns> {
    let name = finder.column(&text("name", &["name", "label"]));
    let position = finder.required(&POSITION);
    let size = finder.required(&SIZE);
    let magnet = magnet_columns::find(finder, MagnetForm::Polarization);
    let rotation = rotation::find(finder, euler);
    Some(Columns { name, position: position?, size: size?, magnet: magnet?, rotation })
}

/// The tile of a row, or nothing after adding everything that is wrong with it. `number` counts the
/// rows from 1.
fn tile(columns: &Columns, cells: &mut Cells, number: usize) -> Option<NamedTile> {
    let position = cells.vector(&columns.position);
    let size = cells.vector(&columns.size);
    let polarization_t = columns.magnet.polarization_of_row(cells);
    let rotation = columns.rotation.as_ref().and_then(|rotation| rotation.of_row(cells));
    let name = columns.name.map_or("", |column| cells.text(column));
    let name = if name.is_empty() { format!("tile-{number}") } else { name.to_owned() };
    // Values that are no numbers are faults already; the rules of the others are still checked.
    let checked =
        Tile::new(position.unwrap_or(DVec3::ZERO), size.unwrap_or(DVec3::ONE), polarization_t.unwrap_or(DVec3::ZERO));
    let broken = match checked {
        Ok(_) if !cells.faults.is_empty() => return None,
        Ok(tile) => {
            let rotation = rotation.filter(|rotation| rotation.quaternion() != DQuat::IDENTITY);
            match rotation.map_or(Ok(tile), |rotation| tile.rotated(rotation.quaternion())) {
                Ok(tile) => {
                    return Some(NamedTile { name, kind: None, rotation, tile, permeability: None, disc: None });
                }
                Err(broken) => vec![broken.to_string()],
            }
        }
        Err(broken) => broken.0.iter().map(|fault| in_columns(fault, columns, cells)).collect(),
    };
    cells.faults.extend(broken);
    None
}

/// A broken rule with the column and the text of the cell.
fn in_columns(fault: &TileFault, columns: &Columns, cells: &Cells) -> String {
    let column = match fault {
        TileFault::Position { axis, .. } => columns.position[*axis],
        TileFault::Size { axis, .. } => columns.size[*axis],
        TileFault::Polarization { axis, .. } => columns.magnet.component(*axis),
        other => return other.to_string(),
    };
    format!("{}, {}", cells.quoted(column), fault.rule())
}

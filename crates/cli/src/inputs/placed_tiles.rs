//! Tiles already placed, from a CSV file with the columns of a plan.

use std::path::Path;

use magsplice::layout::Layout;
use magsplice::making::{FixedTile, PartlyPlaced, PlaceGroup, Placement};

use crate::csv_input::finder::{Column, Finder};
use crate::csv_input::limited_lines::shown;
use crate::csv_input::quantities::{Group, POSITION, TILE, text};
use crate::csv_input::rows::{Cells, Form, Rows};
use crate::failure::Failure;
use crate::units::COLUMN_ANGLES;

/// Names of the columns of a plan, as `assign --plan` writes them.
pub(crate) const PLAN_COLUMNS: [&str; 9] =
    ["place", "tile", "x_mm", "y_mm", "z_mm", "up", "mark", "mark_deg", "placed"];

const FORM: Form = Form { rows: "", most: usize::MAX, too_many: "", is_log: false };

const PLACE: Group<1> = text("place", &["place"]);
/// Whether the tile is placed. Plans of earlier versions have it in `laid`.
const PLACED: Group<1> = text("placed", &["placed", "laid"]);
/// The axis of the mark is in a column `mark`, which follows from the side that is up.
const MARK: Group<1> =
    Group { name: "direction of the mark", columns: [&["mark"]], suffix: "_deg", units: &COLUMN_ANGLES };

struct Columns {
    place: Column,
    tile: Column,
    position: Option<[Column; 3]>,
    up: Option<Column>,
    mark: Column,
    placed: Option<Column>,
}

/// Reads which of the tiles of `groups` lie in the film of a layout, and the names of columns that
/// were not read. The failure lists all rows that break rules.
pub(crate) fn read(
    path: &Path,
    layout: &Layout,
    groups: &[PlaceGroup],
) -> Result<(PartlyPlaced, Vec<String>), Failure> {
    let fit = |names: &[String]| PLACE.fit(names).min(TILE.fit(names));
    let rows = Rows::open(path, FORM, "place,tile,x_mm,y_mm,z_mm,up,mark_deg", None, fit, columns)?;
    let ignored = rows.ignored.iter().filter(|name| !PLAN_COLUMNS.contains(&name.as_str())).cloned().collect();
    let mut placement = Placement::new(layout, groups);
    rows.read_all(&|_| {}, |columns, cells| {
        match columns.placed.map_or("yes".to_owned(), |column| cells.text(column).to_lowercase()).as_str() {
            "yes" => place(&mut placement, columns, cells),
            "no" => {}
            other => cells.fault(format!("placed = \"{}\", must be yes or no", shown(other))),
        }
        Some(())
    })?;
    Ok((placement.finish(), ignored))
}

fn columns(finder: &mut Finder) -> Option<Columns> {
    let (up, placed) = (finder.column(&text("up", &["up"])), finder.column(&PLACED));
    let position = finder.group(&POSITION);
    let [place, tile, mark] = [&PLACE, &TILE, &MARK].map(|group| finder.required(group).map(|[column]| column));
    Some(Columns { place: place?, tile: tile?, position, up, mark: mark?, placed })
}

/// Places the tile of a row, or adds what is wrong with its numbers, else with the tile.
fn place(placement: &mut Placement, columns: &Columns, cells: &mut Cells) {
    let position_mm = columns.position.and_then(|columns| cells.vector(&columns));
    let mark_deg = cells.number(columns.mark);
    if cells.faults.is_empty() {
        let up = columns.up.map_or("+z", |column| cells.text(column));
        let (place, tile) = (cells.text(columns.place), cells.text(columns.tile));
        if let Err(found) = placement.place(&FixedTile { place, tile, position_mm, up, mark_deg }) {
            cells.faults = found;
        }
    }
}

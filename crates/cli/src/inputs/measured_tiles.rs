//! Measured tiles from a CSV file.

use std::collections::HashMap;
use std::path::Path;

use magsplice::layout::{Layout, direction_from_degrees};
use magsplice::making::{MeasuredBox, MeasuredMagnet, MeasuredTile, PlaceGroup};

use crate::csv_input::finder::{Column, Finder};
use crate::csv_input::limited_lines::shown;
use crate::csv_input::quantities::{DIRECTION, MAGNETIZATION, MOMENT, POLARIZATION, SIZE, STRENGTH, text};
use crate::csv_input::rows::{Cells, Form, Rows};
use crate::failure::Failure;

const FORM: Form = Form { rows: "tiles", most: 100_000, too_many: "" };

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
    size: Option<[Column; 3]>,
    magnet: MagnetColumns,
}

/// The columns of the magnetization in one of its forms.
enum MagnetColumns {
    Polarization([Column; 3]),
    Moment([Column; 3]),
    /// Without angles the direction is that of the part.
    Strength(Column, Option<[Column; 2]>),
}

/// Reads a box of tiles for the parts of a layout. The failure lists all rows that break rules.
pub(crate) fn read(path: &Path, layout: &Layout) -> Result<MeasuredTiles, Failure> {
    let tile = text("tile", &["tile", "name", "label"]);
    let rows = Rows::open(path, FORM, "tile,part,jx_t,jy_t,jz_t", |names| tile.is_among(names), columns)?;
    let ignored = rows.ignored.clone();
    let mut measured = MeasuredBox::new(layout);
    let mut lines = HashMap::new();
    rows.read_all(|columns, cells| {
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
fn columns(finder: &mut Finder) -> Option<Columns> {
    let tile = finder.column(&text("tile", &["tile", "name", "label"]));
    let part = finder.column(&text("part", &["part", "kind"]));
    let size = finder.group(&SIZE, None);
    let polarization = finder.group(&POLARIZATION, None);
    let magnetization = finder.group(&MAGNETIZATION, None);
    let moment = finder.group(&MOMENT, None);
    let strength = finder.column(&STRENGTH);
    let angles = finder.group(&DIRECTION, None);
    let forms = [
        polarization.map(MagnetColumns::Polarization),
        magnetization.map(MagnetColumns::Polarization),
        moment.map(MagnetColumns::Moment),
        strength.map(|strength| MagnetColumns::Strength(strength, angles)),
    ];
    let mut found: Vec<MagnetColumns> = forms.into_iter().flatten().collect();
    if found.len() > 1 {
        finder.fault(
            "has more than one of polarization (jx_t, ...), magnetization (mx_a_per_m, ...), moment (moment_x_a_m2, \
             ...) and strength (strength_t), must have one of them",
        );
    } else if found.is_empty() {
        finder.missing(
            "polarization: jx_t, jy_t, jz_t, or magnetization: mx_a_per_m, my_a_per_m, mz_a_per_m, or moment: \
             moment_x_a_m2, moment_y_a_m2, moment_z_a_m2, or strength: strength_t, with or without direction_deg and \
             tilt_deg",
        );
    }
    if tile.is_none() {
        finder.missing("tile: tile");
    }
    Some(Columns { tile: tile?, part, size, magnet: found.pop()? })
}

/// Adds the tile of a row, or what is wrong with its numbers, else with the tile.
fn add(measured: &mut MeasuredBox, name: &str, columns: &Columns, cells: &mut Cells) {
    let part = columns.part.map(|column| cells.text(column).to_owned()).filter(|part| !part.is_empty());
    // Sides that are not given were not measured.
    let sides = columns.size.filter(|sides| !cells.are_empty(sides));
    let size_mm = sides.and_then(|sides| cells.vector(&sides));
    let magnet = match &columns.magnet {
        MagnetColumns::Polarization(columns) => cells.vector(columns).map(MeasuredMagnet::Polarization),
        MagnetColumns::Moment(columns) => cells.vector(columns).map(MeasuredMagnet::Moment),
        MagnetColumns::Strength(strength, angles) => {
            let strength_t = cells.number(*strength);
            match angles {
                Some(angles) => cells
                    .numbers(angles)
                    .map(|angles_deg| MeasuredMagnet::Polarization(strength_t * direction_from_degrees(angles_deg))),
                None => Some(MeasuredMagnet::Strength(strength_t)),
            }
        }
    };
    if let Some(magnet) = magnet.filter(|_| cells.faults.is_empty())
        && let Err(found) = measured.add(&MeasuredTile { name, part: part.as_deref(), size_mm, magnet })
    {
        cells.faults = found;
    }
}

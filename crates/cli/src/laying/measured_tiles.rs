//! Measured tiles from a CSV file, sorted by the parts of a layout.

use std::collections::HashMap;
use std::path::Path;

use magsplice::layout::{Layout, MAX_NAME_BYTES, Part, direction_from_degrees};
use magsplice::magnet::MU_0;
use magsplice::making::{CutTile, PlaceGroup};
use magsplice::prelude::DVec3;

use super::measured_columns::{self, MagnetColumns, MeasuredColumns};
use super::place_groups::place_groups;
use crate::csv_input::cells::{number, numbers, vector};
use crate::csv_input::limited_lines::shown;
use crate::csv_input::table::{CsvTable, Row};
use crate::failure::{Failure, PRINTED_FAULTS};
use crate::faults::FaultList;
use crate::text::number::counted;

/// Largest number of tiles of a box.
const MAX_TILES: usize = 100_000;

/// Factors between what is measured and what was ordered that no box of tiles has. Beyond them a unit is
/// wrong, or a tile is of another part.
const LEAST_FACTOR: f64 = 0.5;
const MOST_FACTOR: f64 = 2.0;

/// Angle from the direction that was ordered beyond which a tile was turned when it was measured.
const MOST_ANGLE_DEG: f64 = 45.0;

/// Cubic metres of a cubic millimetre.
const M3_PER_MM3: f64 = 1e-9;

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
    let parts = layout.parts();
    let reader = TileReader { columns: &columns, parts: &parts, names: part_names(layout, &parts) };
    let mut groups: Vec<PlaceGroup> = place_groups(layout);
    let (mut lines, mut has_sizes) = (HashMap::new(), false);
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
        match reader.tile(&mut table, line) {
            Ok((part, tile)) => {
                if let Some(first) = lines.insert(tile.name.clone(), line) {
                    let name = shown(&tile.name);
                    faults.add(line, format!("line {line}: tile \"{name}\" is in line {first} already"));
                }
                has_sizes |= tile.size_mm != parts[part].size_mm;
                groups[part].tiles.push(tile);
            }
            Err(found) => faults.add(line, format!("line {line}: {}", found.join("; "))),
        }
    }
    if !faults.is_empty() {
        return Err(faults.failure(place));
    }
    if lines.is_empty() {
        return Err(failed("has no tiles below its names of columns".to_owned()));
    }
    let ignored = columns.ignored.into_iter().take(PRINTED_FAULTS).collect();
    Ok(MeasuredTiles { groups, has_sizes, ignored })
}

/// The part that the name of each tile and of each kind stands for. Kinds of several parts are left out.
fn part_names<'a>(layout: &'a Layout, parts: &[Part]) -> HashMap<&'a str, usize> {
    let mut of_kinds: HashMap<&str, Option<usize>> = HashMap::new();
    let mut names = HashMap::new();
    for (number, part) in parts.iter().enumerate() {
        for named in part.tiles.iter().map(|&tile| &layout.tiles[tile]) {
            names.insert(named.name.as_str(), number);
            if let Some(kind) = &named.kind {
                let of_kind = of_kinds.entry(kind).or_insert(Some(number));
                *of_kind = of_kind.filter(|of_kind| *of_kind == number);
            }
        }
    }
    let kinds = of_kinds.into_iter().filter_map(|(kind, part)| Some((kind, part?)));
    kinds.for_each(|(kind, part)| {
        names.entry(kind).or_insert(part);
    });
    names
}

/// A part in words.
pub(crate) fn part_in_words(number: usize, size_mm: DVec3, places: usize) -> String {
    let DVec3 { x, y, z } = size_mm;
    format!("part {} ({x} x {y} x {z} mm, {})", number + 1, counted(places, "place", "places"))
}

struct TileReader<'a> {
    columns: &'a MeasuredColumns,
    parts: &'a [Part],
    names: HashMap<&'a str, usize>,
}

impl TileReader<'_> {
    /// The part and the tile of a row, or everything that is wrong with it.
    fn tile(&self, table: &mut CsvTable, line: u64) -> Result<(usize, CutTile), Vec<String>> {
        let mut faults = Vec::new();
        let name = table.cell(self.columns.tile.index).to_owned();
        if let Some(fault) = name_fault(&name) {
            faults.push(fault);
        }
        let size_mm = self.size_mm(table, line, &mut faults);
        let number = match self.part(table, size_mm) {
            Ok(number) => number,
            Err(fault) => {
                faults.push(fault);
                return Err(faults);
            }
        };
        let part = &self.parts[number];
        let size_mm = size_mm.unwrap_or(part.size_mm);
        for axis in 0..3 {
            let (size, ordered) = (size_mm[axis], part.size_mm[axis]);
            if !(LEAST_FACTOR..=MOST_FACTOR).contains(&(size / ordered)) {
                let side = ["first", "second", "third"][axis];
                faults.push(format!(
                    "the {side} side is {size} mm, must be within {LEAST_FACTOR} to {MOST_FACTOR} times the {ordered} mm \
                     of part {}",
                    number + 1
                ));
            }
        }
        let polarization_t = self.polarization_t(table, line, part, size_mm, &mut faults);
        if faults.is_empty()
            && let Some(fault) = polarization_fault(polarization_t, part, number)
        {
            faults.push(fault);
        }
        if faults.is_empty() { Ok((number, CutTile { name, polarization_t, size_mm })) } else { Err(faults) }
    }

    /// The sides, if they were measured.
    fn size_mm(&self, table: &mut CsvTable, line: u64, faults: &mut Vec<String>) -> Option<DVec3> {
        let columns = self.columns.size.as_ref()?;
        if columns.iter().all(|column| table.cell(column.index).is_empty()) {
            return None;
        }
        vector(columns, table, line, faults)
    }

    /// The number of the part of a row.
    fn part(&self, table: &CsvTable, size_mm: Option<DVec3>) -> Result<usize, String> {
        let cell = self.columns.part.map_or("", |column| table.cell(column.index));
        if !cell.is_empty() {
            let by_number = cell.parse().ok().filter(|number| (1..=self.parts.len()).contains(number));
            return by_number.map(|number: usize| number - 1).or_else(|| self.names.get(cell).copied()).ok_or_else(
                || {
                    format!(
                        "part = \"{}\", must be a number from 1 to {}, as `magsplice tiles` lists the parts, or the name \
                         of a tile or of a kind of one part",
                        shown(cell),
                        self.parts.len()
                    )
                },
            );
        }
        if let [_] = self.parts {
            return Ok(0);
        }
        let Some(size_mm) = size_mm else {
            return Err(format!("names no part, must have one of {} in a column part, or sizes", self.parts.len()));
        };
        // The nearest part, if no other is nearly as near: sizes of parts differ by more than cuts do.
        let mut by_distance: Vec<(f64, usize)> =
            self.parts.iter().enumerate().map(|(number, part)| ((part.size_mm - size_mm).length(), number)).collect();
        by_distance.sort_by(|a, b| a.0.total_cmp(&b.0));
        match by_distance[..] {
            [(near, number), (next, _), ..] if next > 2.0 * near && near < 0.25 * size_mm.length() => Ok(number),
            _ => {
                let DVec3 { x, y, z } = size_mm;
                Err(format!("its sizes ({x}, {y}, {z}) mm fit no part alone, must name one in a column part"))
            }
        }
    }

    /// The polarization along the sides of the part, in tesla.
    fn polarization_t(
        &self,
        table: &mut CsvTable,
        line: u64,
        part: &Part,
        size_mm: DVec3,
        faults: &mut Vec<String>,
    ) -> DVec3 {
        if let Some(columns) = self.columns.magnet.components() {
            let to_tesla = match self.columns.magnet {
                MagnetColumns::Magnetization(_) => MU_0,
                MagnetColumns::Moment(_) => MU_0 / (size_mm.element_product() * M3_PER_MM3),
                _ => 1.0,
            };
            return vector(&columns, table, line, faults).map_or(DVec3::ZERO, |v| v * to_tesla);
        }
        let MagnetColumns::Strength(strength, angles) = &self.columns.magnet else { return DVec3::ZERO };
        let strength_t = number(*strength, table, line, faults);
        let direction = match angles {
            Some(columns) => match numbers(columns, table, line, faults) {
                Some([direction_deg, tilt_deg]) => direction_from_degrees([direction_deg, tilt_deg]),
                None => DVec3::ZERO,
            },
            None => part.direction,
        };
        strength_t * direction
    }
}

fn name_fault(name: &str) -> Option<String> {
    if name.is_empty() {
        return Some("has no name in the column of tiles".to_owned());
    }
    if name.len() > MAX_NAME_BYTES {
        return Some(format!("tile \"{}\" has {} bytes, must have at most {MAX_NAME_BYTES}", shown(name), name.len()));
    }
    name.chars().any(char::is_control).then(|| format!("tile \"{}\" has control characters", shown(name)))
}

fn polarization_fault(polarization_t: DVec3, part: &Part, number: usize) -> Option<String> {
    let (strength_t, ordered_t) = (polarization_t.length(), part.strength_t);
    if ordered_t == 0.0 {
        return None;
    }
    if !(LEAST_FACTOR..=MOST_FACTOR).contains(&(strength_t / ordered_t)) {
        let shown_t = magsplice_export::twelve_digits(strength_t);
        return Some(format!(
            "its polarization is {shown_t} T, must be within {LEAST_FACTOR} to {MOST_FACTOR} times the {ordered_t} T of \
             part {}",
            number + 1
        ));
    }
    let angle_deg = polarization_t.angle_between(part.direction).to_degrees();
    (angle_deg > MOST_ANGLE_DEG).then(|| {
        format!(
            "its polarization is {angle_deg:.1} deg from that of part {}, must be within {MOST_ANGLE_DEG} deg: turn the \
             axes so that x is along the first side of the part, y along the second, as `magsplice tiles` lists them",
            number + 1
        )
    })
}

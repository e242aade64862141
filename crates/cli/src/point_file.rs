//! Points from a CSV file, read in batches.

use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};

use magsplice::prelude::DVec3;

use crate::args::points::LengthUnitArg;
use crate::csv_input::limited_lines::shown;
use crate::csv_input::names::unit_in;
use crate::csv_input::table::{CsvTable, Row, is_stdin};
use crate::failure::Failure;
use crate::faults::FaultList;
use crate::units::{self, LENGTHS};

/// Points read at a time, and in `field` evaluated and written at a time. Bounds the memory, and is
/// enough work for every thread.
pub(crate) const BATCH: usize = 1 << 16;

/// Largest number of points held in memory: those of a plan, of a baseline, and of a result that is
/// not written point by point. With their fields they take 5 GB.
pub(crate) const MAX_HELD_POINTS: usize = 100_000_000;

/// The line of names that messages show.
const EXAMPLE: &str = "x_mm,y_mm,z_mm";

const AXES: [&str; 3] = ["x", "y", "z"];

/// An open point file.
pub(crate) struct PointFile {
    path: PathBuf,
    table: CsvTable,
    /// The columns of x, y, z.
    columns: [LengthColumn; 3],
    /// Whether any row has been read.
    started: bool,
}

/// A column of lengths.
#[derive(Clone, Copy)]
pub(crate) struct LengthColumn {
    pub(crate) index: usize,
    /// Power of ten that converts its values to millimetres.
    pub(crate) exponent: i32,
}

/// Whether points are read from standard input on a terminal, where a person types them.
pub(crate) fn are_typed(path: Option<&Path>) -> bool {
    path.is_some_and(is_stdin) && io::stdin().is_terminal()
}

/// All points of a file, and the line of each.
///
/// `tell` prints a remark about the file.
pub(crate) fn read_all(
    path: &Path,
    unit: Option<LengthUnitArg>,
    tell: &dyn Fn(&str),
) -> Result<(Vec<DVec3>, Vec<u64>), Failure> {
    let mut file = PointFile::open(path, unit, tell)?;
    let mut faults = FaultList::default();
    let (mut all, mut all_lines) = (Vec::new(), Vec::new());
    let (mut points, mut lines) = (Vec::new(), Vec::new());
    loop {
        let more = file.read(BATCH, &mut points, &mut lines, &mut faults)?;
        all.extend_from_slice(&points);
        all_lines.extend_from_slice(&lines);
        if all.len() > MAX_HELD_POINTS {
            return Err(too_many_points(path));
        }
        if !more {
            break;
        }
    }
    if faults.is_empty() { Ok((all, all_lines)) } else { Err(faults.failure(path.display().to_string())) }
}

impl PointFile {
    /// Opens a file, or standard input for `-`, and reads the names of its columns. `unit` is that
    /// of columns without a unit in their names. `tell` prints a remark about the file.
    pub(crate) fn open(path: &Path, unit: Option<LengthUnitArg>, tell: &dyn Fn(&str)) -> Result<PointFile, Failure> {
        let failed = |message: String| Failure::Points { path: path.to_owned(), message };
        let has_names = |names: &[String]| AXES.iter().all(|axis| names.iter().any(|name| is_length(name, axis)));
        let table = CsvTable::open(path, has_names, EXAMPLE).map_err(failed)?;
        let columns = columns(&table.names, unit).map_err(|why| failed(format!("line {}: {why}", table.names_line)))?;
        if columns.iter().any(|column| column.exponent != columns[0].exponent) {
            let names = columns.map(|column| shown(&table.names[column.index])).join(", ");
            let (path, line) = (path.display(), table.names_line);
            tell(&format!("warning: {path}: line {line}: the coordinates have different units: {names}"));
        }
        Ok(PointFile { path: path.to_owned(), table, columns, started: false })
    }

    /// Replaces `points` by up to `limit` further points, and `lines` by their line numbers. Adds
    /// faulty lines to `faults`.
    ///
    /// Returns false at the end of the file.
    pub(crate) fn read(
        &mut self,
        limit: usize,
        points: &mut Vec<DVec3>,
        lines: &mut Vec<u64>,
        faults: &mut FaultList,
    ) -> Result<bool, Failure> {
        points.clear();
        lines.clear();
        while points.len() < limit {
            let failed = |message: String| Failure::Points { path: self.path.clone(), message };
            let line = match self.table.next_row().map_err(failed)? {
                Some(Row::Cells(line)) => line,
                Some(Row::Fault(line, fault)) => {
                    self.started = true;
                    faults.add(line, fault);
                    continue;
                }
                None if self.started => return Ok(false),
                None => return Err(failed("has no points below its names of columns".to_owned())),
            };
            self.started = true;
            let (mut point, mut wrong) = (DVec3::ZERO, Vec::new());
            for (axis, column) in self.columns.into_iter().enumerate() {
                match self.table.number(column.index, column.exponent, line) {
                    Ok(value) => point[axis] = value,
                    Err(fault) => wrong.push(fault),
                }
            }
            if wrong.is_empty() {
                points.push(point);
                lines.push(line);
            } else {
                faults.add(line, format!("line {line}: {}", wrong.join("; ")));
            }
        }
        Ok(true)
    }
}

/// The failure of a file with more than [`MAX_HELD_POINTS`].
pub(crate) fn too_many_points(path: &Path) -> Failure {
    let message = format!("has more than {MAX_HELD_POINTS} points, too many to hold in memory");
    Failure::Points { path: path.to_owned(), message }
}

/// Whether this is the name of a column of lengths along an axis, with a unit or without one.
pub(crate) fn is_length(name: &str, base: &str) -> bool {
    unit_in(name, base).is_some_and(|unit| unit.is_empty() || units::exponent(&LENGTHS, &unit).is_some())
}

/// The columns of x, y, z. A column with a unit comes before one without.
fn columns(names: &[String], unit: Option<LengthUnitArg>) -> Result<[LengthColumn; 3], String> {
    let named = |axis: &&'static str, has_unit: bool| -> Vec<usize> {
        let is_wanted =
            |name: &String| is_length(name, axis) && (unit_in(name, axis).as_deref() != Some("")) == has_unit;
        (0..names.len()).filter(|column| is_wanted(&names[*column])).collect()
    };
    let found = AXES.map(|axis| {
        let with_unit = named(&axis, true);
        if with_unit.is_empty() { named(&axis, false) } else { with_unit }
    });
    let quoted = |columns: &[usize]| columns.iter().map(|i| shown(&names[*i])).collect::<Vec<_>>().join(", ");
    let missing: Vec<String> = (0..3).filter(|i| found[*i].is_empty()).map(|i| format!("{}_mm", AXES[i])).collect();
    if !missing.is_empty() {
        let found = shown(&names.join(","));
        return Err(format!("no column {}, must have {EXAMPLE} (found: {found})", missing.join(", ")));
    }
    let repeated: Vec<usize> = found.iter().filter(|columns| columns.len() > 1).flatten().copied().collect();
    if !repeated.is_empty() {
        return Err(format!("more than one column of a coordinate: {}, must have one of each", quoted(&repeated)));
    }
    let found = found.map(|columns| columns[0]);
    let unit_of = |axis: usize| unit_in(&names[found[axis]], AXES[axis]).unwrap_or_default();
    let bare: Vec<usize> = (0..3).filter(|axis| unit_of(*axis).is_empty()).map(|axis| found[axis]).collect();
    match unit {
        None if !bare.is_empty() => {
            let columns = if bare.len() == 1 { "column" } else { "columns" };
            return Err(format!(
                "{columns} {} without a unit: name it, as in {EXAMPLE}, or give --unit mm or --unit m",
                quoted(&bare)
            ));
        }
        Some(given) => {
            let others: Vec<usize> =
                (0..3).filter(|axis| !["", given.name()].contains(&&*unit_of(*axis))).map(|axis| found[axis]).collect();
            if !others.is_empty() {
                let (columns, given) = (quoted(&others), given.name());
                return Err(format!("{columns} contradicts --unit {given}: leave out the option or rename the column"));
            }
        }
        None => {}
    }
    let exponent = |axis: usize| match &*unit_of(axis) {
        "" => unit.and_then(|unit| units::exponent(&LENGTHS, unit.name())),
        unit => units::exponent(&LENGTHS, unit),
    };
    Ok([0, 1, 2].map(|axis| LengthColumn { index: found[axis], exponent: exponent(axis).unwrap_or(0) }))
}

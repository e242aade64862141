//! Points from a CSV file, read in batches or all.

use std::path::Path;

use magsplice::prelude::DVec3;
use magsplice::results::Points;

use crate::args::points::{LengthUnitArg, PointsArgs};
use crate::csv_input::finder::{Column, Finder};
use crate::csv_input::quantities::POSITION;
use crate::csv_input::rows::{Form, Rows};
use crate::failure::Failure;
use crate::faults::FaultList;
use crate::session::{OF_POINTS, Session};
use crate::units;

/// Points read at a time, and in `field` evaluated and written at a time. Bounds the memory, and is
/// enough work for every thread.
pub(crate) const BATCH: usize = 1 << 16;

/// Largest number of points held in memory: those of a plan, of a baseline, and of a result that is
/// not written point by point. With their fields they take 5 GB.
pub(crate) const MAX_HELD_POINTS: usize = 100_000_000;

const TOO_MANY: &str = ", too many to hold in memory";

/// The line of names that messages show.
const EXAMPLE: &str = "x_mm,y_mm,z_mm";

const AXES: [&str; 3] = ["x", "y", "z"];

/// An open point file.
pub(crate) struct PointFile(Rows<[Column; 3]>);

/// All points of a file, and the line of each.
///
/// `tell` prints a remark about the file.
pub(crate) fn read_all(
    path: &Path,
    unit: Option<LengthUnitArg>,
    tell: &dyn Fn(&str),
) -> Result<(Vec<DVec3>, Vec<u64>), Failure> {
    open(path, unit, MAX_HELD_POINTS, tell)?.read_all(|columns, cells| cells.vector(columns))
}

/// The points of a file, or without one the working volume, and words for where they are from.
pub(crate) fn given(session: &Session, args: &PointsArgs) -> Result<(Points, String), Failure> {
    let Some(path) = args.path() else {
        return Ok((Points::Grid(session.volume(OF_POINTS)?.grid), "points of the working volume".to_owned()));
    };
    let (points, _) = read_all(path, args.unit, &|remark| session.tell(remark))?;
    Ok((Points::Scattered(points), format!("points of {}", path.display())))
}

impl PointFile {
    /// Opens a file, or standard input for `-`, and reads the names of its columns. `unit` is that
    /// of columns without a unit in their names. `tell` prints a remark about the file.
    pub(crate) fn open(path: &Path, unit: Option<LengthUnitArg>, tell: &dyn Fn(&str)) -> Result<PointFile, Failure> {
        open(path, unit, usize::MAX, tell).map(PointFile)
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
            match self.0.next(faults, |columns, cells| cells.vector(columns))? {
                Some(Some((point, line))) => {
                    points.push(point);
                    lines.push(line);
                }
                Some(None) => {}
                None => return Ok(false),
            }
        }
        Ok(true)
    }
}

fn open(
    path: &Path,
    unit: Option<LengthUnitArg>,
    most: usize,
    tell: &dyn Fn(&str),
) -> Result<Rows<[Column; 3]>, Failure> {
    let form = Form { rows: "points", most, too_many: TOO_MANY };
    let rows = Rows::open(path, form, EXAMPLE, |names| POSITION.is_among(names), |finder| columns(finder, unit))?;
    if rows.columns.iter().any(|column| column.exponent != rows.columns[0].exponent) {
        let (path, line, names) = (path.display(), rows.names_line(), rows.names(&rows.columns));
        tell(&format!("warning: {path}: line {line}: the coordinates have different units: {names}"));
    }
    Ok(rows)
}

/// The failure of a file with more than [`MAX_HELD_POINTS`].
pub(crate) fn too_many_points(path: &Path) -> Failure {
    Failure::at(path, format!("has more than {MAX_HELD_POINTS} points{TOO_MANY}"))
}

/// The columns of x, y, z, or `None` after adding a fault.
fn columns(finder: &mut Finder, unit: Option<LengthUnitArg>) -> Option<[Column; 3]> {
    let found = POSITION.columns.map(|axis| finder.columns(&POSITION, axis));
    let missing: Vec<String> = (0..3).filter(|i| found[*i].is_empty()).map(|i| format!("{}_mm", AXES[i])).collect();
    if !missing.is_empty() {
        let (missing, found) = (missing.join(", "), finder.names_found());
        finder.fault(format!("no column {missing}, must have {EXAMPLE} (found: {found})"));
        return None;
    }
    let repeated = finder.listed(found.iter().filter(|columns| columns.len() > 1).flatten().map(|(column, _)| column));
    if !repeated.is_empty() {
        finder.fault(format!("more than one column of a coordinate: {repeated}, must have one of each"));
    }
    let given = unit.and_then(|unit| units::find(POSITION.units, unit.name()));
    let found = found.map(|columns| columns[0]);
    let bare: Vec<&Column> = found.iter().filter(|(_, has_unit)| !has_unit).map(|(column, _)| column).collect();
    match given {
        None if !bare.is_empty() => {
            let (columns, names) = (if bare.len() == 1 { "column" } else { "columns" }, finder.listed(bare));
            finder.fault(format!(
                "{columns} {names} without a unit: rename, as in {EXAMPLE}, or give --unit mm or --unit m"
            ));
        }
        Some(given) => {
            let others = found.iter().filter(|(column, has_unit)| *has_unit && column.exponent != given.exponent);
            let (others, given) = (finder.listed(others.map(|(column, _)| column)), given.name);
            if !others.is_empty() {
                finder.fault(format!("{others} contradicts --unit {given}: leave out the option or rename the column"));
            }
        }
        None => {}
    }
    Some(found.map(|(column, has_unit)| match given {
        Some(unit) if !has_unit => Column { exponent: unit.exponent, ..column },
        _ => column,
    }))
}

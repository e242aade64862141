//! Points from a CSV file, read in batches or all.

use std::path::Path;

use magsplice::prelude::DVec3;
use magsplice::results::Points;

use crate::args::given_units::GivenUnits;
use crate::args::points::PointsArgs;
use crate::csv_input::finder::Column;
use crate::csv_input::quantities::POSITION;
use crate::csv_input::rows::{Form, Rows};
use crate::failure::Failure;
use crate::faults::FaultList;
use crate::session::{OF_POINTS, Session};

/// Points read at a time, and in `field` evaluated and written at a time. Bounds the memory, and is
/// enough work for every thread.
pub(crate) const BATCH: usize = 1 << 16;

/// Largest number of points held in memory: those of a plan, of a baseline, and of a result that is
/// not written point by point. With their fields they take 5 GB.
pub(crate) const MAX_HELD_POINTS: usize = 100_000_000;

const TOO_MANY: &str = ", too many to hold in memory";

/// An open point file.
pub(crate) struct PointFile(Rows<[Column; 3]>);

/// All points of a file, and the line of each.
///
/// `tell` prints a remark about the file.
pub(crate) fn read_all(
    path: &Path,
    units: Option<&GivenUnits>,
    tell: &dyn Fn(&str),
) -> Result<(Vec<DVec3>, Vec<u64>), Failure> {
    open(path, units, MAX_HELD_POINTS, tell)?.read_all(tell, |columns, cells| cells.vector(columns))
}

/// The points of a file, or without one the working volume, and words for where they are from.
pub(crate) fn given(session: &Session, args: &PointsArgs) -> Result<(Points, String), Failure> {
    let Some(path) = args.path() else {
        return Ok((Points::Grid(session.volume(OF_POINTS)?.grid), "points of the working volume".to_owned()));
    };
    let (points, _) = read_all(path, args.unit.as_ref(), &|remark| session.tell(remark))?;
    Ok((Points::Scattered(points), format!("points of {}", path.display())))
}

impl PointFile {
    /// Opens a file, or standard input for `-`, and reads the names of its columns. `units` are
    /// those of columns without a unit in their names. `tell` prints a remark about the file.
    pub(crate) fn open(path: &Path, units: Option<&GivenUnits>, tell: &dyn Fn(&str)) -> Result<PointFile, Failure> {
        open(path, units, usize::MAX, tell).map(PointFile)
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
    units: Option<&GivenUnits>,
    most: usize,
    tell: &dyn Fn(&str),
) -> Result<Rows<[Column; 3]>, Failure> {
    let form = Form { rows: "points", most, too_many: TOO_MANY, is_log: false };
    let (example, no_units) = (POSITION.example(), GivenUnits::default());
    let units = Some(units.unwrap_or(&no_units));
    let rows =
        Rows::open(path, form, &example, units, |names| POSITION.fit(names), |finder| finder.required(&POSITION))?;
    if let Some(remark) = rows.remark_on_units(&rows.columns, "the coordinates") {
        tell(&remark);
    }
    Ok(rows)
}

/// The failure of a file with more than [`MAX_HELD_POINTS`].
pub(crate) fn too_many_points(path: &Path) -> Failure {
    Failure::at(path, format!("has more than {MAX_HELD_POINTS} points{TOO_MANY}"))
}

//! Baselines of `check`: the field of a working volume as CSV, as `magsplice field` writes it.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use magsplice::expect::Baseline;
use magsplice::magnet::Grid;
use magsplice::prelude::DVec3;
use magsplice::results::{ColumnQuantity, Metadata, Points, Table};

use crate::csv_input::limited_lines::{LimitedLines, read_error, shown};
use crate::failure::Failure;
use crate::faults::FaultList;
use crate::inputs::points::{MAX_HELD_POINTS, too_many_points};
use crate::output::destination::Output;

const COLUMNS: [&str; 6] = ["x_mm", "y_mm", "z_mm", "bx_t", "by_t", "bz_t"];

/// Reads a baseline. The failure lists all faulty lines.
pub(super) fn read(path: &Path) -> Result<Baseline, Failure> {
    let failed = |message: String| Failure::at(path, message);
    let file = regular_file(path)
        .map_err(|e| failed(format!("cannot read this baseline: {e} (`magsplice check --update` writes it)")))?;
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(LimitedLines::new(file));
    let header = reader.headers().map_err(|e| failed(read_error(&e)))?;
    let places = COLUMNS.map(|column| header.iter().position(|h| h == column));
    let missing: Vec<&str> = COLUMNS.into_iter().zip(places).filter(|(_, at)| at.is_none()).map(|(c, _)| c).collect();
    if !missing.is_empty() {
        return Err(failed(format!("line 1: no column {}, must have {}", missing.join(", "), COLUMNS.join(","))));
    }
    let places = places.map(|at| at.expect("no column is missing"));
    let mut baseline = Baseline::default();
    let mut faults = FaultList::default();
    for record in reader.records() {
        let record = match record {
            Ok(record) => record,
            Err(error) if error.is_io_error() => return Err(failed(read_error(&error))),
            Err(error) => {
                faults.add(error.position().map_or(0, csv::Position::line), read_error(&error));
                continue;
            }
        };
        let values = places.map(|at| record[at].parse::<f64>().ok().filter(|value| value.is_finite()));
        if let [Some(x), Some(y), Some(z), Some(bx), Some(by), Some(bz)] = values {
            if baseline.points.len() == MAX_HELD_POINTS {
                return Err(too_many_points(path));
            }
            baseline.points.push(DVec3::new(x, y, z));
            baseline.field_t.push(DVec3::new(bx, by, bz));
            continue;
        }
        let line = record.position().map_or(0, csv::Position::line);
        let wrong = (0..COLUMNS.len()).filter(|&i| values[i].is_none());
        let wrong: Vec<String> = wrong.map(|i| format!("{} = \"{}\"", COLUMNS[i], shown(&record[places[i]]))).collect();
        faults.add(line, format!("line {line}: {}, must be a finite number", wrong.join(", ")));
    }
    if faults.is_empty() { Ok(baseline) } else { Err(faults.failure(path.display())) }
}

/// Opens a file. A device or a pipe may have no end, so it is an error.
fn regular_file(path: &Path) -> io::Result<File> {
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::other("it is not a regular file"));
    }
    File::open(path)
}

/// Refuses a place for a baseline where there is anything but an earlier baseline.
pub(super) fn check_replaceable(path: &Path) -> Result<(), Failure> {
    let failed = |error| Failure::write(path, error);
    let file = match regular_file(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        file => file.map_err(failed)?,
    };
    let header = COLUMNS.join(",");
    let mut start = Vec::new();
    // One more than the header: the end of its line.
    file.take(header.len() as u64 + 1).read_to_end(&mut start).map_err(failed)?;
    if start.trim_ascii_end() != header.as_bytes() {
        let why =
            format!("it does not begin with {header}, the line of a baseline, and would be lost: delete it first");
        return Err(failed(io::Error::other(why)));
    }
    Ok(())
}

/// Writes the field of a grid as a baseline, complete or not at all. Replaces an earlier baseline,
/// and no other file.
pub(super) fn write(path: &Path, layout: &Path, grid: &Grid, field_t: &[DVec3]) -> Result<(), Failure> {
    check_replaceable(path)?;
    let mut output = Output::open(Some(path), &[layout])?;
    let table = Table::new(Points::Grid(*grid), vec![ColumnQuantity::flux_density(field_t)], Metadata::new());
    output.write(|w| magsplice_export::csv::write(&table, w))?;
    output.finish()
}

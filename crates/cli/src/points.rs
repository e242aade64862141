//! Points from a CSV file, in batches.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use csv::{ReaderBuilder, StringRecord, Trim};
use magsplice::prelude::DVec3;

use crate::failure::{Failure, PRINTED_FAULTS};

const COLUMNS: [&str; 3] = ["x_mm", "y_mm", "z_mm"];

/// A point file being read.
pub(crate) struct PointFile {
    path: PathBuf,
    reader: csv::Reader<Box<dyn Read>>,
    /// Where x_mm, y_mm, z_mm are.
    columns: [usize; 3],
    record: StringRecord,
    /// Whether any record has been read.
    started: bool,
}

/// A faulty line: its number and what is wrong with it.
pub(crate) type LineFault = String;

impl PointFile {
    pub(crate) fn open(path: &Path) -> Result<PointFile, Failure> {
        let failed = |message: String| Failure::Points { path: path.to_owned(), message };
        let source: Box<dyn Read> = if path == Path::new("-") {
            Box::new(io::stdin())
        } else {
            Box::new(File::open(path).map_err(|e| failed(format!("cannot read: {e}")))?)
        };
        let mut reader = ReaderBuilder::new().trim(Trim::All).from_reader(source);
        let header = reader.headers().map_err(|e| failed(read_error(&e)))?.clone();
        if header.is_empty() {
            return Err(failed("is empty, must begin with a line x_mm,y_mm,z_mm".to_owned()));
        }
        let count = |column: &str| header.iter().filter(|h| *h == column).count();
        let named =
            |wrong: fn(usize) -> bool| COLUMNS.into_iter().filter(|c| wrong(count(c))).collect::<Vec<_>>().join(", ");
        let (missing, repeated) = (named(|n| n == 0), named(|n| n > 1));
        if !missing.is_empty() {
            let found = header.iter().collect::<Vec<_>>().join(",");
            return Err(failed(format!("line 1: no column {missing}, must have x_mm,y_mm,z_mm (found: {found})")));
        }
        if !repeated.is_empty() {
            return Err(failed(format!("line 1: more than one column {repeated}, must have one of each")));
        }
        let columns = COLUMNS.map(|c| header.iter().position(|h| h == c).expect("no column is missing"));
        Ok(PointFile { path: path.to_owned(), reader, columns, record: StringRecord::new(), started: false })
    }

    /// Fills `points` and the numbers of their `lines` with up to `limit` further points; faulty lines go to `faults`.
    ///
    /// Returns false at the end of the file.
    pub(crate) fn read(
        &mut self,
        limit: usize,
        points: &mut Vec<DVec3>,
        lines: &mut Vec<u64>,
        faults: &mut Faults,
    ) -> Result<bool, Failure> {
        points.clear();
        lines.clear();
        while points.len() < limit {
            match self.reader.read_record(&mut self.record) {
                Ok(true) => self.started = true,
                Ok(false) if !self.started => {
                    return Err(Failure::Points { path: self.path.clone(), message: "has no points".to_owned() });
                }
                Ok(false) => return Ok(false),
                Err(error)
                    if matches!(error.kind(), csv::ErrorKind::UnequalLengths { .. } | csv::ErrorKind::Utf8 { .. }) =>
                {
                    self.started = true;
                    if self.record.iter().any(|field| !field.is_empty()) {
                        faults.add(self.record.position().map_or(0, csv::Position::line), read_error(&error));
                    }
                    continue;
                }
                Err(error) => return Err(Failure::Points { path: self.path.clone(), message: read_error(&error) }),
            }
            let line = self.record.position().map_or(0, csv::Position::line);
            match point(&self.record, self.columns, line) {
                Ok(point) => {
                    points.push(point);
                    lines.push(line);
                }
                Err(fault) => faults.add(line, fault),
            }
        }
        Ok(true)
    }
}

fn point(record: &StringRecord, columns: [usize; 3], line: u64) -> Result<DVec3, LineFault> {
    let mut point = DVec3::ZERO;
    let mut wrong = Vec::new();
    for axis in 0..3 {
        let text = &record[columns[axis]];
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => point[axis] = value,
            _ => wrong.push(format!("{} = \"{text}\"", COLUMNS[axis])),
        }
    }
    if wrong.is_empty() {
        Ok(point)
    } else {
        Err(format!("line {line}: {}, must be a finite number", wrong.join(", ")))
    }
}

pub(crate) fn read_error(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::Io(io) => format!("cannot read: {io}"),
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            let line = pos.as_ref().map_or(0, csv::Position::line);
            format!("line {line}: has {len} fields, must have {expected_len} like the first line")
        }
        csv::ErrorKind::Utf8 { pos, .. } => {
            format!("line {}: is not UTF-8 text", pos.as_ref().map_or(0, csv::Position::line))
        }
        _ => error.to_string(),
    }
}

/// Faults to print, the first few in words and in the order of their lines, the rest by number.
#[derive(Default)]
pub(crate) struct Faults {
    named: Vec<(u64, String)>,
    more: usize,
}

impl Faults {
    /// Adds a fault of a line; 0 where there are no lines.
    pub(crate) fn add(&mut self, line: u64, fault: String) {
        if self.named.len() < PRINTED_FAULTS {
            self.named.push((line, fault));
        } else {
            self.more += 1;
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.named.is_empty()
    }

    /// The faults as the reason the program could not do its work.
    pub(crate) fn failure(mut self, place: String) -> Failure {
        self.named.sort_by_key(|(line, _)| *line);
        Failure::Faults { place, faults: self.named.into_iter().map(|(_, fault)| fault).collect(), more: self.more }
    }
}

//! Points from a CSV file, read in batches.

use std::fs::File;
use std::io::{self, IsTerminal, Read};
use std::path::{Path, PathBuf};

use csv::{ReaderBuilder, StringRecord, Trim};
use magsplice::prelude::DVec3;

use crate::failure::Failure;
use crate::faults::FaultList;

/// Points read at a time, and in `field` evaluated and written at a time. Bounds the memory, and is
/// enough work for every thread.
pub(crate) const BATCH: usize = 1 << 16;

/// Largest number of points held in memory: those of a plan, of a baseline, and of a result that is
/// not written point by point. With their fields they take 5 GB.
pub(crate) const MAX_HELD_POINTS: usize = 100_000_000;

/// Longest line of a file of numbers. A file without ends of lines is no such file, and a device
/// may have no end.
const MAX_LINE_BYTES: usize = 64 << 10;

/// Largest number of characters that a message shows of a line.
const MAX_SHOWN: usize = 200;

const COLUMNS: [&str; 3] = ["x_mm", "y_mm", "z_mm"];

/// An open point file.
pub(crate) struct PointFile {
    path: PathBuf,
    reader: csv::Reader<Box<dyn Read>>,
    /// Indices of the columns x_mm, y_mm, z_mm.
    columns: [usize; 3],
    record: StringRecord,
    /// Whether any record has been read.
    started: bool,
}

/// Whether this path names standard input.
pub(crate) fn is_stdin(path: &Path) -> bool {
    path == Path::new("-")
}

/// Whether points are read from standard input on a terminal, where a person types them.
pub(crate) fn are_typed(path: Option<&Path>) -> bool {
    path.is_some_and(is_stdin) && io::stdin().is_terminal()
}

/// All points of a file.
pub(crate) fn read_all(path: &Path) -> Result<Vec<DVec3>, Failure> {
    let mut file = PointFile::open(path)?;
    let mut faults = FaultList::default();
    let (mut all, mut points, mut lines) = (Vec::new(), Vec::new(), Vec::new());
    loop {
        let more = file.read(BATCH, &mut points, &mut lines, &mut faults)?;
        all.extend_from_slice(&points);
        if all.len() > MAX_HELD_POINTS {
            return Err(too_many_points(path));
        }
        if !more {
            break;
        }
    }
    if faults.is_empty() { Ok(all) } else { Err(faults.failure(path.display().to_string())) }
}

impl PointFile {
    /// Opens a file, or standard input for `-`, and reads its first line.
    pub(crate) fn open(path: &Path) -> Result<PointFile, Failure> {
        let failed = |message: String| Failure::Points { path: path.to_owned(), message };
        let source: Box<dyn Read> = if is_stdin(path) {
            Box::new(io::stdin())
        } else {
            Box::new(File::open(path).map_err(|e| failed(format!("cannot read: {e}")))?)
        };
        let source: Box<dyn Read> = Box::new(LimitedLines::new(source));
        let mut reader = ReaderBuilder::new().trim(Trim::All).from_reader(source);
        let header = reader.headers().map_err(|e| failed(read_error(&e)))?.clone();
        if header.is_empty() {
            return Err(failed("is empty, must begin with the line x_mm,y_mm,z_mm".to_owned()));
        }
        let count = |column: &str| header.iter().filter(|h| *h == column).count();
        let named =
            |wrong: fn(usize) -> bool| COLUMNS.into_iter().filter(|c| wrong(count(c))).collect::<Vec<_>>().join(", ");
        let (missing, repeated) = (named(|n| n == 0), named(|n| n > 1));
        if !missing.is_empty() {
            let found = shown(&header.iter().collect::<Vec<_>>().join(","));
            return Err(failed(format!("line 1: no column {missing}, must have x_mm,y_mm,z_mm (found: {found})")));
        }
        if !repeated.is_empty() {
            return Err(failed(format!("line 1: more than one column {repeated}, must have one of each")));
        }
        let columns = COLUMNS.map(|c| header.iter().position(|h| h == c).expect("no column is missing"));
        Ok(PointFile { path: path.to_owned(), reader, columns, record: StringRecord::new(), started: false })
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
            match self.reader.read_record(&mut self.record) {
                Ok(true) => self.started = true,
                Ok(false) if !self.started => {
                    return Err(Failure::Points {
                        path: self.path.clone(),
                        message: "has no points below its first line".to_owned(),
                    });
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

/// The failure of a file with more than [`MAX_HELD_POINTS`].
pub(crate) fn too_many_points(path: &Path) -> Failure {
    let message = format!("has more than {MAX_HELD_POINTS} points, too many to hold in memory");
    Failure::Points { path: path.to_owned(), message }
}

/// The beginning of a field.
pub(crate) fn shown(text: &str) -> String {
    text.chars().take(MAX_SHOWN).collect()
}

/// A reader that fails at a line longer than [`MAX_LINE_BYTES`].
pub(crate) struct LimitedLines<R> {
    source: R,
    /// Bytes since the last end of a line.
    line_bytes: usize,
}

impl<R> LimitedLines<R> {
    pub(crate) fn new(source: R) -> LimitedLines<R> {
        LimitedLines { source, line_bytes: 0 }
    }
}

impl<R: Read> Read for LimitedLines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.source.read(buffer)?;
        // The reader above reads less than a line at a time, so that the line at its end decides.
        match buffer[..count].iter().rposition(|byte| matches!(byte, b'\n' | b'\r')) {
            Some(end) => self.line_bytes = count - end - 1,
            None => self.line_bytes += count,
        }
        if self.line_bytes > MAX_LINE_BYTES {
            return Err(io::Error::other(format!("a line has more than {MAX_LINE_BYTES} bytes")));
        }
        Ok(count)
    }
}

/// The point of a record, or the values that are no numbers.
fn point(record: &StringRecord, columns: [usize; 3], line: u64) -> Result<DVec3, String> {
    let mut point = DVec3::ZERO;
    let mut wrong = Vec::new();
    for axis in 0..3 {
        let text = &record[columns[axis]];
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => point[axis] = value,
            _ => wrong.push(format!("{} = \"{}\"", COLUMNS[axis], shown(text))),
        }
    }
    if wrong.is_empty() {
        Ok(point)
    } else {
        Err(format!("line {line}: {}, must be a finite number", wrong.join(", ")))
    }
}

/// An error of the CSV reader in words.
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

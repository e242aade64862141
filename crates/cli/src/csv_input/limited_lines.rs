//! A reader that fails at a line without an end, and messages about files of numbers.

use std::io::{self, Read};

/// Longest line of a file of numbers. A file without ends of lines is no such file, and a device
/// may have no end.
const MAX_LINE_BYTES: usize = 64 << 10;

/// Largest number of characters that a message shows of a line.
const MAX_SHOWN: usize = 200;

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

/// The beginning of a field.
pub(crate) fn shown(text: &str) -> String {
    text.chars().take(MAX_SHOWN).collect()
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

//! Marks between the cells of a line: comma, semicolon, tab, or spaces.

use std::io::{self, Read};

use csv::{ReaderBuilder, StringRecord, Trim};

/// What stands between the cells of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Separator {
    Comma,
    Semicolon,
    Tab,
    /// One or more spaces or tabs; those at the ends of a line do not count.
    Spaces,
}

impl Separator {
    /// In the order in which they are tried.
    pub(crate) const ALL: [Separator; 4] = [Separator::Comma, Separator::Semicolon, Separator::Tab, Separator::Spaces];

    /// The separator as messages name it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Separator::Comma => "commas",
            Separator::Semicolon => "semicolons",
            Separator::Tab => "tabs",
            Separator::Spaces => "spaces",
        }
    }

    /// Whether a comma may be the decimal mark of a number between such separators. Between spaces
    /// it may not: `1, 2, 3` is a line with commas.
    pub(crate) fn allows_decimal_comma(self) -> bool {
        matches!(self, Separator::Semicolon | Separator::Tab)
    }

    /// The separator between two cells.
    pub(crate) fn mark(self) -> char {
        match self {
            Separator::Comma => ',',
            Separator::Semicolon => ';',
            Separator::Tab => '\t',
            Separator::Spaces => ' ',
        }
    }

    /// The cells of one line, without the spaces around them.
    pub(crate) fn cells(self, line: &str) -> Vec<String> {
        let mut record = StringRecord::new();
        // Nothing but text that was read before is read, so that there is no error.
        let _ = self.reader(Box::new(io::Cursor::new(line.to_owned().into_bytes()))).read_record(&mut record);
        let mut cells: Vec<String> = Vec::new();
        for cell in &record {
            match cells.last_mut() {
                // The unit of `x (mm)` belongs to its name, also between spaces.
                Some(name) if self == Separator::Spaces && cell.starts_with(['(', '[']) => name.push_str(cell),
                _ => cells.push(cell.to_owned()),
            }
        }
        cells
    }

    /// A reader of rows with this separator. Lines that begin with `#` are comments.
    pub(crate) fn reader(self, source: Box<dyn Read>) -> csv::Reader<Box<dyn Read>> {
        let source = if self == Separator::Spaces { Box::new(SingleSpaces::new(source)) } else { source };
        ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(Trim::All)
            .comment(Some(b'#'))
            .delimiter(self.mark() as u8)
            .from_reader(source)
    }
}

/// The separator that divides a line into this number of cells, if it is another one than `than`.
pub(crate) fn other_than(than: Separator, line: &str, cells: usize) -> Option<Separator> {
    let divides = |separator: &Separator| {
        let found = separator.cells(line);
        found.len() == cells && found.iter().all(|cell| !cell.is_empty())
    };
    Separator::ALL.into_iter().filter(|separator| *separator != than).find(divides)
}

/// Replaces each run of spaces and tabs by one space, and removes those at the ends of lines.
struct SingleSpaces<R> {
    source: R,
    /// Whether a run of spaces is still to be written.
    pending: bool,
    /// Whether nothing of the line has been written.
    at_start: bool,
}

impl<R> SingleSpaces<R> {
    fn new(source: R) -> SingleSpaces<R> {
        SingleSpaces { source, pending: false, at_start: true }
    }
}

impl<R: Read> Read for SingleSpaces<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        // A pending space adds one byte to what is read.
        let room = buffer.len().saturating_sub(1);
        if room == 0 {
            return Err(io::Error::other("a buffer of one byte is too small"));
        }
        loop {
            let mut bytes = vec![0; room];
            let count = self.source.read(&mut bytes)?;
            if count == 0 {
                return Ok(0);
            }
            let mut kept = 0;
            for &byte in &bytes[..count] {
                match byte {
                    b' ' | b'\t' => self.pending = !self.at_start,
                    b'\n' | b'\r' => {
                        (self.pending, self.at_start) = (false, true);
                        buffer[kept] = byte;
                        kept += 1;
                    }
                    _ => {
                        if self.pending {
                            buffer[kept] = b' ';
                            kept += 1;
                        }
                        (self.pending, self.at_start) = (false, false);
                        buffer[kept] = byte;
                        kept += 1;
                    }
                }
            }
            // Nothing kept is not the end of the source.
            if kept > 0 {
                return Ok(kept);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_spaces_are_one_separator() {
        let line = "  x_mm\t y (mm)  z [mm] \"a b\" ";
        assert_eq!(Separator::Spaces.cells(line), ["x_mm", "y(mm)", "z[mm]", "a b"]);
    }

    #[test]
    fn spaces_are_joined_across_reads() {
        // A source that gives one byte at a time.
        struct Single<'a>(&'a [u8]);
        impl Read for Single<'_> {
            fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
                self.0.read(&mut buffer[..1])
            }
        }
        let mut text = String::new();
        SingleSpaces::new(Single(b"  1 \t 2\r\n \n3   \n  4 ")).read_to_string(&mut text).expect("text");
        assert_eq!(text, "1 2\r\n\n3\n4");
    }

    #[test]
    fn other_separators_are_recognized() {
        assert_eq!(other_than(Separator::Comma, "1;2;3", 3), Some(Separator::Semicolon));
        assert_eq!(other_than(Separator::Spaces, "1, 2, 3", 3), Some(Separator::Comma));
        assert_eq!(other_than(Separator::Comma, "1 2 3", 3), Some(Separator::Spaces));
        assert_eq!(other_than(Separator::Comma, "1;2", 3), None);
    }
}

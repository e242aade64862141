//! Marks between the cells of a line: comma, semicolon, tab, or spaces.

use std::io::{self, Read};

use csv::{ReaderBuilder, StringRecord, Trim};

use super::content_lines::{ContentLines, LineForm, Lines};

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
        let (mut reader, _) = self.reader(Box::new(io::Cursor::new(line.to_owned().into_bytes())), 0);
        let _ = reader.read_record(&mut record);
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

    /// A reader of rows with this separator, without comments and blank lines, and what is known
    /// of their lines.
    pub(crate) fn reader(self, source: Box<dyn Read>, lines_before: u64) -> (csv::Reader<Box<dyn Read>>, Lines) {
        // Between semicolons the first cell of a line may be empty.
        let comments: &[u8] = if self == Separator::Semicolon { b"#%" } else { b"#%;" };
        let form = LineForm { separator: self.mark() as u8, comments };
        let content = ContentLines::new(source, form, lines_before);
        let lines = content.lines();
        let mut builder = ReaderBuilder::new();
        builder.has_headers(false).flexible(true).trim(Trim::All).delimiter(self.mark() as u8);
        (builder.from_reader(Box::new(content)), lines)
    }
}

/// The separator that divides a line into this number of cells, if it is another one than `than`.
pub(crate) fn other_than(than: Separator, line: &str, cells: usize) -> Option<Separator> {
    let divides = |separator: &Separator| {
        // A reader takes far longer than this look.
        let is_mark = |c: char| c == separator.mark() || (*separator == Separator::Spaces && c == '\t');
        if cells > 1 && !line.contains(is_mark) {
            return false;
        }
        let found = separator.cells(line);
        found.len() == cells && found.iter().all(|cell| !cell.is_empty())
    };
    Separator::ALL.into_iter().filter(|separator| *separator != than).find(divides)
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
    fn other_separators_are_recognized() {
        assert_eq!(other_than(Separator::Comma, "1;2;3", 3), Some(Separator::Semicolon));
        assert_eq!(other_than(Separator::Spaces, "1, 2, 3", 3), Some(Separator::Comma));
        assert_eq!(other_than(Separator::Comma, "1 2 3", 3), Some(Separator::Spaces));
        assert_eq!(other_than(Separator::Comma, "1;2", 3), None);
    }
}

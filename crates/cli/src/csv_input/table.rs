//! A table of numbers that is read row by row: names of columns, then one row per line.
//!
//! The separator is the one under which the line of names has the wanted names. Lines that begin
//! with `#`, `%` or `;` are comments.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufRead, BufReader, IsTerminal, Read};
use std::path::Path;

use csv::StringRecord;
use magsplice::layout::decimal;

use super::content_lines::Lines;
use super::limited_lines::{LimitedLines, read_error, shown};
use super::names_line::{self, NamesLine, not_utf8};
use super::quantities::Fit;
use super::separator::{Separator, other_than};

/// An open table.
pub(crate) struct CsvTable {
    /// The names of the columns.
    pub(crate) names: Vec<String>,
    /// The line of the names.
    pub(crate) names_line: u64,
    separator: Separator,
    reader: csv::Reader<Box<dyn Read>>,
    record: StringRecord,
    /// What is known of the lines that `reader` reads.
    lines: Lines,
    /// Number of rows that were read.
    rows: usize,
    /// Least number of decimals of their last cells.
    least_decimals: usize,
    /// Rows without any value that another row follows: their lines, and that row.
    empty: VecDeque<u64>,
    after_empty: Option<StringRecord>,
    /// Whether a cut last line is no fault.
    may_be_cut: bool,
    /// The first decimal mark that was not the only possible one, and its line.
    decimal_mark: Option<(char, u64)>,
}

/// A row that was read.
pub(crate) enum Row {
    /// The row has a cell for each name. Its line.
    Cells(u64),
    /// All cells of the row are empty, and another row follows. Its line.
    Empty(u64),
    /// The file ends within this line.
    Cut(u64),
    /// Why the row cannot be used: its line, and the words for it.
    Fault(u64, String),
}

/// Largest number of rows without values in sequence, whose lines are held in memory.
const MOST_EMPTY_ROWS: usize = 1_000_000;

/// Number of rows from which on their decimals are those of every row.
const LEAST_ROWS: usize = 10;

/// Whether this path names standard input.
pub(crate) fn is_stdin(path: &Path) -> bool {
    path == Path::new("-")
}

/// Whether points are read from standard input on a terminal, where a person types them.
pub(crate) fn are_typed(path: Option<&Path>) -> bool {
    path.is_some_and(is_stdin) && io::stdin().is_terminal()
}

impl CsvTable {
    /// Opens a file, or standard input for `-`, and reads the names of its columns.
    ///
    /// `fit` decides how well a line is the line of names, and `may_be_cut` whether a cut last line
    /// is no fault. If no line is, the table has the names of the line above its numbers, for the
    /// message of the caller. `example` is a line of names.
    pub(crate) fn open(
        path: &Path,
        fit: &dyn Fn(&[String]) -> Fit,
        example: &str,
        may_be_cut: bool,
    ) -> Result<CsvTable, String> {
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
            return Err(format!("is a layout (TOML), must be a table (CSV) that begins with a line such as {example}"));
        }
        let source: Box<dyn Read> = if is_stdin(path) {
            Box::new(io::stdin())
        } else {
            Box::new(File::open(path).map_err(|e| format!("cannot read: {e}"))?)
        };
        let mut source = BufReader::new(LimitedLines::new(source));
        check_is_text(source.fill_buf().map_err(|e| format!("cannot read: {e}"))?)?;
        let NamesLine { names, line, separator, rest, lines_before } = names_line::find(source, fit, example)?;
        let (reader, lines) = separator.reader(rest, lines_before);
        Ok(CsvTable {
            names,
            names_line: line,
            separator,
            reader,
            record: StringRecord::new(),
            lines,
            rows: 0,
            least_decimals: usize::MAX,
            empty: VecDeque::new(),
            after_empty: None,
            may_be_cut,
            decimal_mark: None,
        })
    }

    /// Reads the next row that is not blank; `None` at the end of the file.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub(crate) fn next_row(&mut self) -> Result<Option<Row>, String> {
        if let Some(line) = self.empty.pop_front() {
            return Ok(Some(Row::Empty(line)));
        }
        if let Some(record) = self.after_empty.take() {
            self.record = record;
            return self.row(self.record_line()).map(Some);
        }
        loop {
            match self.reader.read_record(&mut self.record) {
                Ok(true) => {}
                // Spreadsheets end a table with lines of separators alone.
                Ok(false) => return Ok(None),
                Err(error) => match error.kind() {
                    csv::ErrorKind::Utf8 { pos, .. } => {
                        let line = self.lines.in_file(pos.as_ref().map_or(0, csv::Position::line));
                        return Ok(Some(Row::Fault(line, not_utf8(line))));
                    }
                    _ => return Err(read_error(&error)),
                },
            }
            let line = self.record_line();
            if !self.record.iter().all(str::is_empty) {
                let Some(first) = self.empty.pop_front() else { return self.row(line).map(Some) };
                self.after_empty = Some(self.record.clone());
                return Ok(Some(Row::Empty(first)));
            }
            if self.empty.len() == MOST_EMPTY_ROWS {
                return Err(format!("line {line}: has more than {MOST_EMPTY_ROWS} empty rows in sequence"));
            }
            self.empty.push_back(line);
        }
    }

    /// The line of the record that was read last.
    fn record_line(&self) -> u64 {
        self.lines.in_file(self.record.position().map_or(0, csv::Position::line))
    }

    /// The record as a row.
    fn row(&mut self, line: u64) -> Result<Row, String> {
        let is_short = self.record.len() < self.names.len();
        if self.rows == 0 {
            self.check_form(line)?;
        } else if self.may_be_cut && self.lines.is_last_cut() && (is_short || self.is_last_number_cut()) {
            return Ok(Row::Cut(line));
        }
        self.rows += 1;
        self.least_decimals = self.least_decimals.min(self.last_decimals());
        Ok(if self.record.len() == self.names.len() {
            Row::Cells(line)
        } else {
            Row::Fault(line, self.wrong_count(line))
        })
    }

    /// Whether the last cell is the beginning of a number, such as `1.2e-`, or has fewer decimals
    /// than those of all rows before.
    fn is_last_number_cut(&self) -> bool {
        if self.rows >= LEAST_ROWS && self.last_decimals() < self.least_decimals {
            return true;
        }
        let last = self.record.iter().next_back().unwrap_or_default();
        let is_number = |text: &str| decimal::scaled(text, 0).is_some();
        !last.is_empty() && !is_number(last) && is_number(&format!("{last}0"))
    }

    /// Number of decimals of the last cell.
    fn last_decimals(&self) -> usize {
        let last = self.record.iter().next_back().unwrap_or_default();
        last.rsplit_once(['.', ',']).map_or(0, |(_, decimals)| decimals.len())
    }

    /// Refuses the file if its first row has another separator than the names, or decimal commas
    /// that cannot be told from separators. All further rows would be refused one by one.
    fn check_form(&self, line: u64) -> Result<(), String> {
        let (found, wanted) = (self.record.len(), self.names.len());
        if found != wanted {
            let is_form = other_than(self.separator, &self.text(), wanted).is_some() || self.has_decimal_commas();
            return if is_form { Err(self.wrong_count(line)) } else { Ok(()) };
        }
        if self.separator != Separator::Spaces {
            return Ok(());
        }
        // Between spaces a separator stays at the end of every cell but the last.
        let cells: Vec<&str> = self.record.iter().collect();
        let ends: Vec<Option<Separator>> = cells.iter().take(wanted - 1).map(|cell| trailing(cell)).collect();
        match ends[..] {
            [Some(other), ..] if ends.iter().all(|end| *end == Some(other)) => Err(self.wrong_separator(line, other)),
            _ => {
                let is_decimal =
                    |cell: &&str| cell.parse::<f64>().is_err() && cell.replacen(',', ".", 1).parse::<f64>().is_ok();
                match cells.iter().find(|cell| is_decimal(cell)) {
                    Some(cell) => Err(format!(
                        "line {line}: {} has a decimal comma: separate the columns by semicolons or tabs, or write decimal points",
                        shown(cell)
                    )),
                    None => Ok(()),
                }
            }
        }
    }

    /// Whether a row between commas has as many more cells as decimal commas may make.
    fn has_decimal_commas(&self) -> bool {
        let (found, wanted) = (self.record.len(), self.names.len());
        self.separator == Separator::Comma
            && (wanted + 1..=2 * wanted).contains(&found)
            && self.record.iter().all(|cell| !cell.is_empty())
    }

    /// The cells of the last row with their separators.
    fn text(&self) -> String {
        self.record.iter().collect::<Vec<_>>().join(&self.separator.mark().to_string())
    }

    /// Words for a row whose number of cells is not that of the names.
    fn wrong_count(&self, line: u64) -> String {
        let (found, wanted) = (self.record.len(), self.names.len());
        if let Some(other) = other_than(self.separator, &self.text(), wanted) {
            return self.wrong_separator(line, other);
        }
        let hint = if self.has_decimal_commas() { " (with decimal commas, separate by semicolons)" } else { "" };
        let fields = if found == 1 { "field" } else { "fields" };
        format!("line {line}: has {found} {fields}, must have {wanted} like line {}{hint}", self.names_line)
    }

    fn wrong_separator(&self, line: u64, other: Separator) -> String {
        let (other, own) = (other.name(), self.separator.name());
        format!("line {line}: is separated by {other}, must be separated by {own} like line {}", self.names_line)
    }

    /// The text of a cell of the last row.
    pub(crate) fn cell(&self, column: usize) -> &str {
        &self.record[column]
    }

    /// The name of a column and the text of its cell of the last row, for messages.
    pub(crate) fn quoted(&self, column: usize) -> String {
        format!("{} = \"{}\"", shown(&self.names[column]), shown(self.cell(column)))
    }

    /// The number in a cell of the row on this line, times a power of ten, or the words for what is
    /// wrong with it.
    pub(crate) fn number(&mut self, column: usize, exponent: i32, line: u64) -> Result<f64, String> {
        let text = &self.record[column];
        let mark = match (text.contains(','), text.contains('.')) {
            (true, false) if self.separator.allows_decimal_comma() => Some(','),
            (false, true) => Some('.'),
            _ => None,
        };
        let written = if mark == Some(',') { text.replacen(',', ".", 1) } else { text.to_owned() };
        let refused = |rule: &str| format!("{}, {rule}", self.quoted(column));
        let Some(value) = decimal::scaled(&written, exponent) else {
            let cells = other_than(self.separator, text, 2).or_else(|| trailing(text));
            return Err(match cells {
                Some(other) if other != Separator::Spaces && !self.separator.allows_decimal_comma() => {
                    refused(&format!(
                        "must be a finite number; {} are not the separators of line {}",
                        other.name(),
                        self.names_line
                    ))
                }
                _ => refused("must be a finite number"),
            });
        };
        // A comma can also divide thousands, so that two marks in one file are ambiguous.
        match (mark, self.decimal_mark) {
            (Some(mark), Some((other, first))) if mark != other => {
                let name = |mark| if mark == ',' { "comma" } else { "point" };
                let (mark, other) = (name(mark), name(other));
                return Err(refused(&format!("has a decimal {mark}, must have a decimal {other} like line {first}")));
            }
            (Some(mark), None) if self.separator.allows_decimal_comma() => self.decimal_mark = Some((mark, line)),
            _ => {}
        }
        Ok(value)
    }
}

/// Refuses the files that spreadsheets write instead of UTF-8 text, by their beginning.
fn check_is_text(beginning: &[u8]) -> Result<(), String> {
    let begins = |magic: &[u8]| beginning.starts_with(magic);
    if begins(b"PK\x03\x04") || begins(b"\xd0\xcf\x11\xe0") {
        return Err("is a workbook (.xlsx, .ods or .xls), must be text: save it as CSV".to_owned());
    }
    // Without a byte order mark every other byte of plain text is 0.
    let zeros: Vec<bool> = beginning.iter().take(4).map(|byte| *byte == 0).collect();
    let alternates = zeros == [false, true, false, true] || zeros == [true, false, true, false];
    let is_utf16 = begins(b"\xff\xfe") || begins(b"\xfe\xff") || alternates;
    if is_utf16 {
        return Err("is UTF-16 text, must be UTF-8: save it as CSV UTF-8".to_owned());
    }
    Ok(())
}

/// The separator at the end of a cell.
fn trailing(text: &str) -> Option<Separator> {
    match text.chars().last() {
        Some(',') => Some(Separator::Comma),
        Some(';') => Some(Separator::Semicolon),
        _ => None,
    }
}

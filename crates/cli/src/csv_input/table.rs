//! A table of numbers that is read row by row: names of columns, then one row per line.
//!
//! The separator is the one under which the line of names has the wanted names. Lines that begin
//! with `#` are comments. The last of them before the numbers may hold the names, as
//! `numpy.savetxt` writes them.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, IsTerminal, Read};
use std::path::Path;

use csv::StringRecord;
use magsplice::layout::decimal;

use super::content_lines::LineNumbers;
use super::limited_lines::{LimitedLines, read_error, shown};
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
    /// Numbers of the lines that `reader` reads.
    numbers: LineNumbers,
    /// Whether no row has been read yet.
    is_before_rows: bool,
    /// The first decimal mark that was not the only possible one, and its line.
    decimal_mark: Option<(char, u64)>,
}

/// A row that was read.
pub(crate) enum Row {
    /// The row has a cell for each name. Its line.
    Cells(u64),
    /// Why the row cannot be used: its line, and the words for it.
    Fault(u64, String),
}

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
    /// `has_names` says whether a line is the line of names. If no line is, the table has the names
    /// of its first line, for the message of the caller. `example` is a line of names.
    pub(crate) fn open(path: &Path, has_names: impl Fn(&[String]) -> bool, example: &str) -> Result<CsvTable, String> {
        let source: Box<dyn Read> = if is_stdin(path) {
            Box::new(io::stdin())
        } else {
            Box::new(File::open(path).map_err(|e| format!("cannot read: {e}"))?)
        };
        let mut source = BufReader::new(LimitedLines::new(source));
        check_is_text(source.fill_buf().map_err(|e| format!("cannot read: {e}"))?)?;
        let find = |line: &str| {
            let cells = Separator::ALL.into_iter().map(|separator| (separator, separator.cells(line)));
            cells.into_iter().find(|(_, names)| has_names(names))
        };
        let mut lines = 0;
        let mut in_comment: Option<(Separator, Vec<String>, u64)> = None;
        loop {
            let Some(bytes) = line(&mut source)? else {
                return match in_comment {
                    Some(_) => Err("has no points below its names of columns".to_owned()),
                    None => Err(format!("is empty, must begin with the line {example}")),
                };
            };
            let number = lines + 1;
            lines += 1;
            let text = std::str::from_utf8(&bytes).map_err(|_| not_utf8(number))?;
            let text = text.trim_start_matches('\u{feff}').trim_end_matches(['\r', '\n']);
            if text.trim().is_empty() || number == 1 && names_separator(text) {
                continue;
            }
            if let Some(comment) = text.trim_start().strip_prefix('#') {
                if let Some((separator, names)) = find(comment) {
                    in_comment = Some((separator, names, number));
                }
                continue;
            }
            if let Some((separator, names)) = find(text) {
                return Ok(CsvTable::new(names, number, separator, Box::new(source), lines));
            }
            if let Some((separator, names, names_line)) = in_comment {
                // A comment need not have the separator of the numbers.
                let separator = other_than(separator, text, names.len())
                    .filter(|_| separator.cells(text).len() != names.len())
                    .unwrap_or(separator);
                let before = number - 1;
                let rest = Box::new(Cursor::new(bytes).chain(source));
                return Ok(CsvTable::new(names, names_line, separator, rest, before));
            }
            check_separators(text, number, &has_names)?;
            let most = |separator: &Separator| separator.cells(text).len();
            // The first of those with the most cells.
            let separator = Separator::ALL.into_iter().rev().max_by_key(most).unwrap_or(Separator::Comma);
            let names = separator.cells(text);
            if names.iter().all(|name| name.parse::<f64>().is_ok()) {
                return Err(format!("line {number}: has no names of columns, must begin with the line {example}"));
            }
            return Ok(CsvTable::new(names, number, separator, Box::new(source), lines));
        }
    }

    fn new(
        names: Vec<String>,
        names_line: u64,
        separator: Separator,
        source: Box<dyn Read>,
        lines_before: u64,
    ) -> CsvTable {
        let (reader, numbers) = separator.reader(source, lines_before);
        CsvTable {
            names,
            names_line,
            separator,
            reader,
            record: StringRecord::new(),
            numbers,
            is_before_rows: true,
            decimal_mark: None,
        }
    }

    /// Reads the next row that is not blank; `None` at the end of the file.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub(crate) fn next_row(&mut self) -> Result<Option<Row>, String> {
        loop {
            match self.reader.read_record(&mut self.record) {
                Ok(true) => {}
                Ok(false) => return Ok(None),
                Err(error) => match error.kind() {
                    csv::ErrorKind::Utf8 { pos, .. } => {
                        let line = self.numbers.in_file(pos.as_ref().map_or(0, csv::Position::line));
                        return Ok(Some(Row::Fault(line, not_utf8(line))));
                    }
                    _ => return Err(read_error(&error)),
                },
            }
            let line = self.numbers.in_file(self.record.position().map_or(0, csv::Position::line));
            // Spreadsheets end a table with lines of separators alone.
            if self.record.iter().all(str::is_empty) {
                continue;
            }
            let is_first = std::mem::replace(&mut self.is_before_rows, false);
            if is_first {
                self.check_form(line)?;
            }
            return Ok(Some(if self.record.len() == self.names.len() {
                Row::Cells(line)
            } else {
                Row::Fault(line, self.wrong_count(line))
            }));
        }
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

/// Words for a line that is not UTF-8.
fn not_utf8(line: u64) -> String {
    format!("line {line}: is not UTF-8 text: save it as CSV UTF-8")
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

/// Whether this is the line `sep=;`, by which Excel learns the separator of a file. The line of
/// names shows it too.
fn names_separator(text: &str) -> bool {
    let text = text.trim_matches(['"', ' ', ',', ';', '\t']).to_lowercase();
    text.strip_prefix("sep=").is_some_and(|mark| mark.chars().count() <= 1)
}

/// The separator at the end of a cell.
fn trailing(text: &str) -> Option<Separator> {
    match text.chars().last() {
        Some(',') => Some(Separator::Comma),
        Some(';') => Some(Separator::Semicolon),
        _ => None,
    }
}

/// Refuses a line of names that more than one separator divides, or one that is none.
fn check_separators(text: &str, line: u64, has_names: &impl Fn(&[String]) -> bool) -> Result<(), String> {
    let cells = |marks: &[char]| -> Vec<String> { text.split(marks).map(|name| name.trim().to_owned()).collect() };
    let used = |mark: char| text.contains(mark);
    let named = [(',', "commas"), (';', "semicolons"), ('\t', "tabs"), ('|', "bars"), (':', "colons")];
    let found: Vec<&str> = named.into_iter().filter(|(mark, _)| used(*mark)).map(|(_, name)| name).collect();
    let divided = has_names(&cells(&[',', ';', '\t', '|', ':'])) || has_names(&cells(&[',', ';', '\t', ' ', '|', ':']));
    if !divided {
        return Ok(());
    }
    Err(match found[..] {
        [one] => format!("line {line}: is separated by {one}, must be separated by commas, semicolons, tabs or spaces"),
        _ => format!("line {line}: mixes {} between its names, must have one separator", found.join(" and ")),
    })
}

/// The next line with its end, or `None` at the end of the source.
fn line(source: &mut BufReader<LimitedLines<Box<dyn Read>>>) -> Result<Option<Vec<u8>>, String> {
    let mut line = Vec::new();
    loop {
        let available = source.fill_buf().map_err(|e| format!("cannot read: {e}"))?;
        if available.is_empty() {
            return Ok((!line.is_empty()).then_some(line));
        }
        let end = available.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let taken = end.map_or(available.len(), |end| end + 1);
        line.extend_from_slice(&available[..taken]);
        source.consume(taken);
        if end.is_some() {
            // A line feed after a carriage return belongs to the same end.
            let is_return = line.ends_with(b"\r");
            if is_return && source.fill_buf().is_ok_and(|next| next.starts_with(b"\n")) {
                source.consume(1);
            }
            return Ok(Some(line));
        }
    }
}

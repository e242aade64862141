//! The line of a table that has the names of its columns.
//!
//! Lines before it are skipped: the name of an instrument, a date, comments. The names may be in a
//! comment, as `numpy.savetxt` writes them. A line below the names may have their units. Rows begin
//! below the names.

use std::io::{BufRead, BufReader, Cursor, Read};

use super::limited_lines::LimitedLines;
use super::quantities::Fit;
use super::separator::{Separator, other_than};

/// Largest number of lines before the line of names, and between names without units and the first
/// row of numbers. Files of instruments have up to some tens.
const MOST_LINES_BEFORE: usize = 1000;

type Source = BufReader<LimitedLines<Box<dyn Read>>>;

/// The names of a table, and what follows them.
pub(super) struct NamesLine {
    pub(super) names: Vec<String>,
    pub(super) line: u64,
    pub(super) separator: Separator,
    /// The lines below the names, and the number of lines before them.
    pub(super) rest: Box<dyn Read>,
    pub(super) lines_before: u64,
}

/// A line of names, and the lines after it.
#[derive(Clone)]
struct Candidate {
    names: Vec<String>,
    line: u64,
    separator: Separator,
    is_comment: bool,
    /// The lines after it, and their number.
    after: Vec<u8>,
    lines_after: usize,
}

/// The search for the line of names.
struct Search<'f> {
    fit: &'f dyn Fn(&[String]) -> Fit,
    /// Names without units, or in a comment: better ones may follow.
    candidate: Option<Candidate>,
    /// The last line, and the first with the most cells. They are shown if there are no names: the
    /// names should be above the numbers.
    last: Option<Candidate>,
    widest: Option<Candidate>,
    /// What is wrong with the separators of a line that has all names.
    mixed: Option<String>,
}

/// Finds the names of a table. `fit` decides how well a line has them. If no line does, these are
/// the names of the line above the first numbers, for the message of the caller. `example` is a
/// line of names.
pub(super) fn find(mut source: Source, fit: &dyn Fn(&[String]) -> Fit, example: &str) -> Result<NamesLine, String> {
    let mut search = Search { fit, candidate: None, last: None, widest: None, mixed: None };
    let mut number = 0;
    loop {
        let bytes = line(&mut source)?;
        number += u64::from(bytes.is_some());
        let text = match &bytes {
            Some(bytes) => std::str::from_utf8(bytes).map_err(|_| not_utf8(number))?,
            None => "",
        };
        let text = text.trim_start_matches('\u{feff}').trim_end_matches(['\r', '\n']);
        let is_blank = text.trim().is_empty() || number == 1 && names_separator(text);
        let found = if bytes.is_none() { None } else { search.names(text, number).filter(|_| !is_blank) };
        if let Some((fit, found)) = found {
            if fit == Fit::Complete && !found.is_comment {
                return Ok(found.with_rest(number, Box::new(source)));
            }
            if !found.is_comment || search.candidate.as_ref().is_none_or(|candidate| candidate.is_comment) {
                search.candidate = Some(found);
            }
            continue;
        }
        let is_over = bytes.is_none() || number as usize > MOST_LINES_BEFORE;
        let is_row = !is_blank && !is_comment(text) && is_numbers(text);
        if let Some(candidate) = &mut search.candidate {
            if let Some(names) = candidate.names_with_units(text).filter(|names| fit(names) == Fit::Complete) {
                return Ok(Candidate { names, ..candidate.clone() }.with_rest(number, Box::new(source)));
            }
            candidate.after.extend(bytes.iter().flatten());
            candidate.lines_after += usize::from(bytes.is_some());
            if is_row || bytes.is_none() || candidate.lines_after > MOST_LINES_BEFORE {
                return Ok(search.candidate.take().expect("it is there").with_row(text, source));
            }
            continue;
        }
        if is_row || is_over {
            return match (search.mixed, if is_row { search.last } else { search.widest }) {
                (Some(mixed), _) => Err(mixed),
                (None, Some(other)) => Ok(other.with_rest(number, Box::new(source))),
                (None, None) if is_row => {
                    Err(format!("line {number}: has no names of columns, must begin with the line {example}"))
                }
                (None, None) => Err(format!("is empty, must begin with the line {example}")),
            };
        }
        if !is_blank && !is_comment(text) {
            search.remember(text, number);
        }
    }
}

impl Search<'_> {
    /// The names in a line or a comment, if it has them.
    fn names(&self, text: &str, line: u64) -> Option<(Fit, Candidate)> {
        let best = |text: &str, is_comment: bool| {
            let found = Separator::ALL.into_iter().map(|separator| {
                let names = separator.cells(text);
                let fit = (self.fit)(&names);
                (fit, Candidate { names, line, separator, is_comment, after: Vec::new(), lines_after: 0 })
            });
            // The first of the best.
            found.rev().max_by_key(|(fit, _)| *fit).filter(|(fit, _)| *fit != Fit::None)
        };
        // Between semicolons the first name may be empty.
        let is_row = |(_, found): &(Fit, Candidate)| found.separator == Separator::Semicolon;
        match is_comment(text) {
            false => best(text, false),
            true if text.trim_start().starts_with(';') => {
                best(text, false).filter(is_row).or_else(|| best(uncommented(text), true))
            }
            true => best(uncommented(text), true),
        }
    }

    /// Keeps a line for the message about missing names.
    fn remember(&mut self, text: &str, line: u64) {
        if self.mixed.is_none() {
            self.mixed = mixed_separators(text, line, self.fit);
        }
        let (names, separator) = cells(text);
        let (after, lines_after) = (Vec::new(), 0);
        let found = Candidate { names, line, separator, is_comment: false, after, lines_after };
        if self.widest.as_ref().is_none_or(|widest| widest.names.len() < found.names.len()) {
            self.widest = Some(found.clone());
        }
        self.last = Some(found);
    }
}

impl Candidate {
    fn with_rest(self, lines_before: u64, rest: Box<dyn Read>) -> NamesLine {
        NamesLine { names: self.names, line: self.line, separator: self.separator, rest, lines_before }
    }

    /// The names with the units of a line below them, such as `mm,mm,mm,mT,mT,mT`. A name whose
    /// cell is empty has no unit.
    fn names_with_units(&self, text: &str) -> Option<Vec<String>> {
        let units = self.separator.cells(text);
        let with_unit = |(name, unit): (&String, &String)| match unit.trim_matches(['(', ')', '[', ']']).trim() {
            "" => name.clone(),
            unit => format!("{name} ({unit})"),
        };
        (units.len() == self.names.len()).then(|| self.names.iter().zip(&units).map(with_unit).collect())
    }

    /// The names with the lines after them, of which `row` is the last.
    fn with_row(mut self, row: &str, source: Source) -> NamesLine {
        // A comment need not have the separator of the numbers.
        if self.is_comment && self.separator.cells(row).len() != self.names.len() {
            self.separator = other_than(self.separator, row, self.names.len()).unwrap_or(self.separator);
        }
        let (line, after) = (self.line, std::mem::take(&mut self.after));
        self.with_rest(line, Box::new(Cursor::new(after).chain(source)))
    }
}

/// Words for a line that is not UTF-8.
pub(super) fn not_utf8(line: u64) -> String {
    format!("line {line}: is not UTF-8 text: save it as CSV UTF-8")
}

fn is_comment(text: &str) -> bool {
    text.trim_start().starts_with(COMMENTS)
}

fn uncommented(text: &str) -> &str {
    text.trim_start().trim_start_matches(COMMENTS)
}

/// What comments begin with.
const COMMENTS: [char; 3] = ['#', '%', ';'];

/// The cells of a line between the separator that gives the most of them.
fn cells(text: &str) -> (Vec<String>, Separator) {
    let cells = Separator::ALL.into_iter().map(|separator| (separator.cells(text), separator));
    // The first of those with the most cells.
    cells.rev().max_by_key(|(cells, _)| cells.len()).unwrap_or((Vec::new(), Separator::Comma))
}

/// Whether a line is a row of several numbers.
fn is_numbers(text: &str) -> bool {
    let cells = text.split([',', ';', '\t', ' ']).map(|cell| cell.trim_matches('"')).filter(|cell| !cell.is_empty());
    let (mut count, mut numbers) = (0, 0);
    for cell in cells {
        count += 1;
        numbers += usize::from(cell.parse::<f64>().is_ok());
    }
    count > 1 && numbers == count
}

/// Words for a line of names that more than one separator divides, or one that is none.
fn mixed_separators(text: &str, line: u64, fit: &dyn Fn(&[String]) -> Fit) -> Option<String> {
    let fits = |marks: &[char]| {
        fit(&text.split(marks).map(|name| name.trim().to_owned()).collect::<Vec<String>>()) != Fit::None
    };
    if !fits(&[',', ';', '\t', '|', ':']) && !fits(&[',', ';', '\t', ' ', '|', ':']) {
        return None;
    }
    let named = [(',', "commas"), (';', "semicolons"), ('\t', "tabs"), ('|', "bars"), (':', "colons")];
    let found: Vec<&str> = named.into_iter().filter(|(mark, _)| text.contains(*mark)).map(|(_, name)| name).collect();
    match found[..] {
        [one @ ("bars" | "colons")] => {
            Some(format!("line {line}: is separated by {one}, must be separated by commas, semicolons, tabs or spaces"))
        }
        [_, _, ..] => {
            Some(format!("line {line}: mixes {} between its names, must have one separator", found.join(" and ")))
        }
        _ => None,
    }
}

/// Whether this is the line `sep=;`, by which Excel learns the separator of a file. The line of
/// names shows it too.
fn names_separator(text: &str) -> bool {
    let text = text.trim_matches(['"', ' ', ',', ';', '\t']).to_lowercase();
    text.strip_prefix("sep=").is_some_and(|mark| mark.chars().count() <= 1)
}

/// The next line with its end, or `None` at the end of the source.
fn line(source: &mut Source) -> Result<Option<Vec<u8>>, String> {
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

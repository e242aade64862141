//! The rows of a table as values, with the numbers of their lines.

use std::path::{Path, PathBuf};

use magsplice::prelude::DVec3;

use super::finder::{Column, Finder};
use super::quantities::Fit;
use super::table::{CsvTable, Row};
use crate::args::given_units::GivenUnits;
use crate::failure::{Failure, PRINTED_FAULTS};
use crate::faults::FaultList;

/// What a table holds, for messages.
pub(crate) struct Form {
    /// The things of which each row is one; empty for tables that may have no row.
    pub(crate) rows: &'static str,
    /// Largest number of rows, and what a message says of more.
    pub(crate) most: usize,
    pub(crate) too_many: &'static str,
    /// Whether the rows are measured one after the other: a row without values is then a missing
    /// measurement, and a last line that is cut is left out.
    pub(crate) is_log: bool,
}

/// An open table with its columns.
pub(crate) struct Rows<C> {
    path: PathBuf,
    form: Form,
    table: CsvTable,
    pub(crate) columns: C,
    /// The first of the columns that are not read.
    pub(crate) ignored: Vec<String>,
    /// Number of rows that were read.
    count: usize,
    /// The rows that were left out.
    pub(crate) left_out: FaultList,
}

/// The cells of a row, and what is wrong with them.
pub(crate) struct Cells<'a> {
    table: &'a mut CsvTable,
    pub(crate) line: u64,
    /// Whether the row has no values.
    is_empty: bool,
    pub(crate) faults: Vec<String>,
    /// Why the row is left out.
    left_out: Option<String>,
}

impl<C> Rows<C> {
    /// Opens a file, or standard input for `-`, and finds its columns. `fit` decides how well a
    /// line is the line of names; `example` is one for messages. `units` are those of `--unit`, if
    /// the verb has this option.
    ///
    /// # Errors
    /// If the file cannot be read, or `find` has no columns. The failure lists its faults.
    pub(crate) fn open(
        path: &Path,
        form: Form,
        example: &str,
        units: Option<&GivenUnits>,
        fit: impl Fn(&[String]) -> Fit,
        find: impl FnOnce(&mut Finder) -> Option<C>,
    ) -> Result<Rows<C>, Failure> {
        let failed = |message: String| Failure::at(path, message);
        let table = CsvTable::open(path, &fit, example, form.is_log).map_err(failed)?;
        let mut finder = Finder::new(&table.names, units);
        let found = find(&mut finder);
        finder.check_given_units();
        let found = found.filter(|_| finder.faults.is_empty());
        let mut ignored = finder.unused();
        ignored.truncate(PRINTED_FAULTS);
        let Some(columns) = found else {
            let (mut faults, line) = (FaultList::default(), table.names_line);
            finder.faults.into_iter().for_each(|fault| faults.add(line, format!("line {line}: {fault}")));
            return Err(faults.failure(path.display()));
        };
        let (path, left_out) = (path.to_owned(), FaultList::default());
        Ok(Rows { path, form, table, columns, ignored, count: 0, left_out })
    }

    /// The names of columns, as the file has them.
    fn names(&self, columns: &[Column]) -> String {
        Finder::new(&self.table.names, None).listed(columns)
    }

    /// The remark on columns of one vector, such as "the coordinates", with different units.
    pub(crate) fn remark_on_units(&self, columns: &[Column], what: &str) -> Option<String> {
        // A count is another flux density along each axis.
        let is_other = |column: &Column| !column.unit.is_count && !column.unit.is_same(columns[0].unit);
        let (path, line) = (self.path.display(), self.table.names_line);
        columns
            .iter()
            .any(is_other)
            .then(|| format!("warning: {path}: line {line}: {what} have different units: {}", self.names(columns)))
    }

    /// The value of the next row with its line, or nothing for a row that has none. `None` at the
    /// end. The faults that `value` leaves in the cells are added to `faults`.
    pub(crate) fn next<T>(
        &mut self,
        faults: &mut FaultList,
        value: impl FnOnce(&C, &mut Cells) -> Option<T>,
    ) -> Result<Option<Option<(T, u64)>>, Failure> {
        let failed = |message: String| Failure::at(&self.path, message);
        let Form { rows, most, too_many, is_log } = self.form;
        let row = self.table.next_row().map_err(failed)?;
        let is_empty = matches!(row, Some(Row::Empty(_)));
        self.count += usize::from(row.is_some() && (is_log || !is_empty));
        match row {
            Some(_) if self.count > most => Err(failed(format!("has more than {most} {rows}{too_many}"))),
            Some(Row::Empty(_)) if !is_log => Ok(Some(None)),
            Some(Row::Cells(line) | Row::Empty(line)) => {
                let faultless = Vec::new();
                let mut cells = Cells { table: &mut self.table, line, is_empty, faults: faultless, left_out: None };
                let value = value(&self.columns, &mut cells);
                let (found, left_out) = (cells.faults, cells.left_out);
                if !found.is_empty() {
                    faults.add(line, format!("line {line}: {}", found.join("; ")));
                    return Ok(Some(None));
                }
                if let Some(reason) = left_out {
                    self.left_out.add(line, format!("line {line}: left out: {reason}"));
                    return Ok(Some(None));
                }
                Ok(Some(value.map(|value| (value, line))))
            }
            Some(Row::Cut(line)) => {
                self.left_out.add(line, format!("line {line}: left out: the file ends within this line"));
                Ok(Some(None))
            }
            Some(Row::Fault(line, fault)) => {
                faults.add(line, fault);
                Ok(Some(None))
            }
            None if self.count == 0 && !rows.is_empty() => {
                Err(failed(format!("has no {rows} below its names of columns")))
            }
            None => Ok(None),
        }
    }

    /// The values of all rows, and their lines. `tell` prints which rows were left out. The failure
    /// lists all rows with faults.
    pub(crate) fn read_all<T>(
        mut self,
        tell: &dyn Fn(&str),
        mut value: impl FnMut(&C, &mut Cells) -> Option<T>,
    ) -> Result<(Vec<T>, Vec<u64>), Failure> {
        let (mut values, mut lines, mut faults) = (Vec::new(), Vec::new(), FaultList::default());
        while let Some(row) = self.next(&mut faults, &mut value)? {
            if let Some((value, line)) = row {
                values.push(value);
                lines.push(line);
            }
        }
        if !faults.is_empty() {
            return Err(faults.failure(self.path.display()));
        }
        if !self.left_out.is_empty() {
            tell(&self.left_out.remarks(self.path.display()));
        }
        Ok((values, lines))
    }
}

impl Cells<'_> {
    pub(crate) fn text(&self, column: Column) -> &str {
        if self.is_empty { "" } else { self.table.cell(column.index) }
    }

    /// Whether all these cells are empty.
    pub(crate) fn are_empty(&self, columns: &[Column]) -> bool {
        columns.iter().all(|column| self.text(*column).is_empty())
    }

    /// Whether any of these cells has no measured value.
    pub(crate) fn is_any_missing(&self, columns: &[Column]) -> bool {
        columns.iter().any(|column| is_missing(self.text(*column)))
    }

    /// Leaves the row out, for this reason.
    pub(crate) fn leave_out(&mut self, reason: impl Into<String>) {
        self.left_out = Some(reason.into());
    }

    pub(crate) fn fault(&mut self, fault: impl Into<String>) {
        self.faults.push(fault.into());
    }

    /// The number in a cell, or 0 after adding a fault.
    pub(crate) fn number(&mut self, Column { index, unit }: Column) -> f64 {
        self.table.number(index, unit.exponent, self.line).map_or_else(
            |fault| {
                self.faults.push(fault);
                0.0
            },
            |number| number * unit.factor,
        )
    }

    /// The numbers in these cells, or `None` after adding faults.
    pub(crate) fn numbers<const N: usize>(&mut self, columns: &[Column; N]) -> Option<[f64; N]> {
        let before = self.faults.len();
        let numbers = columns.map(|column| self.number(column));
        (self.faults.len() == before).then_some(numbers)
    }

    /// The vector in these cells, or `None` after adding faults.
    pub(crate) fn vector(&mut self, columns: &[Column; 3]) -> Option<DVec3> {
        self.numbers(columns).map(DVec3::from)
    }

    /// The measured vector in these cells, or `None` after adding faults. A component that was not
    /// measured, or has no column, is NaN. A number beyond [`MOST_MEASURED`] is a fault.
    pub(crate) fn measured(&mut self, columns: &[Option<Column>; 3]) -> Option<DVec3> {
        let before = self.faults.len();
        let components = columns.map(|column| match column {
            Some(column) if !is_missing(self.text(column)) => {
                let number = self.number(column);
                if number.abs() > MOST_MEASURED {
                    let fault = format!("{}, must be a measured value, at most {MOST_MEASURED:e}", self.quoted(column));
                    self.faults.push(fault);
                }
                number
            }
            _ => f64::NAN,
        });
        (self.faults.len() == before).then_some(DVec3::from(components))
    }

    /// The name of a column and the text of its cell, for messages.
    pub(crate) fn quoted(&self, column: Column) -> String {
        self.table.quoted(column.index)
    }
}

/// Largest magnitude of a measured value. Sums of squares of larger ones overflow.
const MOST_MEASURED: f64 = 1e100;

/// Whether a cell has none of the numbers of its column, as data loggers and spreadsheets write it.
fn is_missing(text: &str) -> bool {
    const WORDS: [&str; 6] = ["nan", "na", "n/a", "#n/a", "null", "none"];
    text.chars().all(|c| c == '-') || WORDS.contains(&text.to_lowercase().as_str())
}

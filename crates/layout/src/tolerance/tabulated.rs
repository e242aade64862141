//! Tabulated distributions: measured errors in a CSV file or in the layout.

use std::collections::HashMap;
use std::fmt::Display;
use std::path::PathBuf;

use csv::{ReaderBuilder, StringRecord, Trim};

use crate::error_unit::ErrorUnit;
use crate::faults::{Faults, TableFaults};
use crate::files::regular_bytes;
use crate::finding::FindingSubject;
use crate::limits::{MAX_FILE_BYTES, MAX_LISTED, MAX_TABULATED, MAX_TABULATED_IN_ALL};
use crate::names::{did_you_mean, shown};
use crate::places::Place;
use crate::tolerance::distribution::Distribution;

/// A file with its column and unit.
type ColumnKey = (String, Option<String>, ErrorUnit);

/// The tables of `[tolerance]`, with their measured errors.
pub(crate) struct ErrorTables<'f, 't> {
    pub(crate) place: &'f Place,
    pub(crate) tabulated: Tabulated,
    pub(crate) faults: &'f mut Faults<'t>,
}

/// One table of errors: its faults, and the measured errors of the layout.
pub(crate) struct ErrorTable<'f, 't> {
    pub(crate) tabulated: &'f mut Tabulated,
    pub(crate) faults: TableFaults<'f, 't>,
}

impl<'t> ErrorTables<'_, 't> {
    /// The table at this place.
    pub(crate) fn at(&mut self, place: &Place, name: impl Into<String>) -> ErrorTable<'_, 't> {
        ErrorTable { tabulated: &mut self.tabulated, faults: self.faults.at(place.start, name) }
    }

    /// The table of a key in `[tolerance]`.
    pub(crate) fn key(&mut self, key: &str) -> ErrorTable<'_, 't> {
        self.at(self.place.key(key), format!("tolerance.{key}"))
    }
}

impl ErrorTable<'_, '_> {
    /// Adds a finding about the table, or about one of its keys.
    pub(crate) fn remark(&mut self, about: impl Display) {
        let message = format!("{}{about}", self.faults.place());
        self.faults.remark(FindingSubject::Tolerance, message);
    }
}

/// The tabulated distributions of one layout. Files are read once, and all of them and all values
/// count towards limits.
pub(crate) struct Tabulated {
    folder: PathBuf,
    read: HashMap<ColumnKey, Result<Distribution, String>>,
    bytes_left: usize,
    values_left: usize,
}

impl Tabulated {
    /// No distributions yet. Paths are relative to `folder`.
    pub(crate) fn new(folder: PathBuf) -> Tabulated {
        Tabulated { folder, read: HashMap::new(), bytes_left: MAX_FILE_BYTES, values_left: MAX_TABULATED_IN_ALL }
    }

    /// The distribution of the values in a column of a file, or why there is none.
    pub(crate) fn of_file(
        &mut self,
        file: &str,
        column: Option<&str>,
        unit: ErrorUnit,
    ) -> Result<Distribution, String> {
        let key = (file.to_owned(), column.map(str::to_owned), unit);
        if let Some(known) = self.read.get(&key) {
            return known.clone();
        }
        let found = self.read_column(file, column, unit).and_then(|values| tabulated(values, unit));
        let found = found.map_err(|rule| format!("file \"{}\": {rule}", shown(file)));
        self.read.insert(key, found.clone());
        found
    }

    /// Counts `times` uses of distributions. Returns whether the limit on all values is kept.
    pub(crate) fn count<'d>(&mut self, used: impl IntoIterator<Item = &'d Distribution>, times: usize) -> bool {
        let values = |distribution: &Distribution| match distribution {
            Distribution::Tabulated(values) => values.len(),
            _ => 0,
        };
        let total: usize = used.into_iter().map(values).sum();
        let total = total.saturating_mul(times);
        let is_kept = total <= self.values_left;
        self.values_left = self.values_left.saturating_sub(total);
        is_kept
    }

    fn read_column(&mut self, file: &str, column: Option<&str>, unit: ErrorUnit) -> Result<Vec<f64>, String> {
        let bytes =
            regular_bytes(&self.folder.join(file), self.bytes_left).map_err(|e| format!("cannot be read: {e}"))?;
        self.bytes_left -= bytes.len();
        let text = std::str::from_utf8(&bytes).map_err(|_| "must be UTF-8 text")?;
        column_values(text.strip_prefix('\u{feff}').unwrap_or(text), column, unit)
    }
}

/// The distribution of values in the unit of the file, or why there is none.
pub(crate) fn tabulated(mut values: Vec<f64>, unit: ErrorUnit) -> Result<Distribution, String> {
    if values.is_empty() {
        return Err("has no values".to_owned());
    }
    if values.len() > MAX_TABULATED {
        return Err(format!("has {} values, must have at most {MAX_TABULATED}", values.len()));
    }
    if let Some((i, value)) = values.iter().enumerate().find(|(_, value)| !value.is_finite()) {
        return Err(format!("value {} = {value}, must be a finite number", i + 1));
    }
    // Adding 0 turns -0 into 0.
    values.iter_mut().for_each(|value| *value += 0.0);
    values.sort_by(f64::total_cmp);
    Ok(Distribution::Tabulated(values.into_iter().map(|value| unit.read(value)).collect()).simplified())
}

/// The values of a column of CSV text.
fn column_values(text: &str, column: Option<&str>, unit: ErrorUnit) -> Result<Vec<f64>, String> {
    // Without comments and blank lines, so that every record of one line has its number in `lines`.
    let (mut content, mut lines) = (String::new(), Vec::new());
    for (index, line) in text.lines().enumerate() {
        if !line.trim().is_empty() && !line.trim_start().starts_with('#') {
            content += line;
            content.push('\n');
            lines.push(index + 1);
        }
    }
    let first = content.lines().next().ok_or("has no values")?;
    let delimiter = [b'\t', b';'].into_iter().find(|d| first.as_bytes().contains(d)).unwrap_or(b',');
    let mut reader = ReaderBuilder::new()
        .delimiter(delimiter)
        .has_headers(false)
        .flexible(true)
        .trim(Trim::All)
        .from_reader(content.as_bytes());
    let mut chosen = None;
    let mut values = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| format!("is not CSV: {error}"))?;
        let at = record.position().map_or(1, |position| position.line() as usize);
        let line = lines.get(at - 1).copied().unwrap_or(at);
        let place = match chosen {
            Some(place) => place,
            None => {
                let header = record.iter().any(|field| field.parse::<f64>().is_err());
                let found = chosen_column(&record, header, column, unit);
                let place = *chosen.insert(found.map_err(|rule| format!("line {line}: {rule}"))?);
                if header {
                    continue;
                }
                place
            }
        };
        let field = record.get(place).ok_or_else(|| format!("line {line}: has no column {}", place + 1))?;
        let value = field.parse::<f64>().map_err(|_| {
            let hint = if field.contains(',') { ", with a decimal point" } else { "" };
            format!("line {line}: \"{}\", must be a number{hint}", shown(field))
        })?;
        if !value.is_finite() {
            return Err(format!("line {line}: {value}, must be a finite number"));
        }
        values.push(value);
        if values.len() > MAX_TABULATED {
            return Err(format!("line {line}: has more values than {MAX_TABULATED}"));
        }
    }
    Ok(values)
}

/// The index of the column that is meant. `first` is the header or the first values.
fn chosen_column(
    first: &StringRecord,
    is_header: bool,
    column: Option<&str>,
    unit: ErrorUnit,
) -> Result<usize, String> {
    let names = || first.iter().take(MAX_LISTED).map(shown).collect::<Vec<_>>().join(", ");
    let place = match column {
        None if first.len() == 1 => 0,
        None if is_header => return Err(format!("has several columns: give column, one of {}", names())),
        None => return Err(format!("has {} columns and no header: give the file one and name a column", first.len())),
        Some(name) if !is_header => {
            return Err(format!("has no header with the column name \"{}\"", shown(name)));
        }
        Some(name) => first.iter().position(|field| field == name).ok_or_else(|| {
            let meant = did_you_mean(name, first.iter().take(MAX_LISTED));
            format!("has no column \"{}\"{meant}, its columns are {}", shown(name), names())
        })?,
    };
    let name = first.get(place).unwrap_or_default();
    match ErrorUnit::of_column(name).filter(|stated| is_header && *stated != unit.words()) {
        Some(stated) => Err(format!("column \"{}\" is in {stated}, must be in {}", shown(name), unit.words())),
        None => Ok(place),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_found_with_any_separator() {
        for text in [
            "n,dx_mm\n1,0.5\n2,-0.25\n",
            "# by hand\n\nn;dx_mm\r\n1; 0.5\r\n# again\r\n2;-0.25",
            "n\tdx_mm\n1\t0.5\n2\t-0.25\n",
        ] {
            assert_eq!(column_values(text, Some("dx_mm"), ErrorUnit::Millimetre), Ok(vec![0.5, -0.25]), "{text}");
        }
        for text in ["0.5\n-0.25\n", "dx_mm\n0.5\n-0.25\n"] {
            assert_eq!(column_values(text, None, ErrorUnit::Millimetre), Ok(vec![0.5, -0.25]), "{text}");
        }
    }

    #[test]
    fn faults_of_files_have_the_line_of_the_file() {
        for (text, column, rule) in [
            ("", None, "has no values"),
            ("# only\n", None, "has no values"),
            ("a,b\n1,2\n", None, "line 1: has several columns: give column, one of a, b"),
            ("1,2\n", None, "line 1: has 2 columns and no header"),
            ("1\n", Some("a"), "line 1: has no header with the column name \"a\""),
            ("# x\ndx,dy\n1,2\n", Some("dz"), "line 2: has no column \"dz\" (did you mean \"d"),
            ("dx_um\n1\n", None, "line 1: column \"dx_um\" is in micrometres, must be in mm"),
            ("# x\n\n1\n# y\nfew\n", None, "line 5: \"few\", must be a number"),
            ("a;b\n1;0,5\n", Some("b"), "line 2: \"0,5\", must be a number, with a decimal point"),
            ("1\nnan\n", None, "line 2: NaN, must be a finite number"),
            ("a,b\n1,2\n1\n", Some("b"), "line 3: has no column 2"),
        ] {
            let found = column_values(text, column, ErrorUnit::Millimetre).expect_err("a fault");
            assert!(found.starts_with(rule), "{text:?}: {found}");
        }
        let many = "1\n".repeat(MAX_TABULATED + 1);
        let found = column_values(&many, None, ErrorUnit::Millimetre).expect_err("too many");
        assert_eq!(found, "line 100001: has more values than 100000");
    }

    #[test]
    fn values_are_sorted_without_negative_zero() {
        let found = tabulated(vec![3.0, -0.0, 1.0], ErrorUnit::Millimetre).expect("values");
        let Distribution::Tabulated(values) = found else { panic!("{found:?}") };
        assert!(values[..] == [0.0, 1.0, 3.0] && values[0].is_sign_positive(), "{values:?}");
    }

    /// Only tabulated values count, once for each use.
    #[test]
    fn uses_of_values_are_counted() {
        let mut tabulated = Tabulated::new(PathBuf::new());
        tabulated.values_left = 10;
        let three = Distribution::Tabulated([0.1, 0.2, 0.3].into());
        let others = [Distribution::Fixed(0.1), Distribution::normal(0.1)];
        assert!(tabulated.count(&others, 100) && tabulated.values_left == 10);
        assert!(tabulated.count([&three, &others[0]], 2) && tabulated.values_left == 4);
        assert!(!tabulated.count([&three, &three], 1) && tabulated.values_left == 0);
        assert!(tabulated.count(&others, 1) && !tabulated.count([&three], usize::MAX));
    }
}

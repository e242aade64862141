//! Rows of tables.

use std::fmt::Write;
use std::iter;

use magsplice::prelude::DVec3;

use super::number::{components, number};

/// A column of a table.
#[derive(Clone, Copy)]
pub(crate) struct Column {
    /// Blanks before it.
    gap: usize,
    width: usize,
    /// Whether the column is as wide as its widest cell, if that is wider.
    grows: bool,
    is_right: bool,
}

/// A column whose cells begin at its left.
pub(crate) const fn left(width: usize) -> Column {
    Column { gap: 0, width, grows: false, is_right: false }
}

/// A column whose cells end at its right.
pub(crate) const fn right(width: usize) -> Column {
    Column { is_right: true, ..left(width) }
}

impl Column {
    /// The column after so many blanks.
    pub(crate) const fn after(self, gap: usize) -> Column {
        Column { gap, ..self }
    }

    /// The column, at least as wide as its widest cell.
    pub(crate) const fn growing(self) -> Column {
        Column { grows: true, ..self }
    }
}

/// As wide as its widest cell, two blanks after the column before.
pub(crate) const COMPACT: Column = left(0).growing().after(2);

/// Label and three numbers.
const LABELLED: [Column; 4] = [left(38), right(13), right(13), right(13)];

/// The rows of a table as lines, without blanks at their ends.
pub(crate) fn lines<const N: usize>(columns: &[Column; N], rows: &[[String; N]]) -> Vec<String> {
    let widest = |index: usize| rows.iter().map(|row| row[index].chars().count()).max().unwrap_or(0);
    let widths: [usize; N] = std::array::from_fn(|index| match columns[index] {
        Column { grows: true, width, .. } => width.max(widest(index)),
        Column { width, .. } => width,
    });
    let line = |row: &[String; N]| {
        let mut line = String::new();
        for ((cell, width), Column { gap, is_right, .. }) in row.iter().zip(widths).zip(columns) {
            let _ = match is_right {
                true => write!(line, "{:gap$}{cell:>width$}", ""),
                false => write!(line, "{:gap$}{cell:<width$}", ""),
            };
        }
        line.trim_end().to_owned()
    };
    rows.iter().map(line).collect()
}

/// The rows of a table as text.
pub(crate) fn table<const N: usize>(columns: &[Column; N], rows: &[[String; N]]) -> String {
    lines(columns, rows).into_iter().map(|line| line + "\n").collect()
}

/// A table with a head, whose columns are as wide as their widest cell and separated by two spaces.
pub(crate) fn headed<const N: usize>(head: [&str; N], rows: impl IntoIterator<Item = [String; N]>) -> String {
    let rows: Vec<[String; N]> = iter::once(head.map(str::to_owned)).chain(rows).collect();
    table(&[COMPACT; N], &rows)
}

/// Rows of text as CSV.
pub(crate) fn csv(rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    rows.into_iter().for_each(|row| writer.write_record(row).expect("memory takes every row"));
    let bytes = writer.into_inner().expect("memory takes every row");
    String::from_utf8(bytes).expect("text is written as text")
}

/// Lines of cells in columns that are as wide as their widest cell, separated by two spaces.
pub(crate) fn columns<const N: usize>(rows: &[[String; N]]) -> Vec<String> {
    lines(&[COMPACT; N], rows)
}

/// Appends a label and three cells.
pub(crate) fn cells(text: &mut String, label: &str, [x, y, z]: [String; 3]) {
    *text += &table(&LABELLED, &[[label.to_owned(), x, y, z]]);
}

/// Appends a label and three headings.
pub(crate) fn heading(text: &mut String, label: &str, names: [&str; 3]) {
    cells(text, label, names.map(str::to_owned));
}

/// Appends a label and one cell.
pub(crate) fn cell(text: &mut String, label: &str, value: &str) {
    let _ = writeln!(text, "{label:<38}{value:>13}");
}

/// Appends a label and the components of a vector, without round-off.
pub(crate) fn vector(text: &mut String, label: &str, v: DVec3) {
    cells(text, label, components(v).map(number));
}

/// Width of the lines of [`prose`], which is that of [`cells`].
const PROSE_WIDTH: usize = 77;

/// Appends a sentence, wrapped and indented by four spaces.
pub(crate) fn prose(text: &mut String, sentence: &str) {
    let mut line = String::new();
    for word in sentence.split_whitespace() {
        if 4 + line.len() + 1 + word.len() > PROSE_WIDTH && !line.is_empty() {
            let _ = writeln!(text, "    {line}");
            line.clear();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line += word;
    }
    let _ = writeln!(text, "    {line}");
}

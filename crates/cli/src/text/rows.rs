//! Rows of tables.

use std::fmt::Write;

use magsplice::prelude::DVec3;

use super::number::number;

/// Appends a label and three cells.
pub(crate) fn cells(text: &mut String, label: &str, [x, y, z]: [String; 3]) {
    let _ = writeln!(text, "{label:<38}{x:>13}{y:>13}{z:>13}");
}

/// Appends a label and three headings.
pub(crate) fn heading(text: &mut String, label: &str, names: [&str; 3]) {
    cells(text, label, names.map(str::to_owned));
}

/// Appends a label and one cell.
pub(crate) fn cell(text: &mut String, label: &str, value: &str) {
    let _ = writeln!(text, "{label:<38}{value:>13}");
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

/// Appends a label and the components of a vector. A component below 1e-12 of the largest is
/// round-off, and is printed as 0.
pub(crate) fn vector(text: &mut String, label: &str, v: DVec3) {
    let noise = 1e-12 * v.abs().max_element();
    cells(text, label, v.to_array().map(|c| number(if c.abs() <= noise { 0.0 } else { c })));
}

/// Lines of cells in columns that are as wide as their widest cell, separated by two spaces.
pub(crate) fn columns<const N: usize>(rows: &[[String; N]]) -> Vec<String> {
    let widths: [usize; N] =
        std::array::from_fn(|column| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0));
    let line = |row: &[String; N]| {
        let mut line = String::new();
        for (cell, width) in row.iter().zip(widths) {
            let _ = write!(line, "  {cell:<width$}");
        }
        line.trim_end().to_owned()
    };
    rows.iter().map(line).collect()
}

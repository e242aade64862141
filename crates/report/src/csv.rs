//! The data behind a figure as CSV.

use std::fmt::Write;

use glam::DVec3;

/// A header and rows: the text at the beginning of each, then its numbers with nine digits, more
/// than a figure shows. Where there is no value the field is empty.
pub(crate) fn csv<N: IntoIterator<Item = f64>>(header: &str, rows: impl Iterator<Item = (String, N)>) -> String {
    let mut csv = format!("{header}\n");
    for (text, numbers) in rows {
        csv += &text;
        for (column, number) in numbers.into_iter().enumerate() {
            if column > 0 {
                csv.push(',');
            }
            if number == 0.0 {
                csv.push('0');
            } else if number.is_finite() {
                // The shortest text of the rounded number.
                let rounded: f64 = format!("{number:.8e}").parse().unwrap_or(number);
                let plain = (1e-3..1e6).contains(&rounded.abs());
                let _ = if plain { write!(csv, "{rounded}") } else { write!(csv, "{rounded:e}") };
            }
        }
        csv.push('\n');
    }
    csv
}

/// Rows of vectors.
pub(crate) fn csv_of_vectors<const N: usize>(header: &str, rows: impl Iterator<Item = [DVec3; N]>) -> String {
    csv(header, rows.map(|row| (String::new(), row.map(|vector| vector.to_array()).concat())))
}

/// A text in quotes, as CSV asks.
pub(crate) fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

//! The text of a layout file: from TOML to its tables.
//!
//! The schema decides which keys and types a document may have. All misfits are reported together;
//! only a document without any becomes tables.

use std::ops::Range;

use serde::Deserialize;
use toml::de::{DeTable, Deserializer};
use toml::{Spanned, Value};

use crate::error::LayoutError;
use crate::file::LayoutFile;
use crate::file::check::misfits;
use crate::file::form::Form;
use crate::file::schema::SCHEMA;
use crate::file::values::from_value;
use crate::limits::{MAX_FILE_BYTES, MAX_LISTED, MAX_MESSAGE_LINE};
use crate::names::escaped;
use crate::places::Place;

/// Keys that a layout has at its top and few other files have.
const KEYS_OF_LAYOUTS: [&str; 4] = ["format", "tile", "lattice", "volume"];

/// Whether a TOML text is meant as a layout: it has one of the keys `format`, `tile`, `lattice` and
/// `volume`. `None` if the text is not TOML.
///
/// # Example
/// ```
/// use magsplice_layout::{COMMENTED_LAYOUT, is_layout};
///
/// assert_eq!(is_layout(COMMENTED_LAYOUT), Some(true));
/// assert_eq!(is_layout("[package]\nname = \"film\""), Some(false));
/// ```
pub fn is_layout(text: &str) -> Option<bool> {
    let table = DeTable::parse(text).ok()?;
    Some(KEYS_OF_LAYOUTS.iter().any(|key| table.get_ref().contains_key(*key)))
}

/// The tables of a text with their places, or every place that is not TOML or does not fit the
/// schema.
pub(crate) fn read(text: &str, origin: &str) -> Result<(LayoutFile, Place), LayoutError> {
    let refused = |message: String| LayoutError::Syntax { origin: origin.to_owned(), message };
    if text.len() > MAX_FILE_BYTES {
        return Err(refused(format!("has {} bytes, must have at most {MAX_FILE_BYTES}", text.len())));
    }
    let of_parser = |error: toml::de::Error| refused(in_place(text, error.span().unwrap_or_default(), error.message()));
    let document: Spanned<DeTable> = DeTable::parse(text).map_err(of_parser)?;
    let misfits = misfits(text, &document, Form::of_document(&SCHEMA));
    if misfits.is_empty() {
        let place = Place::of_document(&document);
        // As values first, because a type that is read from values takes a third of the code.
        let values = Value::deserialize(Deserializer::from(document)).map_err(of_parser)?;
        return from_value(values).map(|file| (file, place)).map_err(of_parser);
    }
    let mut all: Vec<String> =
        misfits.iter().take(MAX_LISTED).map(|misfit| in_place(text, misfit.span.clone(), &misfit.message)).collect();
    if misfits.len() > MAX_LISTED {
        all.push(format!("and {} more", misfits.len() - MAX_LISTED));
    }
    Err(refused(all.join(&format!("\n{origin}: "))))
}

/// A message with its line, its column, and the line itself. Control characters of the line are
/// escaped, and very long lines are cut.
fn in_place(text: &str, span: Range<usize>, message: &str) -> String {
    // An error at the end of the text is on the last line.
    let last = text.char_indices().next_back().map_or(0, |(last, _)| last);
    let before = &text[..span.start.min(last)];
    let (number, line_start) = (before.matches('\n').count() + 1, before.rfind('\n').map_or(0, |end| end + 1));
    let line = text[line_start..].split('\n').next().unwrap_or_default();
    let column = text[line_start..span.start.min(text.len())].chars().count();
    let rest = line.chars().count().saturating_sub(column);
    let marked = text.get(span).map_or(0, |marked| marked.chars().count()).min(rest).max(1);
    let margin = " ".repeat(number.to_string().len());
    let excerpt = format!("{number} | {line}\n{margin} | {}{}", " ".repeat(column), "^".repeat(marked));
    let place = format!("TOML parse error at line {number}, column {}\n{margin} |\n", column + 1);
    format!("{place}{excerpt}\n{message}").lines().map(printable).collect::<Vec<_>>().join("\n")
}

fn printable(line: &str) -> String {
    let mut shown: String = line.chars().take(MAX_MESSAGE_LINE).flat_map(escaped).collect();
    if line.chars().nth(MAX_MESSAGE_LINE).is_some() {
        shown += "...";
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_with_a_key_of_layouts_are_layouts() {
        for (text, known) in [
            ("format = 1", Some(true)),
            ("[[tile]]\n", Some(true)),
            ("[[lattice]]\n", Some(true)),
            ("[volume]\n", Some(true)),
            ("name = \"film\"\n[package]\n", Some(false)),
            ("", Some(false)),
            ("x,y\n1,2\n", None),
        ] {
            assert_eq!(is_layout(text), known, "{text:?}");
        }
    }
}

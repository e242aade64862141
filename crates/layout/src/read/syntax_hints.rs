//! Hints beside syntax errors: the key that was probably meant, and the form of its value.
//!
//! The messages of the TOML parser name an unknown key and all keys that the table has. They do not
//! say which of these was meant, nor that a magnetization becomes a polarization.

use std::ops::Range;

use strsim::jaro_winkler;

use crate::read::value_types::{self, WrongValue};

/// Similarity (Jaro and Winkler) from which on a key is suggested. `tiles` has 0.96 to `tile`,
/// `wavelenght_mm` 0.98 to `wavelength_mm`; `colour` has 0.4 to 0.6 to every key of a tile.
const LEAST_SIMILARITY: f64 = 0.84;

/// The unit that the end of a key names, in words.
const UNITS: [(&str, &str); 4] = [("_mm", "mm"), ("_t", "tesla"), ("_ut", "microtesla"), ("_deg", "degrees")];

/// The message about a syntax error. `message` and `span` are of the TOML parser. A value of a
/// wrong type is told by the form that its key wants, if this is known.
pub(crate) fn message(text: &str, message: &str, span: Option<Range<usize>>) -> String {
    let written = span.clone().and_then(|span| text.get(span)).unwrap_or_default();
    let form = span.clone().and_then(|span| {
        let key = key_at(text, span.start)?;
        let is_element = is_in_list(text, span.start)?;
        WrongValue { key, written, message, is_element }.wanted_form()
    });
    let hint = hint(text, message, span).map_or(String::new(), |hint| format!("\n{hint}"));
    let sentence = form.unwrap_or_else(|| value_types::without_rust_names(message.trim_end()));
    format!("{sentence}{hint}")
}

/// A sentence that helps with a syntax error, if there is one. `message` and `span` are of the TOML
/// parser.
fn hint(text: &str, message: &str, span: Option<Range<usize>>) -> Option<String> {
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let key = span.and_then(|span| key_at(text, span.start));
    if let Some(unknown) = quoted.first().filter(|_| message.starts_with("unknown field")) {
        return about_key(unknown, &quoted[1..]);
    }
    if message.starts_with("unknown variant") {
        return Some(format!("did you mean \"{}\"?", nearest(quoted.first()?, &quoted[1..])?));
    }
    if message.starts_with("missing field") {
        return about_missing(quoted.first()?);
    }
    match key? {
        "tile" | "lattice" if message.contains("expected a sequence") => {
            let key = key?;
            Some(format!("write [[{key}]] with two brackets: a layout has a list of them"))
        }
        "strength_t" if message.starts_with("invalid type: sequence, expected f64") => {
            Some("strength_t is one number, the magnitude; polarization_t has three components".to_owned())
        }
        "polarization_t" if message.ends_with("expected an array of length 3") => {
            Some("polarization_t has three components; strength_t is the magnitude, with a direction".to_owned())
        }
        _ => None,
    }
}

fn about_key(unknown: &str, known: &[&str]) -> Option<String> {
    let lower = unknown.to_lowercase();
    if known.contains(&"polarization_t") && is_magnetization(&lower) {
        return Some(
            "give polarization_t, the polarization J = mu0 M in tesla: a magnetization M of 955 kA/m is 1.2 T"
                .to_owned(),
        );
    }
    if known.contains(&"strength_t") && matches!(lower.as_str(), "remanence" | "remanence_t" | "br" | "br_t" | "b_r_t")
    {
        return Some("did you mean `strength_t`, the magnitude of J in tesla?".to_owned());
    }
    let meant = nearest(unknown, known)?;
    let unit = UNITS.iter().find(|(end, _)| meant.ends_with(end) && !unknown.ends_with(end));
    Some(match unit {
        Some((_, unit)) => format!("did you mean `{meant}`, in {unit}?"),
        None => format!("did you mean `{meant}`?"),
    })
}

/// Whether a key, in lower case, names a magnetization.
fn is_magnetization(key: &str) -> bool {
    key.starts_with("magneti") || key.starts_with("m_a") || key == "m" || key == "m_t" || key == "mag"
}

/// The known key most like an unknown one, with or without the unit at their ends.
fn nearest<'k>(unknown: &str, known: &[&'k str]) -> Option<&'k str> {
    let lower = unknown.to_lowercase().replace('-', "_");
    let similarity = |known: &str| {
        let bare = UNITS.iter().find_map(|(end, _)| known.strip_suffix(end)).unwrap_or(known);
        jaro_winkler(&lower, known).max(jaro_winkler(&lower, bare))
    };
    let all = known.iter().map(|known| (similarity(known), *known));
    all.filter(|(value, _)| *value >= LEAST_SIMILARITY).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, known)| known)
}

fn about_missing(key: &str) -> Option<String> {
    let hint = match key {
        "format" => "begin the file with the line `format = 1`, the version of the format",
        "name" => "give the layout a name, as in `name = \"my film\"`",
        "position_mm" => "give the centre of the tile, as in `position_mm = [0.0, 0.0, 0.5]`",
        "axis" | "angle_deg" => "a rotation has both: `rotation = { axis = [0, 0, 1], angle_deg = 30 }`",
        "pitch_mm" | "count" => "a grid has both: `grid = { count = [4, 4, 1], pitch_mm = [5.0, 5.0, 0.0] }`",
        _ => return None,
    };
    Some(hint.to_owned())
}

/// The key of the value at `start`: the last name before it that stands before `=`, or the name of
/// the table that begins there.
fn key_at(text: &str, start: usize) -> Option<&str> {
    let line_end = text[start..].find('\n').map_or(text.len(), |end| start + end);
    let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
    let line = &text[line_start..line_end];
    if let Some(table) = line.trim_start().strip_prefix('[').filter(|_| !line.contains('=')) {
        return Some(table.trim_matches(|c: char| matches!(c, '[' | ']') || c.is_whitespace()));
    }
    // The `=` before the value, on its line or on an earlier one.
    let before = &text[..start];
    let equals = before.rfind('=')?;
    let name = before[..equals].trim_end();
    let begin = name.rfind(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '-'))).map_or(0, |at| at + 1);
    name.get(begin..)
}

/// Whether the value at `start` is in the list that is the value of its key. `None` if the key
/// before it belongs to another value, that of a table before it in a list.
fn is_in_list(text: &str, start: usize) -> Option<bool> {
    let before = &text[..start];
    let between = before.rfind('=').map_or("", |equals| &before[equals + 1..]);
    let depth = |open: char, close: char| between.matches(open).count().checked_sub(between.matches(close).count());
    depth('{', '}')?;
    Some(depth('[', ']')? > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_key_is_suggested_with_its_unit() {
        let known = ["name", "position_mm", "size_mm", "polarization_t", "strength_t", "direction", "rotation"];
        for (unknown, meant) in [
            ("size", "did you mean `size_mm`, in mm?"),
            ("Position_mm", "did you mean `position_mm`?"),
            ("strenght_t", "did you mean `strength_t`?"),
            ("strength_mT", "did you mean `strength_t`, in tesla?"),
            ("polarisation_t", "did you mean `polarization_t`?"),
            ("rotate", "did you mean `rotation`?"),
            ("remanence", "did you mean `strength_t`, the magnitude of J in tesla?"),
        ] {
            assert_eq!(about_key(unknown, &known).as_deref(), Some(meant));
        }
        for unknown in ["colour", "x", "grade", ""] {
            assert_eq!(about_key(unknown, &known), None, "{unknown}");
        }
    }

    #[test]
    fn the_key_of_a_value_is_found_on_its_line_or_before() {
        let text = "a = 1\nrotation = [\n  0, 30]\nm = { axes = 3 }\n[[tiles]]\n";
        for (place, key) in [("30", "rotation"), ("1", "a"), ("3 }", "axes"), ("[[tiles", "tiles")] {
            assert_eq!(key_at(text, text.find(place).expect("a place")), Some(key), "{place}");
        }
        assert_eq!(key_at("", 0), None);
    }

    #[test]
    fn two_brackets_are_advised_where_a_list_is_wanted() {
        let advice = |message: &str| hint("[tile]\nname = 3\n", message, Some(0..6));
        assert!(
            advice("invalid type: map, expected a sequence")
                .is_some_and(|advice| advice.starts_with("write [[tile]] with"))
        );
        assert_eq!(advice("invalid type: map, expected a string"), None);
    }

    #[test]
    fn values_in_lists_are_told_from_values_of_keys() {
        let text = "a = 1\nsize_mm = [2, [30, 40], 5]\nm = { axes = 6 }\nstock = [{ n = 7 }, 8]\n";
        for (value, is_element) in [
            ("1", Some(false)),
            ("[2", Some(false)),
            ("2", Some(true)),
            ("40", Some(true)),
            ("5]", Some(true)),
            ("6", Some(false)),
            ("7", Some(false)),
            // The key before it is that of 7.
            ("8", None),
        ] {
            assert_eq!(is_in_list(text, text.find(value).expect("a place")), is_element, "{value}");
        }
    }
}

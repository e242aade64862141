//! A document against the schema: unknown and missing keys, and values of a wrong type.

use std::ops::Range;

use strsim::jaro_winkler;
use toml::Spanned;
use toml::de::{DeInteger, DeTable, DeValue};

use crate::file::form::{Form, Kind};
use crate::file::sentence::{KeyForm, one_of};
use crate::limits::MAX_NAME_BYTES;
use crate::units::KEY_UNITS;

/// A place in the text that the schema does not allow.
pub(crate) struct Misfit {
    pub(crate) span: Range<usize>,
    /// The rule, and on further lines what was probably meant.
    pub(crate) message: String,
}

/// Similarity (Jaro and Winkler) from which on a key is suggested. `tiles` has 0.96 to `tile`,
/// `wavelenght_mm` 0.98 to `wavelength_mm`; `colour` has 0.4 to 0.6 to every key of a tile.
const LEAST_SIMILARITY: f64 = 0.84;

/// All misfits of a document, in the order of the text.
pub(crate) fn misfits(text: &str, document: &Spanned<DeTable>, form: Form) -> Vec<Misfit> {
    let mut walk = Walk { text, found: Vec::new() };
    // The table of the document stands where the text begins.
    walk.table(form, document.get_ref(), 0..0, None);
    walk.found.sort_by_key(|misfit| misfit.span.start);
    walk.found
}

struct Walk<'t> {
    text: &'t str,
    found: Vec<Misfit>,
}

impl Walk<'_> {
    fn add(&mut self, span: Range<usize>, message: String) {
        self.found.push(Misfit { span, message });
    }

    /// Checks a table under a key, or the document.
    fn table(&mut self, form: Form, table: &DeTable, span: Range<usize>, own_key: Option<&str>) {
        if let Some(key) = own_key.filter(|_| table.is_empty() && form.must_have_keys()) {
            self.add(span.clone(), format!("{key} is empty, must give at least one of {}", form.keys().join(", ")));
        }
        let mut meant = Vec::new();
        for (key, value) in table {
            match form.property(key.get_ref()) {
                Some(form) => {
                    let key = KeyForm { key: key.get_ref(), form, is_element: false, is_top: own_key.is_none() };
                    self.value(key, form, value);
                }
                None => {
                    let keys = form.keys();
                    let (hint, key_meant) = about_unknown(key.get_ref(), &keys);
                    meant.extend(key_meant);
                    let known = one_of(&keys);
                    self.add(key.span(), format!("unknown field `{}`, expected {known}{hint}", key.get_ref()));
                }
            }
        }
        // A key that is misspelt is not missing.
        for key in form.required().filter(|key| !table.contains_key(*key) && !meant.contains(key)) {
            let about = form.property(key).map_or(String::new(), |form| {
                let example = form.example().map_or(String::new(), |example| format!(", as in `{key} = {example}`"));
                format!("{example}{}", form.description().map_or(String::new(), |text| format!("\n{text}")))
            });
            self.add(span.clone(), format!("missing field `{key}`{about}"));
        }
    }

    /// Checks a value of `form`, one of the forms of its key.
    fn value(&mut self, key: KeyForm, form: Form, value: &Spanned<DeValue>) {
        let span = value.span();
        let is_right = match (form.kind(), value.get_ref()) {
            (Kind::OneOf(choices), found) => {
                let choice = choices.into_iter().find(|choice| has_type(*choice, found));
                return match choice {
                    Some(choice) if !matches!(found, DeValue::Array(_)) || fits_length(choice, found) => {
                        self.value(key, choice, value);
                    }
                    _ => self.wrong(key, form, value),
                };
            }
            (Kind::Table, DeValue::Table(table)) => {
                self.table(form, table, span, Some(key.key));
                true
            }
            (Kind::List(items, _), DeValue::Array(list)) if fits_length(form, value.get_ref()) => {
                let key = KeyForm { is_element: true, is_top: false, ..key };
                list.iter().for_each(|element| self.value(key, items, element));
                true
            }
            (Kind::Word(words), DeValue::String(word)) => {
                if !words.contains(&word.as_ref()) {
                    let meant =
                        nearest(word, &words).map_or(String::new(), |near| format!("\ndid you mean \"{near}\"?"));
                    self.add(span, format!("unknown variant `{word}`, expected {}{meant}", one_of(&words)));
                }
                true
            }
            (Kind::Integer { .. } | Kind::Number, DeValue::Integer(number)) if is_too_large(number) => {
                let rule = format!("must be from {} to {}, the integers of TOML", i64::MIN, i64::MAX);
                self.add(span, format!("{} {rule}", key.key));
                true
            }
            (Kind::Integer { is_unsigned: true }, DeValue::Integer(number)) => !number.as_str().starts_with('-'),
            (_, found) => has_type(form, found) && !matches!(found, DeValue::Array(_)),
        };
        if !is_right {
            self.wrong(key, form, value);
        }
    }

    fn wrong(&mut self, key: KeyForm, form: Form, value: &Spanned<DeValue>) {
        let written = self.text.get(value.span()).unwrap_or_default();
        self.add(value.span(), key.sentence(form, value.get_ref(), written));
    }
}

fn is_too_large(number: &DeInteger) -> bool {
    i64::from_str_radix(number.as_str(), number.radix()).is_err()
}

/// Whether a value is a number, a text, a list or a table as the form is.
fn has_type(form: Form, value: &DeValue) -> bool {
    matches!(
        (form.kind(), value),
        (Kind::Number, DeValue::Integer(_) | DeValue::Float(_))
            | (Kind::Integer { .. }, DeValue::Integer(_))
            | (Kind::Text | Kind::Word(_), DeValue::String(_))
            | (Kind::List(..), DeValue::Array(_))
            | (Kind::Table, DeValue::Table(_))
    )
}

fn fits_length(form: Form, value: &DeValue) -> bool {
    match (form.kind(), value) {
        (Kind::List(_, Some(length)), DeValue::Array(list)) => list.len() == length,
        _ => true,
    }
}

/// A line about the key that was probably meant, and this key.
fn about_unknown<'k>(unknown: &str, known: &[&'k str]) -> (String, Option<&'k str>) {
    let lower = unknown.to_lowercase();
    let of = |key: &str| known.iter().copied().find(|known| *known == key);
    if let Some(key) = of("polarization_t").filter(|_| is_magnetization(&lower)) {
        let hint = "\ngive polarization_t, the polarization J = mu0 M in tesla: a magnetization M of 955 kA/m is 1.2 T";
        return (hint.to_owned(), Some(key));
    }
    let is_remanence = matches!(lower.as_str(), "remanence" | "remanence_t" | "br" | "br_t" | "b_r_t");
    if let Some(key) = of("strength_t").filter(|_| is_remanence) {
        return ("\ndid you mean `strength_t`, the magnitude of J in tesla?".to_owned(), Some(key));
    }
    let Some(meant) = nearest(unknown, known) else { return (String::new(), None) };
    let unit = KEY_UNITS.iter().find(|unit| meant.ends_with(unit.suffix) && !unknown.ends_with(unit.suffix));
    let unit = unit.map_or(String::new(), |unit| format!(", in {}", unit.words));
    (format!("\ndid you mean `{meant}`{unit}?"), Some(meant))
}

/// Whether a key, in lower case, names a magnetization.
fn is_magnetization(key: &str) -> bool {
    key.starts_with("magneti") || key.starts_with("m_a") || key == "m" || key == "m_t" || key == "mag"
}

/// The known key most like an unknown one, with or without the unit at their ends.
fn nearest<'k>(unknown: &str, known: &[&'k str]) -> Option<&'k str> {
    // Comparing takes the product of the lengths.
    if unknown.len() > MAX_NAME_BYTES {
        return None;
    }
    let lower = unknown.to_lowercase().replace('-', "_");
    let similarity = |known: &str| {
        let bare = KEY_UNITS.iter().find_map(|unit| known.strip_suffix(unit.suffix)).unwrap_or(known);
        jaro_winkler(&lower, known).max(jaro_winkler(&lower, bare))
    };
    let all = known.iter().map(|known| (similarity(known), *known));
    all.filter(|(value, _)| *value >= LEAST_SIMILARITY).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, known)| known)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn magnetizations_are_known_by_their_keys() {
        for key in ["magnetization", "magnetisation_a_m", "m_a_per_m", "m", "m_t", "mag"] {
            assert!(is_magnetization(key), "{key}");
        }
        for key in ["material", "magnet", "max", "mm", "mirror", "m_x", ""] {
            assert!(!is_magnetization(key), "{key}");
        }
    }

    /// The key that was meant, and its unit where the unknown key has none.
    #[test]
    fn keys_that_were_meant_are_found() {
        let known = ["position_mm", "polarization_t", "strength_t", "name"];
        let of = |unknown: &str| about_unknown(unknown, &known);
        let (hint, key) = of("M_A_per_m");
        assert!(key == Some("polarization_t") && hint.contains("955 kA/m is 1.2 T"), "{hint}");
        assert_eq!(about_unknown("m_t", &["name"]), (String::new(), None));
        let remanence = "\ndid you mean `strength_t`, the magnitude of J in tesla?".to_owned();
        for unknown in ["remanence", "Remanence_T", "Br", "br_t", "b_r_t"] {
            assert_eq!(of(unknown), (remanence.clone(), Some("strength_t")), "{unknown}");
        }
        assert_eq!(of("position"), ("\ndid you mean `position_mm`, in mm?".to_owned(), Some("position_mm")));
        assert_eq!(of("positoin_mm"), ("\ndid you mean `position_mm`?".to_owned(), Some("position_mm")));
        assert_eq!(of("nmae"), ("\ndid you mean `name`?".to_owned(), Some("name")));
        assert_eq!(of("xyzzy"), (String::new(), None));
    }
}

//! What a key wants instead of a value of a wrong type.

use toml::de::DeValue;

use crate::file::form::{Form, Kind};
use crate::plausible::typed;
use crate::units::{KEY_UNITS, KeyUnit};

/// Most characters of a value that are repeated in a message.
const MOST_REPEATED: usize = 40;

/// A key with the form of its value.
#[derive(Clone, Copy)]
pub(crate) struct KeyForm<'t> {
    pub(crate) key: &'t str,
    pub(crate) form: Form<'t>,
    /// Whether the value in question is an element of the list that is the value of the key.
    pub(crate) is_element: bool,
    /// Whether the key stands at the top of the file.
    pub(crate) is_top: bool,
}

impl KeyForm<'_> {
    /// The form that the key, or each element of its value, wants instead of a value, how the value
    /// would be written in it, or an example, and on a second line the description of the key.
    /// `written` is the value in the file.
    pub(crate) fn sentence(self, form: Form, value: &DeValue, written: &str) -> String {
        let key = self.key;
        let subject = if self.is_element { format!("each value of {key}") } else { key.to_owned() };
        let in_unit = self.unit().map_or(String::new(), |unit| format!(" in {}", unit.words));
        let text = if let DeValue::String(text) = value { Some(text.trim()) } else { None };
        let is_number = matches!(form.kind(), Kind::Number | Kind::Integer { .. });
        let fitting = self.fitting(form, text.unwrap_or(written.trim())).filter(|_| text.is_some() || !is_number);
        let found = self.found(form, value);
        let sentence = match (form.kind(), text, &fitting) {
            (Kind::Number, Some(_), Some(number)) => {
                let unit = if self.unit().is_some() { " and unit" } else { "" };
                format!("{subject} is a number{in_unit}, without quotes{unit}: write {number}")
            }
            (Kind::Number, Some(_), None) => format!("{subject} is a number{in_unit}, not a string"),
            (Kind::Integer { .. }, Some(_), Some(number)) => {
                format!("{subject} is an integer, without quotes: write {number}")
            }
            (kind, ..) => {
                let found = match (&kind, value) {
                    (Kind::Integer { .. }, DeValue::Integer(_) | DeValue::Float(_)) => written.trim().to_owned(),
                    _ => found,
                };
                let wanted = self.words(&kind, &in_unit);
                match (fitting.filter(|_| !self.is_element), self.form.example()) {
                    _ if self.is_top && is_table_list(&kind) => {
                        format!("{subject} is {wanted}, not {found}: write [[{key}]] with two brackets")
                    }
                    _ if self.is_top && matches!(kind, Kind::Table) => {
                        format!("{subject} is {wanted}, not {found}: begin it with the line [{key}]")
                    }
                    (Some(fitting), _) if matches!(kind, Kind::Text) => {
                        format!("{subject} is {wanted}: write `{key} = {fitting}`")
                    }
                    (Some(fitting), _) => format!("{subject} is {wanted}, not {found}: write `{key} = {fitting}`"),
                    (None, Some(example)) => format!("{subject} is {wanted}, not {found}, as in `{key} = {example}`"),
                    (None, None) => format!("{subject} is {wanted}, not {found}"),
                }
            }
        };
        sentence + &self.form.description().map_or(String::new(), |description| format!("\n{description}"))
    }

    /// A form in words.
    fn words(self, kind: &Kind, in_unit: &str) -> String {
        match kind {
            Kind::Number => format!("one number{in_unit}"),
            Kind::Integer { is_unsigned: true } => "an integer, at least 0".to_owned(),
            Kind::Integer { .. } => "an integer".to_owned(),
            Kind::Text => "a string in quotes".to_owned(),
            Kind::Word(_) => "a word in quotes".to_owned(),
            Kind::Table => "a table".to_owned(),
            Kind::List(items, None) => match items.kind() {
                Kind::Number => format!("a list of numbers{in_unit}"),
                Kind::Text => "a list of strings in quotes".to_owned(),
                Kind::Table => "a list of tables".to_owned(),
                _ => "a list".to_owned(),
            },
            Kind::List(items, Some(length)) => {
                let count =
                    ["no", "one", "two", "three", "four"].get(*length).map_or(length.to_string(), |&w| w.into());
                match items.kind() {
                    Kind::Integer { .. } => format!("a list of {count} integers"),
                    Kind::List(inner, inner_length) => {
                        let row = self.words(&Kind::List(inner, inner_length), in_unit);
                        format!("a list of {count} rows, each {}", row.trim_start_matches("a list "))
                    }
                    _ => format!("a list of {count} numbers{in_unit}"),
                }
            }
            Kind::OneOf(choices) => {
                let mut all: Vec<String> = choices.iter().map(|choice| self.choice(*choice, in_unit)).collect();
                let last = all.pop().unwrap_or_default();
                format!("{}, or {last}", all.join(", "))
            }
        }
    }

    /// One of several forms in words, of which the first is a number.
    fn choice(self, form: Form, in_unit: &str) -> String {
        match form.kind() {
            Kind::List(items, Some(length)) => {
                let count = ["no", "one", "two", "three"].get(length).map_or(length.to_string(), |&word| word.into());
                let each = if matches!(items.kind(), Kind::Number) { ", one along each axis" } else { " of them" };
                format!("a list of {count}{each}")
            }
            Kind::Table => form.example().map_or("a table".to_owned(), |example| format!("a table such as {example}")),
            kind => self.words(&kind, in_unit),
        }
    }

    /// What the value is instead.
    fn found(self, form: Form, value: &DeValue) -> String {
        let wants_list = match form.kind() {
            Kind::OneOf(choices) => choices.iter().any(|choice| matches!(choice.kind(), Kind::List(..))),
            kind => matches!(kind, Kind::List(_, Some(_))),
        };
        match value {
            DeValue::String(_) => "a string".to_owned(),
            DeValue::Array(list) if wants_list => format!("a list of {}", list.len()),
            DeValue::Array(_) => "a list".to_owned(),
            DeValue::Table(_) => "a table".to_owned(),
            DeValue::Boolean(_) => "true or false".to_owned(),
            DeValue::Integer(_) | DeValue::Float(_) => "a number".to_owned(),
            DeValue::Datetime(_) => "a date".to_owned(),
        }
    }

    /// How a value that is written as `text` would be written in a form. `None` if it cannot be.
    fn fitting(self, form: Form, text: &str) -> Option<String> {
        match form.kind() {
            Kind::Number => {
                let in_unit = |unit: &KeyUnit| {
                    unit.others.iter().find_map(|(name, factor)| Some(finite(text.strip_suffix(name)?)? * factor))
                };
                let number = self.unit().and_then(in_unit).or_else(|| finite(text))?;
                Some(typed(number).to_string())
            }
            Kind::Integer { .. } => text.parse::<i64>().ok().map(|value| value.to_string()),
            Kind::Text => {
                let is_bare = finite(text).is_some() || matches!(text, "true" | "false");
                (is_bare && text.chars().count() <= MOST_REPEATED).then(|| format!("\"{text}\""))
            }
            Kind::Word(words) => {
                words.into_iter().find(|word| word.eq_ignore_ascii_case(text)).map(|word| format!("\"{word}\""))
            }
            Kind::List(items, length) => {
                if let (Kind::Number, Some(3), None) = (items.kind(), length, self.unit())
                    && let Some(axis) = ["x", "y", "z"].iter().position(|letter| text.eq_ignore_ascii_case(letter))
                {
                    return Some(["[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]"][axis].to_owned());
                }
                let elements = match items.kind() {
                    Kind::Number => numbers(text)?.iter().map(f64::to_string).collect(),
                    _ => vec![self.fitting(items, text)?],
                };
                let fits = length.is_none_or(|length| length == elements.len());
                fits.then(|| format!("[{}]", elements.join(", ")))
            }
            Kind::Table => {
                let mut required = form.required();
                let (Some(key), None) = (required.next(), required.next()) else { return None };
                let value = self.fitting(form.property(key)?, text)?;
                Some(format!("{{ {key} = {value} }}"))
            }
            Kind::OneOf(choices) => choices.into_iter().find_map(|choice| self.fitting(choice, text)),
        }
    }

    fn unit(self) -> Option<&'static KeyUnit> {
        KEY_UNITS.iter().find(|unit| self.key.ends_with(unit.suffix))
    }
}

fn is_table_list(kind: &Kind) -> bool {
    matches!(kind, Kind::List(items, None) if matches!(items.kind(), Kind::Table))
}

/// Names of which one is expected, in backticks.
pub(crate) fn one_of(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    if quoted.len() > 2 { format!("one of {}", quoted.join(", ")) } else { quoted.join(" or ") }
}

fn finite(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|value: &f64| value.is_finite())
}

/// Numbers with separators between them, as people write a list or an extent.
fn numbers(text: &str) -> Option<Vec<f64>> {
    let text = text.trim_matches(|c: char| matches!(c, '[' | ']' | '(' | ')') || c.is_whitespace());
    let parts = text.split([',', ';', 'x', '*', ' ']).filter(|part| !part.is_empty());
    parts.map(finite).collect::<Option<Vec<f64>>>().filter(|numbers| !numbers.is_empty())
}

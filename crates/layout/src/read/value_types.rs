//! Values of a wrong type: the form that a key wants, and the parser's words for types as words of
//! the format.

use crate::plausible::typed;
use crate::read::value_examples::{list_example, table_example};

/// A value of a type that its key does not take.
pub(crate) struct WrongValue<'t> {
    /// The key of the value, or of the list that the value is in.
    pub(crate) key: &'t str,
    /// The value in the file.
    pub(crate) written: &'t str,
    /// The message of the TOML parser, which names the type that it expected.
    pub(crate) message: &'t str,
    /// Whether the value is in a list.
    pub(crate) is_element: bool,
}

/// The type that the parser expected.
#[derive(Clone, Copy)]
enum Wanted {
    Number,
    Integer,
    Text,
    /// One of the words of an enumeration.
    Word,
    /// A list of as many values, or of any number.
    List(Option<usize>),
    Table,
}

/// A unit and its factor.
type Factor = (&'static str, f64);

/// Units that are written beside a number by mistake, by the end of the key that has its own, and
/// their factors.
const UNITS: [(&str, &str, &[Factor]); 3] = [
    ("_t", "tesla", &[("mT", 1e-3), ("kG", 1e-1), ("G", 1e-4), ("T", 1.0)]),
    ("_mm", "mm", &[("mm", 1.0), ("cm", 10.0), ("um", 1e-3), ("\u{b5}m", 1e-3), ("m", 1e3)]),
    ("_deg", "degrees", &[("degrees", 1.0), ("deg", 1.0), ("\u{b0}", 1.0)]),
];

/// Most characters of a value that are repeated in a message.
const MOST_REPEATED: usize = 40;

impl WrongValue<'_> {
    /// A sentence that says what the key wants, with an example where there is one. `None` if the
    /// message of the parser is not about a type, or if nothing better than it is known.
    pub(crate) fn wanted_form(&self) -> Option<String> {
        let wanted = self.wanted()?;
        let key = self.key;
        let axis = ["x", "y", "z"].iter().position(|letter| self.unquoted().eq_ignore_ascii_case(letter));
        match (key, wanted) {
            ("rotation", _) => Some(
                "a rotation is a table, with an axis and an angle: `rotation = { axis = [0, 0, 1], angle_deg = 30 }` \
                 turns a tile by 30 degrees, right-handed, about z. Other forms: `quaternion = [x, y, z, w]`, \
                 `euler_deg` with `order`, `matrix`"
                    .to_owned(),
            ),
            ("axis", Wanted::List(_)) => {
                let vector = ["[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]"][axis.unwrap_or(2)];
                Some(format!("an axis is a vector of three numbers: write `axis = {vector}`"))
            }
            ("mirror", _) => {
                let axis = ["x", "y", "z"][axis.unwrap_or(0)];
                Some(format!("a mirror is a table: write `mirror = {{ axes = [\"{axis}\"] }}`"))
            }
            ("axes" | "alternate", _) => {
                let axis = ["x", "y", "z"][axis.unwrap_or(0)];
                Some(format!("{key} is a list of axes: write `{key} = [\"{axis}\"]`"))
            }
            ("tile" | "lattice", _) => None,
            (_, Wanted::Table) => Some(self.table()),
            // The parser takes a list for a table with these keys in this order.
            _ if self.is_element && table_example(key).is_some() => Some(self.table()),
            (_, Wanted::List(length)) => Some(self.list(length)),
            (_, Wanted::Number) => Some(self.number()),
            (_, Wanted::Integer) => Some(self.integer()),
            (_, Wanted::Text) => Some(self.text()),
            (_, Wanted::Word) => Some(format!("{} is a word in quotes, not {}", self.subject(), self.found())),
        }
    }

    fn wanted(&self) -> Option<Wanted> {
        if self.message.starts_with("wanted string") {
            return Some(Wanted::Word);
        }
        if !["invalid type", "invalid length"].iter().any(|start| self.message.starts_with(start)) {
            return None;
        }
        let (_, expected) = self.message.trim_end().rsplit_once("expected ")?;
        Some(match expected {
            "f64" => Wanted::Number,
            "i64" | "usize" | "u64" => Wanted::Integer,
            "a string" | "path string" => Wanted::Text,
            "a sequence" => Wanted::List(None),
            "a map" => Wanted::Table,
            _ if expected.starts_with("struct ") => Wanted::Table,
            _ => Wanted::List(Some(expected.strip_prefix("an array of length ")?.parse().ok()?)),
        })
    }

    /// What the value is instead.
    fn found(&self) -> String {
        let written = self.written.trim();
        if let Some(length) = self.message.strip_prefix("invalid length ").and_then(|text| text.split(',').next()) {
            return format!("a list of {length}");
        }
        match written.chars().next() {
            Some('"' | '\'') => "a text".to_owned(),
            Some('[') => "a list".to_owned(),
            Some('{') => "a table".to_owned(),
            Some('t' | 'f') => "true or false".to_owned(),
            _ if self.is_number() => "a number".to_owned(),
            _ => "this".to_owned(),
        }
    }

    fn number(&self) -> String {
        let (subject, text) = (self.subject(), self.unquoted());
        let in_unit = self.unit().map_or(String::new(), |(unit, _)| format!(" in {unit}"));
        if !self.is_quoted() {
            return format!("{subject} is one number{in_unit}, not {}", self.found());
        }
        let with_unit = self.unit().and_then(|(_, factors)| {
            factors.iter().find_map(|(unit, factor)| Some(finite(text.strip_suffix(unit)?)? * factor))
        });
        let without = if self.unit().is_some() { "without quotes and unit" } else { "without quotes" };
        match with_unit.or_else(|| finite(text)).map(typed) {
            Some(value) => format!("{subject} is a number{in_unit}, {without}: write {value}"),
            None => format!("{subject} is a number{in_unit}, not a text"),
        }
    }

    fn integer(&self) -> String {
        let subject = self.subject();
        match self.unquoted().parse::<i64>() {
            Ok(value) if self.is_quoted() => format!("{subject} is an integer, without quotes: write {value}"),
            _ if self.is_number() => format!("{subject} is an integer, not {}", self.written.trim()),
            _ => format!("{subject} is an integer, not {}", self.found()),
        }
    }

    fn text(&self) -> String {
        let (subject, written) = (self.subject(), self.written.trim());
        let is_short = written.chars().count() <= MOST_REPEATED;
        if is_short && !self.is_element && (self.is_number() || matches!(written, "true" | "false")) {
            return format!("{subject} is a text in quotes: write `{} = \"{written}\"`", self.key);
        }
        format!("{subject} is a text in quotes, not {}", self.found())
    }

    fn list(&self, length: Option<usize>) -> String {
        let (key, found) = (self.key, self.found());
        let what = match (key, length) {
            ("matrix", _) if self.is_element => "a list of three numbers".to_owned(),
            ("matrix", _) => "a list of three rows, each of three numbers".to_owned(),
            ("count", Some(_)) => "a list of three integers".to_owned(),
            (_, Some(length)) => {
                let count = ["no", "one", "two", "three", "four"].get(length).map_or(length.to_string(), |&w| w.into());
                let in_unit = self.unit().map_or(String::new(), |(unit, _)| format!(" in {unit}"));
                format!("a list of {count} numbers{in_unit}")
            }
            (_, None) => "a list".to_owned(),
        };
        let subject = self.subject();
        let example = list_example(key, length).filter(|_| !self.is_element);
        let fits = |numbers: &Vec<f64>| match length {
            Some(length) => numbers.len() == length,
            None => example.is_some_and(|example| !example.contains(['{', '"'])),
        };
        if let Some(numbers) = numbers(self.unquoted()).filter(|numbers| !self.is_element && fits(numbers)) {
            let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
            return format!("{subject} is {what}, not {found}: write `{key} = [{}]`", numbers.join(", "));
        }
        let example = example.map_or(String::new(), |example| format!(", as in `{key} = {example}`"));
        format!("{subject} is {what}, not {found}{example}")
    }

    fn table(&self) -> String {
        let key = self.key;
        let found = if self.is_element { "a list".to_owned() } else { self.found() };
        if matches!(key, "ideal" | "volume" | "expect" | "design") {
            return format!("{key} is a table, not {found}: begin it with the line [{key}]");
        }
        let Some(example) = table_example(key) else {
            return format!("{} is a table, not {}", self.subject(), self.found());
        };
        // A bare bound.
        match finite(self.unquoted()) {
            Some(value) if matches!(key, "amplitude" | "clearance_mm") && !self.is_element => {
                format!("{key} is a table, not {found}: write `{key} = {{ min = {value} }}`")
            }
            _ => format!("{key} is a table, not {found}, as in `{key} = {example}`"),
        }
    }

    /// The value as subject of a sentence.
    fn subject(&self) -> String {
        if self.is_element { format!("each value of {}", self.key) } else { self.key.to_owned() }
    }

    /// The unit in which the key has its value, and the units that may stand beside it by mistake.
    fn unit(&self) -> Option<(&'static str, &'static [Factor])> {
        UNITS.iter().find(|(end, _, _)| self.key.ends_with(end)).map(|(_, unit, factors)| (*unit, *factors))
    }

    fn is_quoted(&self) -> bool {
        self.written.trim().starts_with(['"', '\''])
    }

    fn is_number(&self) -> bool {
        self.written.trim().parse::<f64>().is_ok()
    }

    fn unquoted(&self) -> &str {
        self.written.trim().trim_matches(['"', '\''].as_slice()).trim()
    }
}

/// A finite number.
fn finite(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|value: &f64| value.is_finite())
}

/// Numbers with separators between them, as people write a list or an extent.
fn numbers(text: &str) -> Option<Vec<f64>> {
    let text = text.trim_matches(|c: char| matches!(c, '[' | ']' | '(' | ')') || c.is_whitespace());
    let parts = text.split([',', ';', 'x', '*', ' ']).filter(|part| !part.is_empty());
    parts.map(finite).collect::<Option<Vec<f64>>>().filter(|numbers| !numbers.is_empty())
}

/// The parser's message with names of Rust types and of its data model as words of the format.
pub(crate) fn without_rust_names(message: &str) -> String {
    if !["invalid type", "invalid length", "invalid value"].iter().any(|start| message.starts_with(start)) {
        return message.to_owned();
    }
    let Some((found, expected)) = message.rsplit_once("expected ") else { return message.to_owned() };
    let expected = match expected {
        "f64" => "a number".to_owned(),
        "i64" => "an integer".to_owned(),
        "usize" | "u64" => "an integer, at least 0".to_owned(),
        "a sequence" => "a list".to_owned(),
        "a map" => "a table".to_owned(),
        _ if expected.starts_with("struct ") => "a table".to_owned(),
        _ if expected.starts_with("enum ") => "one of the words for this key, in quotes".to_owned(),
        _ => match expected.strip_prefix("an array of length ") {
            Some(length) => format!("a list of {length} values"),
            None => expected.to_owned(),
        },
    };
    let found = found.replace("invalid type: sequence", "invalid type: list").replace("floating point", "number");
    let found = found.replace("invalid type: map", "invalid type: table");
    format!("{found}expected {expected}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(key: &str, written: &str, expected: &str) -> Option<String> {
        let message = format!("invalid type: {written}, expected {expected}");
        WrongValue { key, written, message: &message, is_element: false }.wanted_form()
    }

    #[test]
    fn numbers_in_quotes_are_converted_to_the_unit_of_the_key() {
        for (key, text, value) in [
            ("strength_t", "200 mT", "in tesla, without quotes and unit: write 0.2"),
            ("strength_t", "1.2", "write 1.2"),
            ("amplitude_t", "1200 G", "write 0.12"),
            ("wavelength_mm", "1cm", "write 10"),
            ("wavelength_mm", "0.008 m", "write 8"),
            ("angle_deg", "30 deg", "write 30"),
            ("min", "3", "min is a number, without quotes: write 3"),
        ] {
            let form = form(key, &format!("\"{text}\""), "f64").expect("a form");
            assert!(form.ends_with(value), "{form}");
        }
        assert_eq!(
            form("strength_t", "\"strong\"", "f64").as_deref(),
            Some("strength_t is a number in tesla, not a text")
        );
    }

    #[test]
    fn the_parser_decides_whether_a_list_is_wanted() {
        let wanted = |written: &str| form("size_mm", written, "an array of length 3").expect("a form");
        assert!(
            wanted("\"1\"").starts_with("size_mm is a list of three numbers in mm, not a text, as in `size_mm = [")
        );
        assert!(wanted("1").starts_with("size_mm is a list of three numbers in mm, not a number, as in "));
        for written in ["\"3.3, 1.7, 1\"", "\"3.3x1.7x1\"", "\"[3.3 1.7 1]\""] {
            assert!(wanted(written).ends_with(": write `size_mm = [3.3, 1.7, 1]`"), "{}", wanted(written));
        }
        assert_eq!(form("size_mm", "1", "a type of the future"), None);
    }

    #[test]
    fn types_have_words_of_the_format() {
        for (message, words) in [
            ("invalid type: string \"x\", expected f64", "invalid type: string \"x\", expected a number"),
            ("invalid type: sequence, expected struct VolumeTable", "invalid type: list, expected a table"),
            ("invalid length 2, expected an array of length 3", "invalid length 2, expected a list of 3 values"),
            ("unknown field `f64`", "unknown field `f64`"),
        ] {
            assert_eq!(without_rust_names(message), words);
        }
    }

    /// The key, the value, the type that the parser expected, and the form.
    #[test]
    fn each_type_is_told_with_what_is_written_instead() {
        for (key, written, expected, wanted) in [
            ("samples", "\"10\"", "u64", "samples is an integer, without quotes: write 10"),
            ("samples", "1.5", "u64", "samples is an integer, not 1.5"),
            ("samples", "[1]", "usize", "samples is an integer, not a list"),
            ("samples", "\"ten\"", "i64", "samples is an integer, not a text"),
            ("name", "3", "a string", "name is a text in quotes: write `name = \"3\"`"),
            ("name", "true", "a string", "name is a text in quotes: write `name = \"true\"`"),
            ("name", "[3]", "a string", "name is a text in quotes, not a list"),
            ("name", "{ a = 3 }", "path string", "name is a text in quotes, not a table"),
            ("name", "1979-05-27", "a string", "name is a text in quotes, not this"),
            ("strength_t", "[1, 2]", "f64", "strength_t is one number in tesla, not a list"),
            ("angle_deg", "false", "f64", "angle_deg is one number in degrees, not true or false"),
            ("min", "{}", "f64", "min is one number, not a table"),
            ("axis", "\"Y\"", "an array of length 3", "an axis is a vector of three numbers: write `axis = [0, 1, 0]`"),
            ("axis", "3", "an array of length 3", "an axis is a vector of three numbers: write `axis = [0, 0, 1]`"),
            ("mirror", "\"z\"", "struct MirrorTable", "a mirror is a table: write `mirror = { axes = [\"z\"] }`"),
            ("axes", "\"y\"", "a sequence", "axes is a list of axes: write `axes = [\"y\"]`"),
            ("ideal", "3", "struct IdealTable", "ideal is a table, not a number: begin it with the line [ideal]"),
            ("amplitude", "0.8", "a map", "amplitude is a table, not a number: write `amplitude = { min = 0.8 }`"),
            ("unheard-of", "0.8", "a map", "unheard-of is a table, not a number"),
        ] {
            assert_eq!(form(key, written, expected).as_deref(), Some(wanted));
        }
        assert_eq!(form("tile", "3", "a sequence"), None);
        assert!(form("rotation", "30", "struct RotationTable").is_some_and(|form| form.starts_with("a rotation is a")));
        let long = "7".repeat(MOST_REPEATED + 1);
        assert_eq!(form("name", &long, "a string").as_deref(), Some("name is a text in quotes, not a number"));
    }

    #[test]
    fn values_in_lists_words_and_lengths_have_forms() {
        let form = |key: &str, written: &str, message: &str, is_element: bool| {
            WrongValue { key, written, message, is_element }.wanted_form().expect("a form")
        };
        assert_eq!(
            form("size_mm", "\"x\"", "invalid type: string \"x\", expected f64", true),
            "each value of size_mm is a number in mm, not a text"
        );
        assert_eq!(
            form("symmetry", "4", "wanted string or table", false),
            "symmetry is a word in quotes, not a number"
        );
        let short = form("size_mm", "[1, 2]", "invalid length 2, expected an array of length 3", false);
        assert!(short.starts_with("size_mm is a list of three numbers in mm, not a list of 2, as in"), "{short}");
        let matrix =
            |is_element: bool| form("matrix", "[1, 2]", "invalid length 2, expected an array of length 3", is_element);
        assert!(matrix(false).starts_with("matrix is a list of three rows, each of three numbers, not a list of 2"));
        assert_eq!(matrix(true), "each value of matrix is a list of three numbers, not a list of 2");
        let count = form("count", "4", "invalid type: integer `4`, expected an array of length 3", false);
        assert!(count.starts_with("count is a list of three integers, not a number"), "{count}");
    }
}

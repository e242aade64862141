//! Values of a wrong type: the form that a key wants, and the parser's words for types as words of
//! the format.

use crate::plausible::typed;

/// A unit and its factor.
type Factor = (&'static str, f64);

/// Units that are written beside a number by mistake, by the end of the key that has its own, and
/// their factors.
const UNITS: [(&str, &str, &[Factor]); 3] = [
    ("_t", "tesla", &[("mT", 1e-3), ("kG", 1e-1), ("G", 1e-4), ("T", 1.0)]),
    ("_mm", "mm", &[("mm", 1.0), ("cm", 10.0), ("um", 1e-3), ("\u{b5}m", 1e-3), ("m", 1e3)]),
    ("_deg", "degrees", &[("degrees", 1.0), ("deg", 1.0), ("\u{b0}", 1.0)]),
];

/// The form of the value of a key, with an example. `written` is the value in the file.
pub(crate) fn wanted_form(key: &str, written: &str) -> Option<String> {
    let text = written.trim().trim_matches(['"', '\''].as_slice()).trim();
    let axis = ["x", "y", "z"].iter().position(|letter| text.eq_ignore_ascii_case(letter));
    match key {
        "rotation" => Some(
            "a rotation is a table, with an axis and an angle: `rotation = { axis = [0, 0, 1], angle_deg = 30 }` turns a \
             tile by 30 degrees, right-handed, about z. Other forms: `quaternion = [x, y, z, w]`, `euler_deg` with \
             `order`, `matrix`"
                .to_owned(),
        ),
        "axis" => {
            let vector = ["[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]"][axis.unwrap_or(2)];
            Some(format!("an axis is a vector of three numbers: write `axis = {vector}`"))
        }
        "mirror" | "axes" | "alternate" => {
            let list = format!("[\"{}\"]", ["x", "y", "z"][axis.unwrap_or(0)]);
            Some(match key {
                "mirror" => format!("a mirror is a table: write `mirror = {{ axes = {list} }}`"),
                _ => format!("{key} is a list of axes: write `{key} = {list}`"),
            })
        }
        _ if written.trim().starts_with(['"', '\'']) => number_without_unit(key, text),
        _ => None,
    }
}

/// How to write a number that stands in quotes, with or without its unit.
fn number_without_unit(key: &str, text: &str) -> Option<String> {
    let (_, unit, factors) = UNITS.iter().find(|(end, _, _)| key.ends_with(end))?;
    let parsed = |text: &str| text.trim().parse::<f64>().ok().filter(|value| value.is_finite());
    let with_unit = factors.iter().find_map(|(unit, factor)| Some(parsed(text.strip_suffix(unit)?)? * factor));
    let value = typed(with_unit.or_else(|| parsed(text))?);
    Some(format!("{key} is a number in {unit}, without quotes and unit: write {value}"))
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

    #[test]
    fn numbers_in_quotes_are_converted_to_the_unit_of_the_key() {
        for (key, text, value) in [
            ("strength_t", "200 mT", "in tesla, without quotes and unit: write 0.2"),
            ("strength_t", "1.2", "write 1.2"),
            ("amplitude_t", "1200 G", "write 0.12"),
            ("wavelength_mm", "1cm", "write 10"),
            ("wavelength_mm", "0.008 m", "write 8"),
            ("angle_deg", "30 deg", "write 30"),
        ] {
            let form = wanted_form(key, &format!("\"{text}\"")).expect("a form");
            assert!(form.ends_with(value), "{form}");
        }
        for (key, text) in [("strength_t", "\"strong\""), ("strength_t", "[1, 2, 3]"), ("name", "3")] {
            assert_eq!(wanted_form(key, text), None);
        }
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
}

//! The JSON Schema of the layout file, generated from the types that read it.
//!
//! Documents are checked against the text `schema.json`, which a test compares with the types.
//! After a change of the types, `UPDATE_EXPECT=1 cargo test -p magsplice-layout schema` writes it.
//! The code that generates the schema has four times the size of its text.

use std::sync::LazyLock;

use schemars::Schema;
use schemars::generate::SchemaSettings;
use schemars::transform::{RecursiveTransform, Transform};
use serde_json::Value;

use crate::file::LayoutFile;

/// The schema with an example of many values, as TOML under the key `example`.
pub(crate) static SCHEMA: LazyLock<Value> =
    LazyLock::new(|| serde_json::from_str(include_str!("schema.json")).expect("a test compares it"));

/// The JSON Schema (draft 2020-12) of layout files, with a description of every key, for editors
/// and other programs.
///
/// The schema has the keys and their types. Rules between keys are checked by
/// [`Layout::parse`](crate::Layout::parse) only.
///
/// # Example
/// ```
/// let schema = magsplice_layout::schema();
/// assert_eq!(schema.get("title").unwrap(), "magsplice layout");
/// ```
pub fn schema() -> Schema {
    let mut schema = schema_with_examples();
    RecursiveTransform(|schema: &mut Schema| drop(schema.remove("example"))).transform(&mut schema);
    schema
}

fn schema_with_examples() -> Schema {
    let settings = SchemaSettings::draft2020_12().with_transform(RecursiveTransform(in_words_of_toml));
    settings.into_generator().into_root_schema_for::<LayoutFile>()
}

/// Refuses unknown keys. Removes null, which TOML does not have: an optional key is left out. Joins
/// the lines of descriptions, which the source wraps at 100 columns.
fn in_words_of_toml(schema: &mut Schema) {
    if let Some(Value::Array(types)) = schema.get_mut("type") {
        types.retain(|name| name != "null");
        if let [only] = &types[..] {
            let only = only.clone();
            schema.insert("type".to_owned(), only);
        }
    }
    if let Some(Value::Array(choices)) = schema.get_mut("anyOf") {
        choices.retain(|choice| choice.get("type").is_none_or(|name| name != "null"));
        if let [Value::Object(only)] = &choices[..] {
            let only = only.clone();
            schema.remove("anyOf");
            only.into_iter().for_each(|(key, value)| drop(schema.insert(key, value)));
        }
    }
    if schema.get("properties").is_some() {
        schema.insert("additionalProperties".to_owned(), Value::Bool(false));
    }
    if schema.get("default") == Some(&Value::Null) {
        schema.remove("default");
    }
    if let Some(Value::String(description)) = schema.get_mut("description") {
        *description = description.replace('\n', " ");
    }
}

#[cfg(test)]
mod tests {
    use expect_test::expect_file;
    use serde::Serialize;
    use serde_json::Serializer;
    use serde_json::ser::PrettyFormatter;

    use super::*;

    /// One line for each value, without indentation.
    #[test]
    fn schema_text_is_that_of_the_types() {
        let mut text = Vec::new();
        let schema = schema_with_examples().to_value();
        schema.serialize(&mut Serializer::with_formatter(&mut text, PrettyFormatter::with_indent(b""))).unwrap();
        expect_file!["schema.json"].assert_eq(&(String::from_utf8(text).unwrap() + "\n"));
    }

    /// Null is no value of TOML: types and choices lose it, and defaults of null go. Tables accept
    /// no other keys.
    #[test]
    fn schema_has_no_null() {
        let in_words = |value: Value| {
            let mut schema = Schema::try_from(value).unwrap();
            in_words_of_toml(&mut schema);
            schema.to_value()
        };
        let json = |text: &str| serde_json::from_str::<Value>(text).unwrap();
        for (before, after) in [
            (r#"{"type": ["number", "null"], "default": null}"#, r#"{"type": "number"}"#),
            (r#"{"type": ["number", "string"], "default": 3}"#, r#"{"type": ["number", "string"], "default": 3}"#),
            (r#"{"anyOf": [{"type": "null"}, {"$ref": "a", "minimum": 1}]}"#, r#"{"$ref": "a", "minimum": 1}"#),
            (
                r#"{"anyOf": [{"type": "null"}, {"$ref": "a"}, {"type": "number"}]}"#,
                r#"{"anyOf": [{"$ref": "a"}, {"type": "number"}]}"#,
            ),
            (r#"{"properties": {}}"#, r#"{"properties": {}, "additionalProperties": false}"#),
            (r#"{"description": "two\nlines"}"#, r#"{"description": "two lines"}"#),
        ] {
            assert_eq!(in_words(json(before)), json(after), "{before}");
        }
    }
}

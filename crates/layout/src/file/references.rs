//! The files to which the text of a layout refers.

use std::collections::BTreeSet;

use toml::de::{DeTable, DeValue};

/// Keys of names of files: `file` of `[expect].field` and of measured errors, `layout` of
/// `[tolerance.neighbour]`.
const KEYS: [&str; 2] = ["file", "layout"];

/// The files to which a layout refers, as it names them: baselines, measured errors and neighbours.
/// Every text at a key of such a name counts, also where the layout breaks a rule. `None` if the
/// text is not TOML.
///
/// # Example
/// ```
/// let text = "[expect]\nfield = { file = \"film.field.csv\", within = 1e-9 }\n";
/// let files = magsplice_layout::referenced_files(text).expect("TOML");
/// assert!(files.contains("film.field.csv"));
/// ```
pub fn referenced_files(text: &str) -> Option<BTreeSet<String>> {
    let table = DeTable::parse(text).ok()?;
    let mut files = BTreeSet::new();
    add_of_table(table.get_ref(), &mut files);
    Some(files)
}

fn add_of_table(table: &DeTable, files: &mut BTreeSet<String>) {
    for (key, value) in table {
        match value.get_ref() {
            DeValue::String(name) if KEYS.contains(&&**key.get_ref()) => drop(files.insert(name.to_string())),
            value => add_of_value(value, files),
        }
    }
}

fn add_of_value(value: &DeValue, files: &mut BTreeSet<String>) {
    match value {
        DeValue::Table(table) => add_of_table(table, files),
        DeValue::Array(values) => values.iter().for_each(|value| add_of_value(value.get_ref(), files)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;
    use crate::file::schema::schema;

    #[test]
    fn references_are_found_in_every_form() {
        let text = r#"
            name = "film.csv"
            expect.field = { file = "field.csv", within = 1e-9 }
            [tolerance]
            position_mm = [{ file = "x.csv" }, { normal = 0.1 }, { "file" = 'z.csv' }]
            [tolerance.neighbour]
            "layout" = "../jaw.toml"
            [[tolerance.group]]
            strength_pct.file = "strength.csv"
        "#;
        let found = referenced_files(text).expect("TOML");
        let found: Vec<&str> = found.iter().map(String::as_str).collect();
        assert_eq!(found, ["../jaw.toml", "field.csv", "strength.csv", "x.csv", "z.csv"]);
        assert_eq!(referenced_files(crate::COMMENTED_LAYOUT), Some(BTreeSet::new()));
        assert_eq!(referenced_files("file = "), None);
    }

    /// A key of the schema that is relative to the folder of the layout is one of [`KEYS`].
    #[test]
    fn keys_of_the_schema_that_name_files_are_known() {
        fn count(node: &Value) -> usize {
            let of_properties = node.get("properties").and_then(Value::as_object).into_iter().flatten();
            let names = of_properties.filter(|(key, value)| {
                let is_path = value["description"].as_str().is_some_and(|text| text.contains("relative to the folder"));
                assert_eq!(is_path, KEYS.contains(&key.as_str()), "{key}: {value}");
                is_path
            });
            let here = names.count();
            let below: usize = match node {
                Value::Object(map) => map.values().map(count).sum(),
                Value::Array(values) => values.iter().map(count).sum(),
                _ => 0,
            };
            here + below
        }
        let schema = serde_json::to_value(schema()).expect("JSON");
        assert_eq!(count(&schema), 3, "[expect].field, measured errors, [tolerance.neighbour]");
    }
}

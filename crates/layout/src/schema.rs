//! The JSON Schema of the layout file, generated from the types that read it.

use schemars::Schema;
use schemars::generate::SchemaSettings;
use schemars::transform::{Transform, transform_subschemas};
use serde_json::Value;

use crate::tables::LayoutFile;

/// The JSON Schema (draft 2020-12) of layout files, with a description of every key, for editors
/// and other programs.
///
/// The schema states the keys and their types. Rules between keys are checked by
/// [`Layout::parse`](crate::Layout::parse) only.
///
/// # Example
/// ```
/// let schema = magsplice_layout::schema();
/// assert_eq!(schema.get("title").unwrap(), "magsplice layout");
/// ```
pub fn schema() -> Schema {
    let mut schema = schema_with_examples();
    WithoutExamples.transform(&mut schema);
    schema
}

/// The schema with an example of many values, as TOML under the key `example`.
pub(crate) fn schema_with_examples() -> Schema {
    SchemaSettings::draft2020_12()
        .with_transform(WithoutNull)
        .with_transform(UnwrappedDescriptions)
        .into_generator()
        .into_root_schema_for::<LayoutFile>()
}

/// Removes null from the types of optional keys: TOML has no null, an optional key is left out.
#[derive(Clone)]
struct WithoutNull;

impl Transform for WithoutNull {
    fn transform(&mut self, schema: &mut Schema) {
        if let Some(Value::Array(types)) = schema.get_mut("type") {
            types.retain(|name| name != "null");
            if let [only] = &types[..] {
                let only = only.clone();
                schema.insert("type".to_owned(), only);
            }
        }
        if let Some(Value::Array(choices)) = schema.get_mut("anyOf") {
            choices.retain(|choice| choice.get("type").is_none_or(|name| name != "null"));
            if let [only] = &choices[..]
                && let Some(only) = only.as_object().cloned()
            {
                schema.remove("anyOf");
                for (key, value) in only {
                    schema.insert(key, value);
                }
            }
        }
        transform_subschemas(self, schema);
    }
}

/// Joins the lines of each description: in the source they are wrapped at 100 columns.
#[derive(Clone)]
struct UnwrappedDescriptions;

impl Transform for UnwrappedDescriptions {
    fn transform(&mut self, schema: &mut Schema) {
        if let Some(Value::String(description)) = schema.get_mut("description") {
            *description = description.replace('\n', " ");
        }
        transform_subschemas(self, schema);
    }
}

/// Removes the examples, which are not JSON.
#[derive(Clone)]
struct WithoutExamples;

impl Transform for WithoutExamples {
    fn transform(&mut self, schema: &mut Schema) {
        schema.remove("example");
        transform_subschemas(self, schema);
    }
}

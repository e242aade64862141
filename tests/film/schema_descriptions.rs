//! The descriptions of keys in the JSON Schema of layout files, which editors show.

use magsplice::layout::schema;
use serde_json::{Value, json};

#[test]
fn every_key_has_a_description_that_is_a_sentence() {
    fn described(value: &Value, at: &str, keys: &mut usize) {
        if let Some(properties) = value.get("properties").and_then(Value::as_object) {
            for (key, property) in properties {
                let description = property.get("description").and_then(Value::as_str).unwrap_or("");
                assert!(
                    description.len() > 5 && description.ends_with('.') && !description.contains('\n'),
                    "{at}/{key}: {description:?}"
                );
                *keys += 1;
            }
        }
        match value {
            Value::Object(members) => members.iter().for_each(|(key, v)| described(v, &format!("{at}/{key}"), keys)),
            Value::Array(items) => items.iter().for_each(|v| described(v, at, keys)),
            _ => {}
        }
        assert_ne!(value, &json!("null"), "{at}: TOML has no null");
    }
    let mut keys = 0;
    described(schema().as_value(), "", &mut keys);
    assert!(keys > 45, "{keys}");
}

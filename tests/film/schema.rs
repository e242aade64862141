//! The JSON Schema of layout files against the files.

use std::fs;

use jsonschema::Validator;
use magsplice::layout::{COMMENTED_LAYOUT, Layout, schema};
use serde_json::{Value, json};

use crate::shipped::{EVERY_KEY, folder};

fn validator() -> Validator {
    jsonschema::draft202012::new(schema().as_value()).expect("a valid schema")
}

fn documents() -> Vec<(String, String)> {
    let mut all = vec![("the commented layout".to_owned(), COMMENTED_LAYOUT.to_owned())];
    for entry in fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            all.push((path.display().to_string(), fs::read_to_string(path).unwrap()));
        }
    }
    assert!(all.len() >= 6, "{}", all.len());
    // A layout with every key of the format.
    all.push(("every key".to_owned(), EVERY_KEY.to_owned()));
    all
}

fn as_json(text: &str) -> Value {
    toml::from_str(text).expect("TOML")
}

#[test]
fn shipped_layouts_and_their_plain_forms_match_the_schema() {
    let validator = validator();
    for (name, text) in documents() {
        let layout = Layout::parse(&text, &name).unwrap_or_else(|e| panic!("{e}"));
        for document in [as_json(&text), as_json(&layout.to_toml()), serde_json::to_value(layout.plain()).unwrap()] {
            let errors: Vec<String> =
                validator.iter_errors(&document).map(|e| format!("{}: {e}", e.instance_path())).collect();
            assert_eq!(errors, [""; 0], "{name}");
        }
    }
}

/// All objects of a document, by their JSON pointers.
fn objects(value: &Value, at: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(members) => {
            found.push(at.to_owned());
            members.iter().for_each(|(key, member)| objects(member, &format!("{at}/{key}"), found));
        }
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, item)| objects(item, &format!("{at}/{i}"), found));
        }
        _ => {}
    }
}

/// Schema and program both refuse an unknown key in any table, a missing key and a wrong type.
#[test]
fn schema_and_program_refuse_the_same_documents() {
    let validator = validator();
    let document = as_json(EVERY_KEY);
    let mut places = Vec::new();
    objects(&document, "", &mut places);
    // A kind may have any name.
    places.retain(|place| place != "/kind");
    assert!(places.len() > 20, "{places:?}");
    let refused = |document: &Value, what: &str| {
        assert!(!validator.is_valid(document), "the schema accepts {what}");
        let text = toml::to_string(document).unwrap();
        assert!(Layout::parse(&text, "changed").is_err(), "the program accepts {what}");
    };
    for place in &places {
        let mut wrong = document.clone();
        wrong.pointer_mut(place).unwrap().as_object_mut().unwrap().insert("colour".to_owned(), json!("red"));
        refused(&wrong, &format!("{place}/colour"));
    }
    for (place, value) in [
        ("/format", json!(2)),
        ("/name", json!(3)),
        ("/tile/0/position_mm", json!([1, 2])),
        ("/tile/0/grid/count", json!([1, -2, 1])),
        ("/tile/0/mirror/axes", json!(["w"])),
        ("/tile/0/mirror/polarization", json!("kept")),
        ("/volume/step_mm", json!("fine")),
        ("/lattice/0/x/0/times", json!(1.5)),
        ("/tolerance/position_mm/0", json!("small")),
        ("/tolerance/position_mm/1", json!({ "normal": "much" })),
        ("/tolerance/size_mm", json!({ "values": 1 })),
        ("/tolerance/group/0/rows_along", json!("w")),
        ("/tolerance/stray_field/when", json!("later")),
        ("/tolerance/samples", json!(-1)),
        ("/expect/made/percentile", json!("most")),
        ("/design/under", json!("errors")),
    ] {
        let mut wrong = document.clone();
        *wrong.pointer_mut(place).unwrap() = value;
        refused(&wrong, place);
    }
    for (table, key) in
        [("", "format"), ("", "name"), ("/tile/0", "position_mm"), ("/lattice/0", "x"), ("/expect/field", "within")]
    {
        let mut wrong = document.clone();
        wrong.pointer_mut(table).unwrap().as_object_mut().unwrap().remove(key).unwrap();
        refused(&wrong, key);
    }
}

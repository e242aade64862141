//! Values set in the text of a layout file.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use thiserror::Error;
use toml_edit::ser::ValueSerializer;
use toml_edit::{DocumentMut, Item, Table, TableLike};

use super::edit::set;

/// A value to set in the text of a layout file, or a key to remove from it.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct TextEdit {
    /// Keys of tables and indices of lists, from the top of the file.
    pub path: Vec<PathStep>,
    /// The value; `None` removes the key, and the tables that it leaves empty unless a comment
    /// stands above them.
    pub value: Option<Value>,
}

/// A step into a table or a list.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(untagged)]
pub enum PathStep {
    /// The index in a list.
    Index(usize),
    /// The key of a table.
    Key(String),
}

/// The reason why a value cannot be set.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TextEditError {
    /// The text is not TOML.
    #[error("the layout is not TOML: {0}")]
    NotToml(String),
    /// The path leads through a value that is neither a table nor a list, or past the end of a
    /// list.
    #[error("{0}: the layout has no such table")]
    NoTable(String),
    /// TOML has no such value.
    #[error("{0}: {1}")]
    NoValue(String, String),
}

/// The text of a layout file with values set. Comments, order and format of the rest stay. Tables
/// that are missing are added at the end. The result may break the rules of layouts.
///
/// # Errors
/// If the text is not TOML, or has no place for a value.
///
/// # Example
/// ```
/// use magsplice_layout::{PathStep, TextEdit, edited_text};
///
/// let path = ["ideal", "amplitude_t"].map(|key| PathStep::Key(key.to_owned()));
/// let edit = TextEdit { path: path.to_vec(), value: Some(0.1.into()) };
/// let text = edited_text("[ideal]\namplitude_t = 0.12 # measured\n", &[edit])?;
/// assert_eq!(text, "[ideal]\namplitude_t = 0.1 # measured\n");
/// # Ok::<(), magsplice_layout::TextEditError>(())
/// ```
pub fn edited_text(text: &str, edits: &[TextEdit]) -> Result<String, TextEditError> {
    let mut document: DocumentMut =
        text.parse().map_err(|error: toml_edit::TomlError| TextEditError::NotToml(error.to_string()))?;
    for TextEdit { path, value } in edits {
        match value {
            Some(value) => {
                let value = value.serialize(ValueSerializer::new());
                let value = value.map_err(|error| TextEditError::NoValue(written(path), error.to_string()))?;
                let missing = || TextEditError::NoTable(written(path));
                set_at(document.as_item_mut(), path, value).ok_or_else(missing)?;
            }
            None => {
                removed(document.as_item_mut(), path);
            }
        }
    }
    let written = document.to_string();
    Ok(if text.contains("\r\n") { written.replace("\r\n", "\n").replace('\n', "\r\n") } else { written })
}

/// The tables of the text of a layout file, as they are written. Numbers that JSON lacks, such as
/// inf, are null.
///
/// # Errors
/// If the text is not TOML.
pub fn document_of(text: &str) -> Result<Value, TextEditError> {
    let not_toml = |error: String| TextEditError::NotToml(error);
    let table: toml::Table = toml::from_str(text).map_err(|error| not_toml(error.to_string()))?;
    serde_json::to_value(table).map_err(|error| not_toml(error.to_string()))
}

/// A path as people write it: `tile[2].position_mm`.
fn written(path: &[PathStep]) -> String {
    let step = |step: &PathStep| match step {
        PathStep::Index(index) => format!("[{index}]"),
        PathStep::Key(key) => format!(".{key}"),
    };
    let steps: String = path.iter().map(step).collect();
    steps.trim_start_matches('.').to_owned()
}

/// Sets a value below an item. `None` if it has no place there.
fn set_at(item: &mut Item, path: &[PathStep], value: toml_edit::Value) -> Option<()> {
    let (step, rest) = path.split_first()?;
    match step {
        PathStep::Index(index) if rest.is_empty() => replace(list(item)?.get_mut(*index)?, value),
        PathStep::Index(index) => set_at_index(item, *index, rest, value)?,
        PathStep::Key(key) => {
            let is_inline = item.is_inline_table();
            let table = item.as_table_like_mut()?;
            if rest.is_empty() {
                match table.get_mut(key) {
                    Some(Item::Value(own)) => replace(own, value),
                    _ => set(table, key, Item::Value(value)),
                }
            } else {
                set_at(child(table, key, rest, is_inline)?, rest, value)?;
            }
        }
    }
    Some(())
}

/// Sets a value below an element of a list. A list that ends before it grows by one table.
fn set_at_index(item: &mut Item, index: usize, rest: &[PathStep], value: toml_edit::Value) -> Option<()> {
    match item {
        Item::ArrayOfTables(tables) => {
            if index == tables.len() {
                tables.push(Table::new());
            }
            set_in(tables.get_mut(index)?, rest, value)
        }
        _ => match list(item)?.get_mut(index)? {
            toml_edit::Value::InlineTable(table) => set_in(table, rest, value),
            toml_edit::Value::Array(_) => {
                let element = list(item)?.get_mut(index)?;
                let mut inner = Item::Value(element.clone());
                set_at(&mut inner, rest, value)?;
                *element = inner.into_value().ok()?;
                Some(())
            }
            _ => None,
        },
    }
}

fn set_in(table: &mut dyn TableLike, path: &[PathStep], value: toml_edit::Value) -> Option<()> {
    let (PathStep::Key(key), rest) = path.split_first()? else { return None };
    if rest.is_empty() {
        match table.get_mut(key) {
            Some(Item::Value(own)) => replace(own, value),
            _ => set(table, key, Item::Value(value)),
        }
        return Some(());
    }
    set_at(child(table, key, rest, true)?, rest, value)
}

/// The item of a key that `rest` leads into, added if it is missing.
fn child<'t>(table: &'t mut dyn TableLike, key: &str, rest: &[PathStep], is_inline: bool) -> Option<&'t mut Item> {
    if table.get(key).is_none_or(Item::is_none) {
        let mut own = Table::new();
        // A table that holds tables alone has no line of its own.
        own.set_implicit(true);
        let added = match (rest.first()?, is_inline) {
            (PathStep::Index(_), false) => Item::ArrayOfTables(toml_edit::ArrayOfTables::new()),
            (PathStep::Index(_), true) => return None,
            (PathStep::Key(_), false) => Item::Table(own),
            (PathStep::Key(_), true) => toml_edit::value(toml_edit::InlineTable::new()),
        };
        table.insert(key, added);
    }
    table.get_mut(key)
}

/// Replaces a value. The comments beside it stay, and a list of as many elements keeps their
/// places on its lines.
fn replace(own: &mut toml_edit::Value, mut value: toml_edit::Value) {
    match (&mut *own, &value) {
        (toml_edit::Value::Array(old), toml_edit::Value::Array(new)) if old.len() == new.len() => {
            old.iter_mut().zip(new.iter()).for_each(|(old, new)| replace(old, new.clone()));
        }
        (old, new) if number(old).is_some() && number(old) == number(new) => {}
        _ => {
            // A number with decimals keeps them: -6.0 beside -5.0.
            if let (toml_edit::Value::Float(_), Some(new)) = (&*own, value.as_integer()) {
                value = toml_edit::Value::from(new as f64);
            }
            *value.decor_mut() = own.decor().clone();
            *own = value;
        }
    }
}

fn number(value: &toml_edit::Value) -> Option<f64> {
    value.as_float().or(value.as_integer().map(|integer| integer as f64))
}

fn list(item: &mut Item) -> Option<&mut toml_edit::Array> {
    item.as_value_mut()?.as_array_mut()
}

/// Removes a key, and the tables above that it leaves empty. Whether the item is empty then, and
/// may go.
fn removed(item: &mut Item, path: &[PathStep]) -> bool {
    match path {
        [PathStep::Key(key)] => {
            if let Some(table) = item.as_table_like_mut() {
                table.remove(key);
            }
        }
        [PathStep::Index(index)] => match item {
            Item::ArrayOfTables(tables) if *index < tables.len() => drop(tables.remove(*index)),
            _ => {
                if let Some(list) = list(item).filter(|list| *index < list.len()) {
                    list.remove(*index);
                }
            }
        },
        [PathStep::Key(key), rest @ ..] => {
            if let Some(table) = item.as_table_like_mut()
                && table.get_mut(key).is_some_and(|child| removed(child, rest))
            {
                table.remove(key);
            }
        }
        [PathStep::Index(index), rest @ ..] => {
            if let Item::ArrayOfTables(tables) = item
                && let Some(table) = tables.get_mut(*index)
            {
                let mut inner = Item::Table(table.clone());
                removed(&mut inner, rest);
                if let Item::Table(inner) = inner {
                    *table = inner;
                }
            }
        }
        [] => {}
    }
    match item {
        Item::ArrayOfTables(tables) => tables.is_empty(),
        Item::Table(table) => {
            let above = table.decor().prefix().and_then(|prefix| prefix.as_str()).unwrap_or_default();
            table.is_empty() && !above.contains('#')
        }
        _ => item.as_table_like().is_some_and(TableLike::is_empty),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edit(path: &str, value: Value) -> TextEdit {
        let step = |step: &str| step.parse().map_or_else(|_| PathStep::Key(step.to_owned()), PathStep::Index);
        TextEdit { path: path.split('.').map(step).collect(), value: (!value.is_null()).then_some(value) }
    }

    fn edited(text: &str, path: &str, value: Value) -> String {
        edited_text(text, &[edit(path, value)]).expect("a place for the value")
    }

    #[test]
    fn values_change_beside_their_comments() {
        let text = "# top\n[volume]\nz_mm = [-5.0, # far\n  -3.0] # near\nstep_mm = 0.5 # fine\n";
        let moved = edited(text, "volume.z_mm", serde_json::json!([-4.5, -3.0]));
        assert_eq!(moved, text.replace("-5.0", "-4.5"));
        assert_eq!(edited(text, "volume.z_mm.1", 2.into()), text.replace("-3.0", "2.0"));
        assert_eq!(edited(text, "volume.step_mm", 0.25.into()), text.replace("0.5", "0.25"));
        // A number that is as before keeps its form.
        assert_eq!(edited("a = 0.50 # x\n", "a", 0.5.into()), "a = 0.50 # x\n");
        assert_eq!(edited("a = 1\r\nb = 2\r\n", "b", 3.into()), "a = 1\r\nb = 3\r\n");
        assert_eq!(edited("a = -5.0\n", "a", (-6).into()), "a = -6.0\n");
    }

    #[test]
    fn elements_of_lists_change_by_themselves() {
        let plain = "[[tile]]\nname = \"a\"\nposition_mm = [1, 2, 3]\n\n# second\n[[tile]]\nname = \"b\"\n";
        let named = edited(plain, "tile.1.name", "c".into());
        assert_eq!(named, plain.replace("\"b\"", "\"c\""));
        let compact = "tile = [\n  { name = \"a\", position_mm = [1, 2, 3] }, # one\n]\n";
        let moved = edited(compact, "tile.0.position_mm", serde_json::json!([1, 2.5, 3]));
        assert_eq!(moved, compact.replace("2,", "2.5,"));
        let lattice = "[[lattice]]\nx = [{ widths_mm = [1.0, 2.0], times = 2 }] # cuts\n";
        let cut = edited(lattice, "lattice.0.x.0.widths_mm", serde_json::json!([1.5, 1.5]));
        assert_eq!(cut, lattice.replace("1.0, 2.0", "1.5, 1.5"));
    }

    #[test]
    fn missing_tables_are_added_and_empty_ones_removed() {
        let text = "format = 1\n\n[ideal]\namplitude_t = 0.1\n";
        let with = edited(text, "tolerance.stray_field.any_direction_ut", 50.into());
        assert_eq!(with, format!("{text}\n[tolerance.stray_field]\nany_direction_ut = 50\n"));
        assert_eq!(edited(&with, "tolerance.stray_field.any_direction_ut", Value::Null), text);
        let commented = "# Ours.\n[sensor]\npart = \"TLV493D\"\n";
        assert_eq!(edited(commented, "sensor.part", Value::Null), "# Ours.\n[sensor]\n");
        let with = edited(text, "plane.0.normal", serde_json::json!([0, 0, -1]));
        assert_eq!(with, format!("{text}\n[[plane]]\nnormal = [0, 0, -1]\n"));
        assert_eq!(edited(&with, "plane.0", Value::Null), text);
        let with = edited(text, "sensor.rotation", serde_json::json!({ "axis": [1, 0, 0], "angle_deg": 2.5 }));
        assert_eq!(with, format!("{text}\n[sensor]\nrotation = {{ angle_deg = 2.5, axis = [1, 0, 0] }}\n"));
        let edits = [edit("tolerance.preset", "jig".into()), edit("tolerance.sensor.noise_ut", 1.into())];
        let both = edited_text(text, &edits).expect("places");
        assert_eq!(both, format!("{text}\n[tolerance]\npreset = \"jig\"\n\n[tolerance.sensor]\nnoise_ut = 1\n"));
    }

    #[test]
    fn values_without_a_place_are_errors() {
        let error = |text, path, value| edited_text(text, &[edit(path, value)]).expect_err("no place").to_string();
        assert_eq!(error("a = 1\n", "a.b", 2.into()), "a.b: the layout has no such table");
        assert_eq!(error("a = [1]\n", "a.3", 2.into()), "a[3]: the layout has no such table");
        assert_eq!(error("[[tile]]\n", "tile.7.name", "x".into()), "tile[7].name: the layout has no such table");
        assert!(error("a = [", "a", 2.into()).starts_with("the layout is not TOML"));
        assert!(error("a = 1\n", "a", serde_json::json!([null])).starts_with("a: "));
        // What is not there needs no removal.
        assert_eq!(edited("a = 1\n", "b.c", Value::Null), "a = 1\n");
    }
}

//! A layout in the plain form, for any format of serde.

use serde::ser::{Error, Serialize, Serializer};
use toml_edit::{DocumentMut, Value};

use crate::file::LayoutFile;

/// A layout in the plain form: repetitions written out as one `tile` each. It only serializes, as
/// an object with the keys of a layout file, in their order and without those that are not given;
/// see [`Layout::plain`](crate::Layout::plain).
pub struct PlainLayout(DocumentMut);

impl From<&LayoutFile> for PlainLayout {
    fn from(file: &LayoutFile) -> PlainLayout {
        PlainLayout(toml_edit::ser::to_document(file).expect("numbers and strings can always be written as TOML"))
    }
}

impl Serialize for PlainLayout {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().filter_map(|(key, item)| Some((key, item.as_value().map(PlainValue)?))))
    }
}

struct PlainValue<'a>(&'a Value);

impl Serialize for PlainValue<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            Value::String(text) => serializer.serialize_str(text.value()),
            Value::Integer(number) => serializer.serialize_i64(*number.value()),
            Value::Float(number) => serializer.serialize_f64(*number.value()),
            Value::Boolean(is_true) => serializer.serialize_bool(*is_true.value()),
            Value::Array(list) => serializer.collect_seq(list.iter().map(PlainValue)),
            Value::InlineTable(table) => {
                serializer.collect_map(table.iter().map(|(key, value)| (key, PlainValue(value))))
            }
            Value::Datetime(_) => Err(S::Error::custom("a layout has no dates")),
        }
    }
}

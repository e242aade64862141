//! Values of a document, from which the tables of a layout are read.
//!
//! A type asks for a value of its own kind. [`toml::Value`] answers with a value of any kind, so
//! that each type also has code to be read from lists, numbers and texts, three times the code in
//! all. The schema excludes such documents.

use serde::de::value::{MapDeserializer, SeqDeserializer};
use serde::de::{DeserializeOwned, Deserializer, Error as _, IntoDeserializer, Visitor};
use serde::forward_to_deserialize_any;
use toml::de::Error;
use toml::{Table, Value};

/// Reads a value that fits the schema of `T`.
pub(crate) fn from_value<T: DeserializeOwned>(value: Value) -> Result<T, Error> {
    T::deserialize(OwnKind(value))
}

/// A value that is of the kind that a type asks for.
struct OwnKind(Value);

fn list<'de, V: Visitor<'de>>(list: Vec<Value>, visitor: V) -> Result<V::Value, Error> {
    visitor.visit_seq(SeqDeserializer::new(list.into_iter().map(OwnKind)))
}

fn table<'de, V: Visitor<'de>>(table: Table, visitor: V) -> Result<V::Value, Error> {
    visitor.visit_map(MapDeserializer::new(table.into_iter().map(|(key, value)| (key, OwnKind(value)))))
}

/// An error that no document has, because all fit the schema.
fn another_kind(value: &Value) -> Error {
    Error::custom(format!("{} does not fit the schema", value.type_str()))
}

impl<'de> IntoDeserializer<'de, Error> for OwnKind {
    type Deserializer = OwnKind;

    fn into_deserializer(self) -> OwnKind {
        self
    }
}

/// The methods for kinds of numbers.
macro_rules! numbers {
    ($($method:ident)*) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
            match self.0 {
                Value::Integer(number) => visitor.visit_i64(number),
                Value::Float(number) => visitor.visit_f64(number),
                other => Err(another_kind(&other)),
            }
        }
    )*};
}

impl<'de> Deserializer<'de> for OwnKind {
    type Error = Error;

    numbers! {
        deserialize_i8 deserialize_i16 deserialize_i32 deserialize_i64 deserialize_u8 deserialize_u16
        deserialize_u32 deserialize_u64 deserialize_f32 deserialize_f64
    }

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.0 {
            Value::Array(values) => list(values, visitor),
            Value::Table(values) => table(values, visitor),
            single => single.deserialize_any(visitor),
        }
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.0 {
            Value::String(text) => visitor.visit_string(text),
            other => Err(another_kind(&other)),
        }
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        self.deserialize_string(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.0 {
            Value::Array(values) => list(values, visitor),
            other => Err(another_kind(&other)),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, _: usize, visitor: V) -> Result<V::Value, Error> {
        self.deserialize_seq(visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.0 {
            Value::Table(values) => table(values, visitor),
            other => Err(another_kind(&other)),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.deserialize_map(visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        match self.0 {
            Value::String(word) => visitor.visit_enum(word.into_deserializer()),
            other => Err(another_kind(&other)),
        }
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_unit()
    }

    forward_to_deserialize_any! {
        bool i128 u128 char bytes byte_buf unit unit_struct tuple_struct identifier
    }
}

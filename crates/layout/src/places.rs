//! Where the tables of a text begin.

use std::collections::HashMap;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A table or a list of tables in a text, with the tables in it.
#[derive(Default)]
pub(crate) struct Place {
    /// Where it begins.
    pub(crate) start: usize,
    keys: HashMap<String, Place>,
    items: Vec<Place>,
}

/// Tables in tables that have places of their own, such as `tolerance.film`. Tables in a list have
/// none.
const DEPTH: usize = 3;

impl Place {
    /// The place of a document.
    pub(crate) fn of_document(document: &Spanned<DeTable>) -> Place {
        Place { start: 0, ..Place::of_table(document.get_ref(), document.span(), DEPTH) }
    }

    fn of_table(table: &DeTable, span: Range<usize>, depth: usize) -> Place {
        let of_value = |value: &Spanned<DeValue>| match value.get_ref() {
            DeValue::Table(table) => Place::of_table(table, value.span(), depth - 1),
            DeValue::Array(list) => {
                let item = |item: &Spanned<DeValue>| Place { start: item.span().start, ..Place::default() };
                Place { start: value.span().start, items: list.iter().map(item).collect(), ..Place::default() }
            }
            _ => Place { start: value.span().start, ..Place::default() },
        };
        let keys = table.iter().filter(|_| depth > 0).map(|(key, value)| (key.get_ref().to_string(), of_value(value)));
        Place { start: span.start, keys: keys.collect(), items: Vec::new() }
    }

    /// The place of a key, or this place where there is no such key.
    pub(crate) fn key(&self, key: &str) -> &Place {
        self.keys.get(key).unwrap_or(self)
    }

    /// The place of a table of a list.
    pub(crate) fn item(&self, index: usize) -> &Place {
        self.items.get(index).unwrap_or(self)
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables have places down to the third level, and lists one place for each item.
    #[test]
    fn tables_and_items_have_the_places_of_the_text() {
        let text = "a = 1\ng = [7, 8]\n[t]\nb = 2\n[t.u]\nc = 3\n[t.u.v.w]\nd = 4\n[[l]]\ne = 5\n[[l]]\nf = [6]\n";
        let document = DeTable::parse(text).unwrap();
        let place = Place::of_document(&document);
        let at = |pattern: &str| text.find(pattern).unwrap();
        assert_eq!((place.start, place.key("a").start), (0, at("1")));
        let values = place.key("g");
        assert_eq!((values.start, values.item(1).start, values.item(2).start), (at("[7"), at("8"), at("[7")));
        let table = place.key("t");
        assert_eq!((table.start, table.key("b").start), (at("[t]"), at("2")));
        let second = table.key("u");
        assert_eq!((second.start, second.key("c").start), (at("[t.u]"), at("3")));
        // The fourth level has the place of the third.
        let third = second.key("v");
        assert!(third.start >= at("[t.u.v.w]") && third.start < at("d = 4"));
        assert_eq!(third.key("w").start, third.start);
        let list = place.key("l");
        assert_eq!([list.item(0).start, list.item(1).start], [at("[[l]]"), text.rfind("[[l]]").unwrap()]);
        assert_eq!((list.item(2).start, list.key("e").start), (list.start, list.start));
        assert_eq!(place.key("none").start, 0);
    }
}

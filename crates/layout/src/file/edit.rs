//! A layout that was read and changed, in the text from which it was read.

use std::path::Path;

use toml::Table;
use toml_edit::{Array, DocumentMut, Item, TableLike};

use crate::error::LayoutError;
use crate::layout::Layout;

/// How the tiles of a layout are written.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum TileForm {
    /// One line for each tile without its mirror images, as [`Layout::to_compact_toml`] writes it.
    Compact,
    /// One `[[tile]]` for each tile, as [`Layout::to_toml`] writes it.
    Plain,
}

impl Layout {
    /// The layout in the text from which it was read. Whatever is as it was keeps its comments, its
    /// order and its format. If a tile has changed, all tiles are written anew in the given form,
    /// without their comments. A layout that was made in memory is written as a whole.
    ///
    /// `folder` is the folder of the file to be written. Measured errors in a file that is not
    /// found from there are written out.
    ///
    /// # Errors
    /// If the layout breaks a rule. `origin` identifies it in the message.
    ///
    /// # Example
    /// ```
    /// use magsplice_layout::{COMMENTED_LAYOUT, Layout, TileForm};
    ///
    /// let mut layout = Layout::parse(COMMENTED_LAYOUT, "commented")?;
    /// layout.expectations.bounds.least_amplitude = Some(0.75);
    /// let text = layout.to_edited_toml(TileForm::Compact, "", "edited")?;
    /// assert_eq!(text, COMMENTED_LAYOUT.replace("{ min = 0.8 }  ", "{ min = 0.75 }  "));
    /// # Ok::<(), magsplice_layout::LayoutError>(())
    /// ```
    pub fn to_edited_toml(
        &self,
        form: TileForm,
        folder: impl AsRef<Path>,
        origin: &str,
    ) -> Result<String, LayoutError> {
        self.check_seeds(origin)?;
        let read = |text: &str, folder: &Path| Layout::parse_beside(text, origin, folder);
        let before = self.file.as_ref().and_then(|file| Some((file, read(&file.text, &file.folder).ok()?)));
        let has_same_tiles = before.as_ref().is_some_and(|(_, before)| before.tiles == self.tiles);
        let anew = match form {
            TileForm::Compact if !has_same_tiles => self.to_compact_toml(),
            _ => self.to_toml(),
        };
        let Some((file, before)) = before else { return read(&anew, folder.as_ref()).map(|_| anew) };
        // The path of a neighbour stays as it was written.
        let checked = read(&anew, folder.as_ref()).or_else(|error| read(&anew, &file.folder).map_err(|_| error))?;
        let wanted = checked.to_toml();
        for keeps_tolerance in [true, false] {
            let Some(text) = edited(&file.text, &before, self, &anew, keeps_tolerance) else { break };
            // [tolerance] may name tiles that now have other names, and numbers that were left out
            // may come from a preset or a part.
            if read(&text, folder.as_ref()).is_ok_and(|read| read.to_toml() == wanted) {
                return Ok(text);
            }
        }
        Ok(anew)
    }
}

/// The text with what differs between two layouts. `anew` is the second of them, as a whole.
fn edited(text: &str, before: &Layout, after: &Layout, anew: &str, keeps_tolerance: bool) -> Option<String> {
    let mut document: DocumentMut = text.parse().ok()?;
    let anew: DocumentMut = anew.parse().ok()?;
    let without_tiles = |layout: &Layout| {
        let names: Vec<&str> = layout.tiles.iter().map(|named| named.name.as_str()).collect();
        layout.without_tiles(&names).table()
    };
    let [before_values, after_values] = [before, after].map(without_tiles);
    let items: DocumentMut = after_values.to_string().parse().ok()?;
    patch(document.as_table_mut(), &before_values, &after_values, items.as_table(), true);
    if !keeps_tolerance {
        match anew.get("tolerance") {
            Some(item) => set(document.as_table_mut(), "tolerance", item.clone()),
            None => drop(document.remove("tolerance")),
        }
    }
    if before.tiles != after.tiles {
        replace_tiles(&mut document, &anew);
    }
    let written = document.to_string();
    Some(if text.contains("\r\n") { written.replace('\n', "\r\n") } else { written })
}

/// Writes what differs between two tables into a third, which the user wrote for the first.
/// `items` are the values of the second.
fn patch(own: &mut dyn TableLike, before: &Table, after: &Table, items: &dyn TableLike, is_top: bool) {
    for key in before.keys().filter(|key| !after.contains_key(*key)) {
        own.remove(key);
    }
    for (key, item) in items.iter().filter(|(key, _)| before.get(*key) != after.get(*key)) {
        let values = (before.get(key).and_then(toml::Value::as_table), after.get(key).and_then(toml::Value::as_table));
        if let (Some(own), (Some(before), Some(after)), Some(item)) = (own.get_mut(key), values, item.as_table_like())
            && own.is_table_like()
        {
            let is_line = own.is_value() && !own.to_string().contains('\n');
            let Some(table) = own.as_table_like_mut() else { continue };
            let keys = table.len();
            patch(table, before, after, item, false);
            if is_line && table.len() > keys {
                table.fmt();
            }
        } else {
            let mut item = item.clone();
            // As short as the keys beside it.
            if !is_top && item.as_table().is_some_and(|table| table.iter().all(|(_, item)| item.is_value())) {
                item.make_value();
            }
            set(own, key, item);
        }
    }
}

/// Sets the value of a key. Comments beside it stay.
pub(super) fn set(own: &mut dyn TableLike, key: &str, mut item: Item) {
    unplace(&mut item);
    match (own.get_mut(key), item) {
        (Some(Item::Value(toml_edit::Value::Array(own))), Item::Value(toml_edit::Value::Array(new)))
            if begins_with(&new, own) =>
        {
            new.iter().skip(own.len()).for_each(|element| append(own, element.clone()));
        }
        (Some(Item::Value(own)), Item::Value(mut new)) => {
            *new.decor_mut() = own.decor().clone();
            *own = new;
        }
        (Some(Item::Table(own)), Item::Table(mut new)) => {
            *new.decor_mut() = own.decor().clone();
            new.set_position(own.position());
            *own = new;
        }
        (Some(own), new) => *own = new,
        (None, new) => drop(own.insert(key, new)),
    }
}

/// Lets tables stand where they are inserted, after an empty line.
fn unplace(item: &mut Item) {
    let tables: Vec<&mut toml_edit::Table> = match item {
        Item::Table(table) if !table.is_dotted() => vec![table],
        Item::ArrayOfTables(tables) => tables.iter_mut().collect(),
        _ => return,
    };
    for table in tables {
        table.set_position(None);
        table.decor_mut().clear();
        table.iter_mut().for_each(|(_, item)| unplace(item));
    }
}

fn begins_with(new: &Array, own: &Array) -> bool {
    let texts = |array: &Array| array.iter().map(|value| value.as_str().map(str::to_owned)).collect::<Vec<_>>();
    let (own, new) = (texts(own), texts(new));
    own.iter().all(Option::is_some) && !own.is_empty() && new.starts_with(&own)
}

/// Adds a last element to a list that has one, on a line of its own if the list ends on one. A
/// comment after the last element stays with it.
fn append(list: &mut Array, mut element: toml_edit::Value) {
    let text = |raw: Option<&toml_edit::RawString>| raw.and_then(|raw| raw.as_str()).unwrap_or_default().to_owned();
    let trailing = text(Some(list.trailing()));
    let last = list.len() - 1;
    let Some(own) = list.get_mut(last) else { return };
    let (start, end) = (text(own.decor().prefix()), text(own.decor().suffix()) + &trailing);
    own.decor_mut().set_suffix("");
    let (prefix, suffix) = match end.rsplit_once('\n') {
        Some((kept, indent)) => {
            let of_element = start.rsplit_once('\n').map_or("  ", |(_, indent)| indent);
            (format!("{kept}\n{of_element}"), format!("\n{indent}"))
        }
        None => (" ".to_owned(), end),
    };
    *element.decor_mut() = toml_edit::Decor::new(prefix, "");
    list.push_formatted(element);
    list.set_trailing(suffix);
}

/// The tables that hold tiles.
const TILE_TABLES: [&str; 3] = ["kind", "tile", "lattice"];

/// Writes the tiles of another document in place of the own ones. Comments before the first of
/// them that an empty line parts from it move to the end.
fn replace_tiles(document: &mut DocumentMut, anew: &DocumentMut) {
    let first =
        TILE_TABLES.iter().filter_map(|key| first_table(document.get(key)?)).min_by_key(|table| table.position());
    let before = first.and_then(|table| table.decor().prefix()?.as_str()?.rsplit_once("\n\n"));
    if let Some((comments, _)) = before.filter(|(comments, _)| comments.contains('#')) {
        let trailing = format!("{comments}\n{}", document.trailing().as_str().unwrap_or_default());
        document.set_trailing(trailing);
    }
    for key in TILE_TABLES {
        document.remove(key);
        if let Some((key, item)) = anew.get_key_value(key) {
            let mut item = item.clone();
            unplace(&mut item);
            document.insert_formatted(key, item);
        }
    }
}

/// The first table with a line of its own in an item.
fn first_table(item: &Item) -> Option<&toml_edit::Table> {
    match item {
        Item::Table(table) if table.is_implicit() => table.iter().find_map(|(_, item)| first_table(item)),
        Item::Table(table) => Some(table),
        Item::ArrayOfTables(tables) => tables.get(0),
        _ => None,
    }
}

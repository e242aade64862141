//! Changed tiles, written into the text of their layout.

use std::collections::HashMap;
use std::path::Path;

use magsplice::layout::{Layout, NamedTile, PathStep, TextEdit, TileForm, document_of, edited_text, ten_decimals};
use magsplice::prelude::{DVec3, Tile};
use magsplice::results::rounded_beside;
use serde_json::{Map, Value, json};

/// Largest difference of a written tile from the tile on the page, in millimetres and tesla. Angles
/// are written with ten decimals of a degree; a page shows three of a millimetre.
const WRITTEN: f64 = 1e-9;

/// The text with the tiles of `layout`. Entries that describe one tile, and its mirror images,
/// change in place and keep their comments. If that does not give the tiles, all of them are
/// written anew as one `[[tile]]` each. `folder` is that of the layout's file.
///
/// # Errors
/// If the layout breaks a rule, such as overlapping tiles.
pub(crate) fn text_with_tiles(
    layout: &Layout,
    text: &str,
    folder: &Path,
    read: impl Fn(&str) -> Result<Layout, String>,
) -> Result<String, String> {
    let before = read(text)?;
    if before.tiles == layout.tiles {
        return Ok(text.to_owned());
    }
    if let Some(edited) = edited_in_place(layout, &before, text)
        && read(&edited).is_ok_and(|read| has_same_tiles(&read, layout))
    {
        return Ok(edited);
    }
    without_round_off(layout)?.to_edited_toml(TileForm::Plain, folder, &layout.name).map_err(|error| error.to_string())
}

/// The layout with twelve digits of each length: the centres of a lattice are sums of widths, such
/// as
/// 2.4999999999999996.
fn without_round_off(layout: &Layout) -> Result<Layout, String> {
    let mut rounded = layout.clone();
    for named in &mut rounded.tiles {
        let [position, size] = [named.tile.position(), named.tile.size()];
        let largest = position.abs().max_element();
        let of = |v: DVec3, largest: f64| v.map(|length| rounded_beside(length, largest));
        let tile = Tile::new(of(position, largest), of(size, size.max_element()), named.tile.polarization_t());
        let tile = tile.and_then(|tile| tile.rotated(named.tile.rotation()));
        named.tile = tile.map_err(|faults| format!("tile \"{}\": {faults}", named.name))?;
    }
    Ok(rounded)
}

/// The text with the keys of changed tiles set in their own entries.
fn edited_in_place(layout: &Layout, before: &Layout, text: &str) -> Option<String> {
    let document = document_of(text).ok()?;
    let entries = document.get("tile")?.as_array()?;
    let by_name: HashMap<&str, &NamedTile> = before.tiles.iter().map(|named| (named.name.as_str(), named)).collect();
    let index_of: HashMap<String, usize> = entries
        .iter()
        .enumerate()
        .map(|(index, entry)| {
            let name = entry.get("name").and_then(Value::as_str).map(str::to_owned);
            (name.unwrap_or_else(|| format!("tile-{}", index + 1)), index)
        })
        .collect();
    let changed = layout.tiles.iter().filter_map(|named| {
        let index = *index_of.get(&named.name)?;
        let known = by_name.get(named.name.as_str())?;
        (known.tile != named.tile).then_some((index, known.tile, named.tile))
    });
    let edits = changed.flat_map(|(index, known, tile)| {
        let entry = entries[index].as_object().cloned().unwrap_or_default();
        let edit = move |(key, value): (&str, Value)| TextEdit {
            path: vec![PathStep::Key("tile".to_owned()), PathStep::Index(index), PathStep::Key(key.to_owned())],
            value: Some(value),
        };
        keys(&entry, &known, &tile).into_iter().map(edit)
    });
    edited_text(text, &edits.collect::<Vec<_>>()).ok()
}

/// The keys of an entry that a changed tile needs.
fn keys(entry: &Map<String, Value>, known: &Tile, tile: &Tile) -> Vec<(&'static str, Value)> {
    let mut keys = Vec::new();
    if tile.position() != known.position() {
        keys.push(("position_mm", json!(tile.position())));
    }
    if tile.size() != known.size() {
        keys.push(("size_mm", json!(tile.size())));
    }
    let j_t = tile.polarization_t();
    if j_t == known.polarization_t() {
        return keys;
    }
    if entry.contains_key("polarization_t") {
        keys.push(("polarization_t", json!(j_t)));
        return keys;
    }
    let strength_t = ten_decimals(j_t.length());
    if strength_t != ten_decimals(known.polarization_t().length()) {
        keys.push(("strength_t", json!(strength_t)));
    }
    if entry.contains_key("direction_deg") {
        let tilt_deg = ten_decimals(j_t.z.atan2(j_t.truncate().length()).to_degrees());
        keys.push(("direction_deg", json!(ten_decimals(j_t.y.atan2(j_t.x).to_degrees()))));
        if tilt_deg != 0.0 || entry.contains_key("tilt_deg") {
            keys.push(("tilt_deg", json!(tilt_deg)));
        }
    } else {
        keys.push(("direction", json!((j_t / j_t.length()).map(ten_decimals))));
    }
    keys
}

fn has_same_tiles(read: &Layout, layout: &Layout) -> bool {
    let by_name: HashMap<&str, &Tile> = read.tiles.iter().map(|named| (named.name.as_str(), &named.tile)).collect();
    let close = |a: DVec3, b: DVec3| a.distance(b) <= WRITTEN;
    let is_same = |a: &Tile, b: &Tile| {
        close(a.position(), b.position())
            && close(a.size(), b.size())
            && close(a.scene_polarization_t(), b.scene_polarization_t())
    };
    read.tiles.len() == layout.tiles.len()
        && layout
            .tiles
            .iter()
            .all(|named| by_name.get(named.name.as_str()).is_some_and(|tile| is_same(tile, &named.tile)))
}

//! `[[tolerance.group]]`: tiles that move or change together.

use std::collections::{BTreeMap, HashSet};

use magsplice_magnet::Axis;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::faults::TableFaults;
use crate::limits::{MAX_GROUP_MEMBERS, MAX_NAME_BYTES};
use crate::names::{check_name, shown};
use crate::tolerance::selection::Selection;
use crate::tolerance::tabulated::ErrorTables;
use crate::tolerance::tile_errors::{ErrorKeys, replace};
use crate::tolerance::written::too_many_values;
use crate::tolerance::{ErrorGroup, TileErrors};

/// Tiles that move or change together: all tiles, or those of `tiles` or `kinds`, as one group or
/// as one for each row or kind.
#[derive(Default, Deserialize, JsonSchema, Serialize)]
pub(crate) struct GroupTable {
    /// Unique name. Default: group-1, group-2 and so on, numbered in the order of the file. Groups
    /// for rows are named NAME-1, NAME-2, and groups for kinds NAME-KIND.
    name: Option<String>,
    /// Names of its tiles. An asterisk stands for any letters, unless the text is the name of a
    /// tile.
    #[schemars(extend("example" = "[\"corner*\"]"))]
    tiles: Option<Vec<String>>,
    /// Kinds of its tiles, instead of names.
    #[schemars(extend("example" = "[\"square\"]"))]
    kinds: Option<Vec<String>>,
    /// A group for each row of tiles along this axis: tiles whose centres differ along it only.
    rows_along: Option<Axis>,
    /// A group for each kind.
    each: Option<Each>,
    #[serde(flatten)]
    errors: ErrorKeys,
}

/// What there is a group for each of.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Each {
    /// The tiles of each kind.
    Kind,
}

/// Largest distance in mm of centres across a row from one to the next. It removes the round-off of
/// sums of lengths, and is far below what can be cut.
const ROW_ROUNDING_MM: f64 = 1e-6;

/// A group before it has errors: its name and its tiles.
type NamedGroup = (String, Vec<usize>);

/// The groups of all tables. Faults are added.
pub(crate) fn resolve(groups: Vec<GroupTable>, selection: &mut Selection, tables: &mut ErrorTables) -> Vec<ErrorGroup> {
    let mut found: Vec<ErrorGroup> = Vec::new();
    let mut names: HashSet<String> = HashSet::new();
    let mut members = 0;
    for (index, mut table) in groups.into_iter().enumerate() {
        let name = table.name.clone().unwrap_or_else(|| format!("group-{}", index + 1));
        let place = tables.place.key("group").item(index);
        let mut at = tables.at(place, format!("tolerance.group \"{}\"", shown(&name)));
        check_name("name", &name, &mut at.faults);
        let chosen = chosen(&table, selection, &mut at.faults);
        let mut errors = TileErrors::default();
        replace(&table.errors.read_some(selection.shortest_side(&chosen), &mut at), &mut errors);
        let is_divided = table.rows_along.is_some() || table.each.is_some();
        let parts = parts(&table, name, chosen, selection);
        members += parts.iter().map(|(_, tiles)| tiles.len()).sum::<usize>();
        if members > MAX_GROUP_MEMBERS {
            at.faults.add(format!("makes {members} tiles in all groups, must be at most {MAX_GROUP_MEMBERS}"));
            break;
        }
        if parts.len() > 1 && !at.tabulated.count(errors.values(), parts.len() - 1) {
            at.faults.add(too_many_values("this group"));
        }
        // One of the names of rows and kinds. The name of the table has been checked.
        let is_long = |(name, _): &&NamedGroup| name.len() > MAX_NAME_BYTES;
        if is_divided && let Some((name, _)) = parts.iter().find(is_long) {
            check_name("name", name, &mut at.faults);
        }
        for (name, tiles) in parts {
            if !names.insert(name.clone()) {
                at.faults.add(format!("several groups are named \"{}\", names must be unique", shown(&name)));
            }
            found.push(ErrorGroup { name, tiles, errors: errors.clone() });
        }
    }
    found
}

/// The tiles of all groups of a table, in ascending order.
fn chosen(table: &GroupTable, selection: &mut Selection, faults: &mut TableFaults) -> Vec<usize> {
    let faults_before = faults.count();
    let mut chosen = match (&table.tiles, &table.kinds) {
        (Some(_), Some(_)) => {
            faults.add("gives both tiles and kinds, must give only one of them");
            return Vec::new();
        }
        (Some(names), None) => selection.of_names("tiles", names, faults),
        (None, Some(kinds)) => selection.of_kinds("kinds", kinds, faults),
        (None, None) if table.rows_along.is_none() && table.each.is_none() => {
            faults.add("has no tiles, must give tiles, kinds, rows_along or each");
            return Vec::new();
        }
        (None, None) => (0..selection.tiles.len()).collect(),
    };
    chosen.sort_unstable();
    if let Some(twice) = chosen.windows(2).find(|pair| pair[0] == pair[1]) {
        let name = &selection.tiles[twice[0]].name;
        faults.add(format!("has tile \"{}\" twice, must have a tile once", shown(name)));
    }
    let has_named_none = [&table.tiles, &table.kinds].into_iter().flatten().all(Vec::is_empty);
    if table.rows_along.is_some() && table.each.is_some() {
        faults.add("gives both rows_along and each, must give only one of them");
    } else if chosen.is_empty() && has_named_none {
        faults.add("has no tiles, must have at least one");
    } else if chosen.is_empty() && table.kinds.is_some() && faults.count() == faults_before && selection.is_complete {
        faults.add("has no tiles: no tile is of these kinds");
    } else if table.each.is_some()
        && selection.is_complete
        && let Some(&without) = chosen.iter().find(|&&index| selection.tiles[index].kind.is_none())
        && (table.tiles.is_some() || chosen.iter().all(|&index| selection.tiles[index].kind.is_none()))
    {
        let name = shown(&selection.tiles[without].name);
        faults.add(format!("each = \"kind\" needs tiles that have kinds, tile \"{name}\" has none"));
    }
    chosen
}

/// The groups that a table makes of its tiles.
fn parts(table: &GroupTable, name: String, chosen: Vec<usize>, selection: &Selection) -> Vec<NamedGroup> {
    if let Some(axis) = table.rows_along {
        let rows = rows(axis.index(), chosen, selection).into_iter().enumerate();
        return rows.map(|(row, tiles)| (format!("{name}-{}", row + 1), tiles)).collect();
    }
    match table.each {
        Some(Each::Kind) => {
            let mut kinds: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
            for index in chosen {
                if let Some(kind) = &selection.tiles[index].kind {
                    kinds.entry(kind).or_default().push(index);
                }
            }
            kinds.into_iter().map(|(kind, tiles)| (format!("{name}-{kind}"), tiles)).collect()
        }
        None if chosen.is_empty() => Vec::new(),
        None => vec![(name, chosen)],
    }
}

/// Rows of tiles along an axis, in the order of their places along the other two.
fn rows(axis: usize, chosen: Vec<usize>, selection: &Selection) -> Vec<Vec<usize>> {
    let [first, second] = [[1, 2], [0, 2], [0, 1]][axis];
    let place = |index: usize, across: usize| selection.place(index)[across];
    let mut rows = Vec::new();
    for layer in neighbours(chosen, |index| place(index, second)) {
        rows.extend(neighbours(layer, |index| place(index, first)));
    }
    rows.iter_mut().for_each(|row| row.sort_unstable());
    rows
}

/// Indices in the order of their places, parted where a place is further than round-off from the
/// next.
fn neighbours(mut indices: Vec<usize>, place: impl Fn(usize) -> f64) -> Vec<Vec<usize>> {
    indices.sort_by(|&a, &b| place(a).total_cmp(&place(b)));
    indices.chunk_by(|&a, &b| place(b) - place(a) <= ROW_ROUNDING_MM).map(<[usize]>::to_vec).collect()
}

impl GroupTable {
    /// The table of a group with the names of its tiles.
    pub(crate) fn of(group: &ErrorGroup, tiles: Vec<String>) -> GroupTable {
        let (name, errors) = (Some(group.name.clone()), ErrorKeys::of(&group.errors));
        GroupTable { name, tiles: Some(tiles), errors, ..GroupTable::default() }
    }
}

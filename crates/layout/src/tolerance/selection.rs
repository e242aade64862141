//! Tiles by their names, by names with asterisks, and by kinds.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use glam::DVec3;

use crate::disc_errors::discs;
use crate::faults::TableFaults;
use crate::layout::NamedTile;
use crate::limits::{MAX_LISTED, MAX_NAME_TRIALS};
use crate::names::{did_you_mean, shown};

/// Names among which the one that was probably meant is searched: comparing names takes long.
const COMPARED_NAMES: usize = 2000;

/// The tiles of a layout, by name and kind.
pub(crate) struct Selection<'t> {
    pub(crate) tiles: &'t [NamedTile],
    by_name: HashMap<&'t str, usize>,
    /// Kinds that tiles have, with the indices of these in ascending order.
    pub(crate) by_kind: BTreeMap<&'t str, Vec<usize>>,
    /// Names of declared kinds, also of those without tiles.
    kinds: BTreeSet<&'t str>,
    /// Whether all tiles of the file are there. If some are missing because of other faults, names
    /// that do not exist are no faults.
    pub(crate) is_complete: bool,
    /// The centres of all tiles. A strip of a disc has the centre of the disc.
    places: Vec<DVec3>,
    /// Comparisons of names that are left.
    trials_left: usize,
}

impl<'t> Selection<'t> {
    pub(crate) fn new(
        tiles: &'t [NamedTile],
        kinds: impl Iterator<Item = &'t String>,
        is_complete: bool,
    ) -> Selection<'t> {
        let mut by_kind: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (index, named) in tiles.iter().enumerate() {
            if let Some(kind) = &named.kind {
                by_kind.entry(kind).or_default().push(index);
            }
        }
        Selection {
            tiles,
            by_name: tiles.iter().enumerate().map(|(index, named)| (named.name.as_str(), index)).collect(),
            by_kind,
            kinds: kinds.map(String::as_str).collect(),
            is_complete,
            places: places(tiles),
            trials_left: MAX_NAME_TRIALS,
        }
    }

    /// The indices of tiles with these names, in the order of the names. An asterisk stands for any
    /// letters, unless a tile has exactly this name. Faults of names are added.
    pub(crate) fn of_names(&mut self, key: &str, names: &[String], faults: &mut TableFaults) -> Vec<usize> {
        let mut found = Vec::new();
        for name in names {
            let before = found.len();
            if let Some(index) = self.by_name.get(name.as_str()) {
                found.push(*index);
            } else if name.contains('*') {
                let Some(left) = self.trials_left.checked_sub(self.tiles.len()) else {
                    faults.add(format!(
                        "{key} has too many names with *: their number times the number of tiles in the layout must be \
                         at most {MAX_NAME_TRIALS}"
                    ));
                    return found;
                };
                self.trials_left = left;
                let matching = self.tiles.iter().enumerate().filter(|(_, tile)| matches(name, &tile.name));
                found.extend(matching.map(|(index, _)| index));
            }
            if found.len() == before && self.is_complete {
                let rule = if name.contains('*') { "no tile has a name like this" } else { "no tile has this name" };
                let meant = meant(name, self.tiles.iter().map(|tile| tile.name.as_str()), faults);
                faults.add(format!("{key} names \"{}\", {rule}{meant}", shown(name)));
            }
        }
        found
    }

    /// The indices of the tiles of these kinds, in the order of the kinds. Faults of kinds are
    /// added.
    pub(crate) fn of_kinds(&self, key: &str, kinds: &[String], faults: &mut TableFaults) -> Vec<usize> {
        let (mut found, mut seen) = (Vec::new(), HashSet::new());
        for kind in kinds {
            if !seen.insert(kind) {
                faults.add(format!("{key} names \"{}\" twice, must name a kind once", shown(kind)));
            } else if self.check_kind(key, kind, faults) {
                found.extend(self.by_kind.get(kind.as_str()).into_iter().flatten());
            }
        }
        found
    }

    /// Requires a kind that is declared.
    pub(crate) fn check_kind(&self, key: &str, kind: &str, faults: &mut TableFaults) -> bool {
        let is_known = self.kinds.contains(kind);
        if !is_known {
            let meant = meant(kind, self.kinds.iter().copied(), faults);
            faults.add(format!("{key} names \"{}\", no kind has this name{meant}", shown(kind)));
        }
        is_known
    }

    /// The centre of a tile, of its disc for a strip.
    pub(crate) fn place(&self, tile: usize) -> DVec3 {
        self.places[tile]
    }

    /// The shortest side of these tiles in mm, with its tile. A disc counts as a whole.
    pub(crate) fn shortest_side<'i>(&self, tiles: impl IntoIterator<Item = &'i usize>) -> Option<(f64, &'t str)> {
        let named = tiles.into_iter().map(|index| &self.tiles[*index]);
        let side = |named: &NamedTile| match &named.disc {
            Some(disc) => disc.diameter_mm.min(disc.height_mm),
            None => named.tile.size().min_element(),
        };
        let sides = named.map(|named| (side(named), named.name.as_str()));
        sides.min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// The centres of all tiles. A strip of a disc has the centre of the disc.
fn places(tiles: &[NamedTile]) -> Vec<DVec3> {
    let mut places: Vec<DVec3> = tiles.iter().map(|named| named.tile.position()).collect();
    for (_, strips) in discs(tiles) {
        let centre = strips.iter().map(|strip| places[*strip]).sum::<DVec3>() / strips.len() as f64;
        strips.into_iter().for_each(|strip| places[strip] = centre);
    }
    places
}

/// The known name most like an unknown one, as a question. Not searched for faults that are not
/// listed.
fn meant<'n>(unknown: &str, known: impl Iterator<Item = &'n str>, faults: &TableFaults) -> String {
    if faults.count() < MAX_LISTED { did_you_mean(unknown, known.take(COMPARED_NAMES)) } else { String::new() }
}

/// Whether a name is like a pattern, in which asterisks stand for any letters.
///
/// The parts between asterisks are found from left to right, each as early as possible, so that the
/// time grows with the lengths and not with their product.
fn matches(pattern: &str, name: &str) -> bool {
    let mut parts = pattern.split('*');
    let first = parts.next().unwrap_or_default();
    let Some(mut rest) = name.strip_prefix(first) else { return false };
    let Some(last) = parts.next_back() else { return rest.is_empty() };
    for part in parts {
        let Some(at) = rest.find(part) else { return false };
        rest = &rest[at + part.len()..];
    }
    rest.ends_with(last)
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn asterisks_stand_for_any_letters() {
        for (pattern, name, wanted) in [
            ("corner*", "corner-1", true),
            ("corner*", "corner", true),
            ("corner*", "a-corner", false),
            ("*", "", true),
            ("*-mx", "a-mx", true),
            ("*-mx", "a-mx-my", false),
            ("a*b*c", "a--b--b--c", true),
            ("a*b*c", "a--c--b", false),
            ("ab*ba", "aba", false),
            ("a", "a", true),
            ("a", "ab", false),
            ("*\u{b5}*", "2 \u{b5}m", true),
        ] {
            assert_eq!(matches(pattern, name), wanted, "{pattern} {name}");
        }
    }
}

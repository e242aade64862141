//! All tiles of a file: kinds, single and repeated tiles, lattices.

use std::collections::{BTreeMap, HashSet};

use crate::faults::Faults;
use crate::finding::{FindingSubject, listed};
use crate::layout::NamedTile;
use crate::limits::MAX_NAME_BYTES;
use crate::names::{check_name, shown};
use crate::places::Place;
use crate::tile::disc::Disc;
use crate::tile::entries::{Entry, entry_of};
use crate::tile::lattice::LatticeTable;
use crate::tile::repeat::{self, MirrorTable};
use crate::tile::room::Room;
use crate::tile::single::{self, KindTable, TileTable};

/// The tiles of a file, and the entries that make them.
#[derive(Default)]
pub(crate) struct FileTiles<'t> {
    pub(crate) tiles: Vec<NamedTile>,
    pub(crate) entries: Vec<Entry<'t>>,
    /// Largest error of the shape of a disc. `None` without discs.
    pub(crate) shape_error: Option<f64>,
}

const TOO_THIN: &str = "has a strip that is too thin for a tile: state a larger shape_error";

impl<'t> FileTiles<'t> {
    /// The tiles of the tables, after adding their faults. They are all there if none was added.
    pub(crate) fn resolve(
        kinds: &BTreeMap<String, KindTable>,
        singles: &'t [TileTable],
        lattices: &[LatticeTable],
        place: &Place,
        faults: &mut Faults,
    ) -> FileTiles<'t> {
        for (name, kind) in kinds {
            let at = place.key("kind").key(name).start;
            let mut faults = faults.at(at, format!("kind \"{}\"", shown(name)));
            check_name("name", name, &mut faults);
            kind.check(&mut faults);
        }
        let used: HashSet<&String> = singles.iter().filter_map(|tile| tile.kind.as_ref()).collect();
        let idle = kinds.keys().filter(|name| !used.contains(name));
        let is_idle = |name: &String| format!("kind \"{name}\" is declared but no tile uses it");
        faults.findings.extend(listed(idle, FindingSubject::Tiles, is_idle, "kinds"));
        if singles.is_empty() && lattices.is_empty() {
            faults.add_to_layout("has no tiles: add at least one [[tile]] or [[lattice]]");
        }
        let (mut all, mut room) = (FileTiles::default(), Room::default());
        for (index, table) in singles.iter().enumerate() {
            let start = place.key("tile").item(index).start;
            let name = table.name.clone().unwrap_or_else(|| format!("tile-{}", index + 1));
            let mut faults = faults.at(start, format!("tile \"{}\"", shown(&name)));
            check_name("name", &name, &mut faults);
            let (grid, mirror) = (table.grid.as_ref(), table.mirror.as_ref());
            let single = single::resolve(table, name, kinds, &mut faults);
            let tiles = single.and_then(|(tile, disc)| {
                let strips = disc.map_or(1, Disc::strips);
                let copies = repeat::resolve(tile, strips, grid, mirror, &mut room, &mut faults)?;
                let Some(disc) = disc else { return Some(copies) };
                all.shape_error = Some(all.shape_error.unwrap_or(0.0).max(disc.error));
                let strips: Option<Vec<Vec<NamedTile>>> = copies.iter().map(|copy| disc.tiles(copy)).collect();
                strips.map(|strips| strips.concat()).or_else(|| faults.refuse(TOO_THIN))
            });
            all.add(start, mirror, tiles);
        }
        for (index, table) in lattices.iter().enumerate() {
            let start = place.key("lattice").item(index).start;
            let name = table.name.clone().unwrap_or_else(|| format!("lattice-{}", index + 1));
            let mut faults = faults.at(start, format!("lattice \"{}\"", shown(&name)));
            check_name("name", &name, &mut faults);
            all.add(start, None, table.resolve(&name, &mut room, &mut faults));
        }
        all.check_names(faults);
        all
    }

    fn add(&mut self, start: usize, mirror: Option<&'t MirrorTable>, tiles: Option<Vec<NamedTile>>) {
        self.entries.push(Entry { start, first: self.tiles.len(), mirror });
        self.tiles.extend(tiles.unwrap_or_default());
    }

    /// Adds a fault for each name that several tiles have, and for each that has become too long by
    /// repetition.
    fn check_names(&self, faults: &mut Faults) {
        let start = |index: usize| self.entries[entry_of(index, &self.entries)].start;
        let mut seen: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
        for (index, NamedTile { name, .. }) in self.tiles.iter().enumerate() {
            let (count, last) = seen.entry(name).or_default();
            (*count, *last) = (*count + 1, index);
            if name.len() > MAX_NAME_BYTES {
                check_name("name", name, &mut faults.at(start(index), "a repeated tile"));
            }
        }
        for (name, (count, last)) in seen.into_iter().filter(|(_, (count, _))| *count > 1) {
            let message = format!("{count} tiles have this name, names must be unique");
            faults.at(start(last), format!("tile \"{name}\"")).add(message);
        }
    }
}
